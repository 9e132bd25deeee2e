//! What is asked of a solved shape: how its forces change, and what its residual does to a cost.
//!
//! ```text
//! j = ∂J/∂λ ─ adjoint: q, p ─┬─ shape derivative: ∂J/∂(column heights)
//!                            └─ error estimate: J(state) − J(exact)
//! derivatives of the state ─ contraction: spectral radius of Φ′
//! ```

pub mod adjoint;
pub mod contraction;
pub mod error_estimate;
pub mod shape_derivative;
