//! The contact solver of a scene: by name or by choice, in one process or shared by several.
//!
//! ```text
//! plan (scene, kind, preconditioner, clusters) ─ Processes ─ Solver ─┬─ process 0   announces each call               leader.rs
//!                                                                    └─ process k   makes the same call               follower.rs
//! in every process:   OwnSolver ─ total FETI, direct condensation, or the choice between them                         own_solver.rs
//! ```
//! Of several processes, the first runs the program as a single process would. Only the calls of the contact solver are
//! made by all of them: the first announces each call with its arguments, the others make the same call, and inside it
//! all exchange what the solver shares among them. Nothing that depends on time, files, signals, memory or the user can
//! thus be decided differently by two processes. At the end of a call all agree on whether one of them failed.

mod announcement;
mod call;
mod follower;
mod kind;
mod leader;
mod own_solver;
mod own_state;
mod plan;
mod processes;
mod shared_factors;
mod solver;
mod traffic;

pub use kind::SolverKind;
pub use plan::{SolverPlan, Wanted};
pub use processes::{Processes, follow, lead};
pub use solver::{Solver, SolverState};
pub use traffic::Usage;
