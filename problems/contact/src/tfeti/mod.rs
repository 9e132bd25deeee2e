//! Total FETI: torn bodies, dual operator, natural coarse space, preconditioners.
//!
//! ```text
//! F = B K⁺ Bᵀ,  G = Rᵀ Bᵀ,  d = B K⁺ f − g,  e = Rᵀ f,      u = K⁺(f − Bᵀλ) + R a                    method.md (4.1), (4.2)
//! ```

mod adjoint;
mod augmented_lagrangian;
mod coarse;
pub mod communication;
mod constraints;
mod contact_solver;
mod descent;
mod diagnosis;
mod dual_operator;
mod error_estimate;
mod factors;
mod holding;
mod limits;
mod linear_solve;
mod local_pattern;
mod model;
mod newton;
mod preconditioner;
mod projected_dual;
mod recovery;
mod recycling;
mod reduced;
mod rigid_modes;
mod solver;

pub use adjoint::TornAdjoint;
pub use augmented_lagrangian::{AugmentedLagrangianCounts, AugmentedLagrangianSettings};
pub use coarse::{CoarseProblem, CoarseSpace};
pub use communication::{Communication, InProcess};
pub use constraints::Constraints;
pub use contact_solver::{DualMethod, TotalFeti};
pub use dual_operator::{DualOperator, Precision};
pub use factors::{SubdomainFactors, SubdomainRigid};
pub use local_pattern::LocalPattern;
pub use model::{TornModel, TornSystem};
pub use newton::{Iterate, NewtonSettings, Recycling, TornContact, TornSolution};
pub use preconditioner::{Preconditioner, PreconditionerKind};
pub use reduced::ReducedRows;
pub use solver::{TornSolver, TornState};
