//! What is asked of a solved shape: how its forces change, and what its residual does to a cost.
//!
//! ```text
//! j = ∂J/∂λ ─ adjoint: q, p ─┬─ shape derivative: ∂J/∂(column heights)
//!                            └─ error estimate: J(state) − J(exact)
//! derivatives of the state ─ contraction: spectral radius of Φ′
//! ```

mod adjoint;
mod contraction;
mod error_estimate;
mod shape_derivative;

pub use shape_derivative::height_sensitivities;
