//! The paper's method: successive approximations of the slip bounds.
//!
//! ```text
//! slip bounds Ψ ─▶ Tresca problem: dual QP of the projected dual ─ SMALSE-M, MPGP (crate::qp) ─▶ λ ─▶ Ψ = 𝓕 λ_N
//! ```

pub mod projected_dual;
pub mod successive_approximations;
