//! The paper's method: successive approximations of the slip bounds.
//!
//! ```text
//! slip bounds Ψ ─▶ Tresca problem: dual QP of the projected dual ─ SMALSE-M, MPGP (crate::qp) ─▶ λ ─▶ Ψ = 𝓕 λ_N
//! ```

mod projected_dual;
mod successive_approximations;

pub use successive_approximations::{
    AugmentedLagrangianCounts, AugmentedLagrangianSettings, solve_by_successive_approximations,
};
