//! State problems for the [`nonsmooth`] framework: 3D contact with Coulomb friction and shape controls, a membrane over
//! an obstacle, a 2D toy with closed forms.
//!
//! # Contact shape optimization
//!
//! The controls are spline heights α of the contact surface of an elastic body. The state y = S(α) holds the contact
//! forces of the equilibrium against a rigid obstacle or a second elastic body, with friction. The cost rates the
//! contact pressure. S is nonsmooth where nodes open, close, stick or slip; [`contact_shape::ContactShape`] returns one
//! element of its coderivative by an adjoint solve. Units are N, mm, MPa. The equations are in `docs/method.md` of the
//! repository.
//!
//! ## Θ of a scene in Rust
//!
//! ```
//! use nonsmooth::{NonsmoothObjective, ReducedObjective, Request, StateSolver};
//! use problems::contact_shape::{ContactShape, SolverKind};
//! use problems::cost::{PressureCost, PressureMeasure};
//! use problems::scene::{Scene, signorini};
//!
//! // The paper's Example 5.1, a block against a wavy obstacle, on 4 × 4 × 4 bricks.
//! let scene = Scene { mesh: [4; 3], ..signorini()? };
//! let shape = ContactShape::new(scene, SolverKind::Newton)?;
//! let cost = PressureCost::new(PressureMeasure::Norm { exponent: 4.0 }, &shape.problem().boundary)?;
//! let start = shape.start();
//! let theta = ReducedObjective::new(shape, cost);
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
//! To optimize, hand `theta` to [`nonsmooth::BundleTrust`] with the set of [`shape::AdmissibleSet`]; the command line
//! does that for the binaries ([`cli::execute`]). [`cli::Source`] and [`scene_file`] read scenes from TOML files.
//!
//! ## The contact binaries
//!
//! ```text
//! hertz3d [optimize|evaluate|verify] [options]        signorini3d [optimize|evaluate|verify] [options]
//! contact3d SCENE.toml [optimize|evaluate|verify] [options]
//! ```
//!
//! `optimize` minimises Θ over the admissible shapes, `evaluate` computes Θ, subgradient and certificates at one shape,
//! `verify` makes a Taylor test there; `--help` lists the options. Exit status: 0 success, 1 the computation failed, 2
//! bad input, 130 interrupted. `toy2d` and `membrane2d` run the small problems; `scaling`, `accuracy` and `stability`
//! are studies.
//!
//! # Modules
//!
//! | module | what it holds |
//! |---|---|
//! | [`commands`] | the commands of the contact binaries, their reports and long runs |
//! | [`membrane`], [`toy`] | the other two state problems |

pub mod commands;
pub mod membrane;
pub mod toy;
