//! Unilateral contact with Coulomb friction: boundary, law, state.

pub mod diagnosis;
pub mod law;
pub mod modes;

mod boundary;
pub(crate) mod certificate;
mod configuration;
mod contact_solver;
mod problem;
mod solved_body;
mod stage;
mod state;
mod value_error;

pub use boundary::{ContactBoundary, ContactPoint};
pub use certificate::{Kink, Residuals, StatusCounts, WEAKLY_ACTIVE};
pub use configuration::Configuration;
pub use contact_solver::{ContactSolver, Sensitivities};
pub use diagnosis::Diagnosis;
pub use problem::ContactProblem;
pub use solved_body::SolvedBody;
pub use stage::{Stage, TARGET as STAGE_TARGET};
pub use state::{AnyState, ContactForces, ContactState, ContactWarmStart, SolverState, StageSeconds, Work};
pub use value_error::ValueError;

/// What a contact node does; method.md (3.2), (3.3).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, serde::Serialize, serde::Deserialize)]
pub enum ContactStatus {
    /// No contact: λ_N = 0.
    Open,
    /// Closed, |λ_T| < 𝓕λ_N, no tangential jump.
    Stick,
    /// Closed, |λ_T| = 𝓕λ_N.
    Slip,
}
