//! Nonsmooth optimization with pluggable state problems: few evaluations, constraints, and a certificate at the end.
//!
//! ```text
//! minimise Θ(α) = J(α, S(α))  over  α ∈ U,      ξ = ∇₁J + D*S(α)(∇₂J) ∈ ∂Θ(α)              method.md (1.1), (1.2)
//! ```
//!
//! # The problem
//!
//! **Θ = J∘S.** Some controls α (a shape, loads, a material) determine a state y = S(α), the solution of an
//! equilibrium: a contact problem, a variational inequality, an inner optimization. A cost J(α, y) rates controls and
//! state together. The *reduced objective* Θ(α) = J(α, S(α)) is minimised over the admissible set U, a box with linear
//! rows. S is locally Lipschitz but not differentiable everywhere: it has a kink wherever a body comes into contact, a
//! spring meets a stop, or a constraint of the inner problem becomes active. Minimisers often lie on kinks, where no
//! gradient exists and gradient methods stop too early.
//!
//! **A Clarke subgradient.** A Lipschitz function is differentiable almost everywhere. Its Clarke subdifferential ∂Θ(α)
//! is the convex hull of all limits of gradients ∇Θ(αₖ) with αₖ → α; a *subgradient* ξ is one element of it. Where Θ is
//! continuously differentiable, ξ is the gradient. For |x| it is sign x, and at 0 any number in \[−1, 1\]. A minimiser
//! inside U has 0 ∈ ∂Θ(α), although no single gradient nearby need be small.
//!
//! **A coderivative.** For a smooth S, the coderivative D\*S(α)(y\*) is S′(α)ᵀ y\*. For an S with kinks, it contains
//! the limits of S′(αₖ)ᵀ y\* with αₖ → α. One element costs one adjoint solve at the state that was found, whatever the
//! number of controls; on a kink, the derivative of either side gives an element. The chain rule above turns an element
//! into a subgradient of Θ.
//!
//! **Why one per point is enough.** A bundle method keeps the value and the subgradient of every point it visits as a
//! *cut*, a plane that touches Θ there. Points on different sides of a kink contribute different cuts; their maximum is
//! a model with the kink in it. The next point minimises the model plus a distance term over U. Either it is clearly
//! better (*serious step*), or its cut improves the model (*null step*). When a convex combination of subgradients from
//! nearby points vanishes (up to multipliers of active constraints), the point is stationary, and the combination is
//! the proof. Nobody has to compute all of ∂Θ.
//!
//! # A complete small problem
//!
//! A spring of unit stiffness is pulled with force p and meets a stop at distance g. Its travel y solves p = y + λ,
//! y ≤ g, λ ≥ 0, λ (g − y) = 0, so y = min(p, g). The cost is J = ½p² + ½g² − 2y, and the controls must satisfy
//! p + g ≤ 3/2. At the optimum p = g = 3/4 the spring just touches its stop: Θ = −15/16 lies on a kink, with an active
//! constraint of multiplier 1/4.
//!
//! ```
//! use nonsmooth::verify::{Direction, STEPS, taylor_test};
//! use nonsmooth::{
//!     Accuracy, BundleTrust, BundleTrustConfig, Coderivative, Cost, CostGradient, Matrix, OracleError, Polyhedron,
//!     ReducedObjective, Sensitivity, StateSolver, Vector,
//! };
//!
//! struct SpringWithStop;
//!
//! /// The state, with all that its derivative needs.
//! struct Travel {
//!     length: f64,
//!     at_the_stop: bool,
//! }
//!
//! // 1. The state solver: controls (p, g) ↦ travel.
//! impl StateSolver for SpringWithStop {
//!     type State = Travel;
//!     type WarmStart = ();
//!
//!     fn control_dimension(&self) -> usize {
//!         2
//!     }
//!
//!     fn solve(&self, control: &Vector, _start: Option<&()>, _accuracy: Accuracy) -> Result<Travel, OracleError> {
//!         Ok(Travel { length: control[0].min(control[1]), at_the_stop: control[0] > control[1] })
//!     }
//!
//!     fn warm_start(&self, _state: &Travel) {}
//! }
//!
//! // 2. The coderivative: S′(p, g)ᵀ y* of the piece that the state lies on; on the kink p = g that of the free spring.
//! impl Coderivative for SpringWithStop {
//!     fn coderivative(&self, _: &Vector, state: &Travel, direction: &Vector) -> Result<Sensitivity, OracleError> {
//!         let dual = direction[0];
//!         let element = if state.at_the_stop { vec![0.0, dual] } else { vec![dual, 0.0] };
//!         Ok(Sensitivity::exact(Vector::from_vec(element)))
//!     }
//! }
//!
//! struct Benefit;
//!
//! // 3. The cost and its two partial gradients.
//! impl Cost<Travel> for Benefit {
//!     fn value(&self, control: &Vector, state: &Travel) -> f64 {
//!         0.5 * control.norm_squared() - 2.0 * state.length
//!     }
//!
//!     fn gradient(&self, control: &Vector, _state: &Travel) -> CostGradient {
//!         CostGradient { control: control.clone(), state: Vector::from_element(1, -2.0) }
//!     }
//! }
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let theta = ReducedObjective::new(SpringWithStop, Benefit);
//!
//! // 4. Is the subgradient right? Away from kinks the remainder of the Taylor test falls with the square of the step.
//! let test = taylor_test(&theta, &Vector::from_vec(vec![0.9, 0.3]), &Direction::Seeded(1), &STEPS)?;
//! assert!(test.fitted_slope.is_some_and(|slope| (slope - 2.0).abs() < 0.1), "{test}");
//!
//! // 5. The admissible set: 0 ≤ p, g ≤ 2 and p + g ≤ 3/2.
//! let sum = Matrix::from_element(1, 2, 1.0);
//! let open = Vector::from_element(1, f64::NEG_INFINITY);
//! let set = Polyhedron::boxed(Vector::zeros(2), Vector::from_element(2, 2.0))?
//!     .with_rows(&sum, &open, &Vector::from_element(1, 1.5))?;
//!
//! // 6. The run.
//! let start = Vector::from_vec(vec![1.0, 0.25]);
//! let report = BundleTrust::new(BundleTrustConfig::default())?.constraints(set.clone()).minimize(&theta, start)?;
//!
//! // 7. Reading the report: why it ended, what was found, what it cost.
//! println!("{report}");
//! assert!(report.termination.is_stationary(), "{report}");
//! assert!((report.value + 15.0 / 16.0).abs() < 1e-7);
//! assert!((report.solution[0] - 0.75).abs() < 1e-3 && (report.solution[1] - 0.75).abs() < 1e-3);
//! assert!(report.counts.evaluations < 30);
//! assert_eq!(report.history.len(), report.counts.evaluations);
//!
//! // 8. The certificate: cuts on both sides of the kink, and the multiplier of p + g ≤ 3/2.
//! let certificate = report.certificate.ok_or("no subproblem was solved")?;
//! assert!(certificate.active_cuts().any(|cut| cut.point[0] > cut.point[1]));
//! assert!(certificate.active_cuts().any(|cut| cut.point[0] <= cut.point[1]));
//! assert!((certificate.row_multipliers[0] - 0.25).abs() < 1e-3);
//! // Computed again from its cuts and multipliers alone, without the optimizer.
//! assert!(certificate.recheck(&set)?.confirms(1e-3, 1e-6));
//! # Ok(())
//! # }
//! ```
//!
//! # What the report promises
//!
//! * [`Report::solution`] is the point that [`Report::termination`] speaks about, or, where the run ends by a limit or
//!   a failure, the lowest point evaluated; it is admissible. Θ was never evaluated outside U, up to the rounding that
//!   [`Report::largest_violation`] states.
//! * [`Report::termination`] says why the run ended, with numbers. Only [`Termination::Stationary`] calls the point a
//!   confirmed stationary point; [`Report::advice`] says what to try after each of the others.
//! * [`Report::certificate`] holds all cuts and multipliers of the last subproblem. [`Certificate::recheck`] computes
//!   the aggregate subgradient z̃ and its error ẽ from them. For a convex Θ they bound what is left to gain: Θ(α) ≥
//!   Θ(x̂) − ‖z̃‖‖α − x̂‖ − ẽ for all α ∈ U. For a nonconvex Θ they are a *local* statement about the model near x̂.
//! * A failing evaluation (an error, NaN, a panic) shortens the step and is counted; the best point is not lost.
//! * The report does not promise a global minimum of a nonconvex Θ, nor anything if the subgradients are wrong: run
//!   [`verify::taylor_test`] first.
//!
//! What the theory asks of Θ: it is Lipschitz near the points visited, and the returned ξ lies in ∂Θ. Convergence
//! proofs of bundle methods also want weak semismoothness, which functions made of finitely many smooth pieces have.
//!
//! # Where to go next
//!
//! * A function without a state: [`FnObjective`] turns a closure into an objective.
//! * States from an iterative solver: every request states the [`Accuracy`] it needs, and the answer states its
//!   [`Evaluation::error_bound`]. [`AccuracyPolicy::ON_DEMAND`] asks for no more than a step needs, and
//!   [`Answer::NoDescent`] ends an evaluation early that cannot become a serious step.
//! * Long runs: [`Journaled`] keeps every evaluation, so that a run that was killed continues bit by bit; [`Observer`]
//!   and [`StopRule`] watch and end it.
//! * The examples of the repository: `own_problem` (three traits), `closure`, `constrained_minimax`, `inexact_oracle`,
//!   `checkpoint`, `observer`, `testset`. Its guides: `docs/plug_in_your_problem.md` (the steps above with all
//!   details), `docs/bundle.md` (the method's rules, constants and measured evaluation counts).
//! * State problems in the same repository: contact with friction in the crate `contact`, a membrane over an obstacle
//!   and a closed-form toy in the crate `problems`.
//!
//! # Features
//!
//! `interior-point` (on by default) brings an interior-point method as the second path of the subproblem, and 18
//! packages. Without it, a subproblem that the active-set method cannot finish is tried again with shorter steps; if
//! that does not help, the run ends with [`Termination::SubproblemFailed`]. None of the test problems needs it.
//!
//! # Modules
//!
//! | where | what |
//! |---|---|
//! | here | the problem: [`StateSolver`], [`Coderivative`], [`Cost`], and [`ReducedObjective`] for Θ = J∘S |
//! | here | the objective as the method sees it: [`NonsmoothObjective`], [`Request`], [`Answer`]; [`FnObjective`] |
//! | here | admissible set and constraints: [`Polyhedron`], [`ConstraintKind`], [`ConstrainedFunction`] |
//! | here | the method: [`BundleTrust`], [`BundleTrustConfig`], [`Run`] |
//! | here | its result: [`Report`], [`Termination`], [`Certificate`], [`IterationRecord`]; [`Observer`], [`StopRule`] |
//! | [`composite`] | Θ = h∘c with a known convex h: outer functions, Jacobians of the outputs |
//! | [`runs`] | several runs in turn: starts, subspaces, objectives |
//! | [`verify`] | Taylor tests of any objective |
//! | [`journal`] | [`Journaled`]: an objective whose evaluations survive the run |
//! | [`qp`] | the subproblem as a convex QP of its own, with certificate; projection onto a polyhedron |
//! | [`interruption`] | how long loops hear that nobody waits for their result |

/// The version of this crate, for reports.
pub const VERSION: &str = env!("CARGO_PKG_VERSION");

pub mod composite;
pub mod interruption;
pub mod journal;
pub mod qp;
pub mod runs;
pub mod verify;

mod accuracy;
mod bundle;
mod checks;
mod composite_objective;
mod constrained_function;
mod constraints;
mod error;
mod linalg;
mod nonlinear;
mod objective;
mod panics;
mod plain;
mod problem;
mod reduced;
mod report;

pub use accuracy::Accuracy;
pub use bundle::{
    AccuracyPolicy, BundleTrust, BundleTrustConfig, Convexity, Cut, OuterCut, Run, ScaledNorm, VariableScaling,
};
pub use composite_objective::{CompositeFunction, CompositeObjective, OutputJacobian};
pub use constrained_function::ConstrainedFunction;
pub use constraints::Polyhedron;
pub use error::{InputError, OptimizeError, OracleError};
pub use journal::{Journal, JournalError, Journaled};
pub use linalg::{Matrix, Vector};
pub use nonlinear::{ConstraintEvaluation, ConstraintKind, ConstraintPiece};
pub use objective::{Answer, Evaluation, FnAnswer, FnObjective, NonsmoothObjective, Request};
pub use problem::{Coderivative, Cost, CostGradient, Sensitivity, StateSolver};
pub use reduced::ReducedObjective;
pub use report::{
    Certificate, CertificateCheck, CompositeProof, ConstraintCut, ConstraintProof, ConstraintReport, Counts,
    IterationRecord, Observer, Origin, ProofCheck, Report, StepKind, StopRule, TablePrinter, Termination, TrialCounts,
};
