//! Total FETI: torn bodies, dual operator, natural coarse space, preconditioners.
//!
//! ```text
//! F = B K⁺ Bᵀ,  G = Rᵀ Bᵀ,  d = B K⁺ f − g,  e = Rᵀ f,      u = K⁺(f − Bᵀλ) + R a                    method.md (4.1), (4.2)
//! ```

mod derivative;
mod dual;
mod newton;
mod paper;
mod solver;
mod torn;

pub use derivative::adjoint::TornAdjoint;
pub use dual::active_rows::ReducedRows;
pub use dual::coarse_space::{CoarseProblem, CoarseSpace};
pub use dual::operator::{DualOperator, Precision};
pub use dual::preconditioner::{Preconditioner, PreconditionerKind};
pub use newton::iteration::{Iterate, NewtonSettings, Recycling, TornContact, TornSolution};
pub use paper::successive_approximations::{AugmentedLagrangianCounts, AugmentedLagrangianSettings};
pub use solver::{Sensitivities, TornSolver, TornState};
pub use torn::communication::{Communication, InProcess};
pub use torn::constraints::Constraints;
pub use torn::factors::{SubdomainFactors, SubdomainRigid};
pub use torn::model::{TornModel, TornSystem};
