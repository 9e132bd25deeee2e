//! 3D contact with Coulomb friction of elastic bodies, some of them with a shape that is optimized, among each other
//! and with rigid obstacles.
//!
//! The controls α move the nodes of one or several bodies, x = x₀ + X α, by lattices of control points; heights of a
//! face of a block are one of them. The state y = S(α) holds the contact forces of the equilibrium. The cost is a
//! quantity of the states. S is nonsmooth where nodes open, close, stick or slip; [`contact_shape::ContactShape`]
//! returns one element of its coderivative by an adjoint solve. Units are N, mm, MPa. The equations are in
//! `docs/method.md` of the repository.
//!
//! # Θ of a scene
//!
//! ```
//! use contact::contact_shape::{ContactShape, SolverKind};
//! use contact::cost::{NodeWeight, PressureCost, PressureMeasure};
//! use contact::scene::signorini;
//! use nonsmooth::{CompositeObjective, NonsmoothObjective, Request, StateSolver};
//!
//! // The paper's Example 5.1, a block against a wavy obstacle, on 4 × 4 × 4 bricks.
//! let scene = signorini()?.with_bricks([4; 3], [1; 3]);
//! let shape = ContactShape::new(scene, SolverKind::Newton)?;
//! let measure = PressureMeasure::Norm { exponent: 4.0, weight: NodeWeight::Nodes };
//! let cost = PressureCost::new(measure, shape.problem())?;
//! let start = shape.start();
//! let theta = CompositeObjective::new(shape, cost);
//!
//! let evaluation = theta.evaluate(&Request::tight(&start))?.into_evaluation();
//! assert_eq!(evaluation.subgradient.len(), theta.solver().control_dimension());
//! assert!(evaluation.error_bound < 1e-8 * evaluation.value);
//!
//! // The state alone, with all that is known about it: 3000 MPa on 100 mm × 100 mm must arrive at the obstacle.
//! let state = theta.solver().solve(&start, None, nonsmooth::Accuracy::TIGHTEST)?;
//! assert!((state.forces.total_normal_force() / 3e7 - 1.0).abs() < 1e-9);
//! assert!(state.forces.counts().open > 0 && state.forces.counts().slip > 0);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! To optimize, hand `theta` to [`nonsmooth::BundleTrust`] with the set of [`shape::AdmissibleSet`].
//!
//! # Modules
//!
//! | module | what it holds |
//! |---|---|
//! | [`contact_shape`], [`cost`], [`contact_objective`] | the contact problem in the framework's terms: state solver with coderivative, costs, Θ |
//! | [`load_cases`] | several loadings of one shape, rated together |
//! | [`scene`], [`shape`] | what a problem is made of; splines and the admissible set |
//! | [`body`] | meshes and their pieces; elasticity; element sums of the adjoint |
//! | [`equilibrium`] | boundary, contact rows of a shape, contact law, rigid motions, certificates, the discrete problem and its state |
//! | [`tfeti`] | total FETI: torn bodies, dual problem, Newton, the paper's method, derivative |
//! | [`direct`] | direct condensation: an independent path |
//! | [`qp`], [`linear`] | dual QPs over half-lines and discs; factorisations |
//! | [`formula`] | formulas of x₁, x₂, x₃ |
//! | [`fields`] | displacements, stresses, contact fields and resultants of a solved shape |
//! | [`friction_problem`] | the matrices of a shape, for other solvers |
//! | [`solvers`] | the solver of a scene: by name, by choice, shared by several processes |
//! | [`communication`] | what passes between the processes of a run |
//! | [`memory`] | memory estimated before any work |
//! | [`deformation`] | the largest displacement, rotation and strain of bodies |
//! | [`plausibility`] | what linear elasticity, the mesh and uniqueness say about a state |
//! | [`error`] | what can be wrong with a scene, and why a contact problem has no answer |

pub mod body;
pub mod communication;
pub mod contact_objective;
pub mod contact_shape;
pub mod cost;
pub mod deformation;
pub mod direct;
pub mod equilibrium;
pub mod error;
pub mod fields;
mod first_order;
pub mod formula;
pub mod friction_problem;
pub mod linear;
pub mod load_cases;
pub mod memory;
mod mortar;
pub mod names;
pub mod patches;
pub mod plausibility;
pub mod qp;
mod scalar;
pub mod scene;
#[cfg(feature = "schema")]
mod schema;
pub mod shape;
mod shelf;
pub mod solvers;
pub mod standstill;
pub mod surfaces;
pub mod tfeti;
mod work_estimate;

pub use first_order::{FirstOrderModel, Predicted, Slope};
pub use work_estimate::WorkEstimate;
