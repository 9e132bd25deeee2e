//! What is asked of a solved shape: how its forces change, and what its residual does to a cost.
//!
//! ```text
//! j = ∂J/∂λ ─┬─ adjoint: q, p ─┬─ shape derivative: ∂J/∂(positions of the nodes)
//! l = ∂J/∂u ─┘                 └─ error estimate: J(state) − J(exact)
//! velocities of the nodes ─ shape loads: r, δe ─ tangents: δλ, changes of the openings, all columns in lockstep
//! derivatives of the state ─ contraction: spectral radius of Φ′
//! ```

mod adjoint;
mod contraction;
mod cycles;
mod displacement_load;
mod error_estimate;
mod shape_derivative;
mod shape_loads;
mod tangents;

pub use adjoint::adjoint;
pub use contraction::{diagnose, estimate_contraction};
pub use displacement_load::DisplacementLoad;
pub use error_estimate::value_error;
pub use shape_derivative::{SolvedShape, shape_derivative};
pub(crate) use tangents::MAX_COLUMNS;
pub use tangents::{TangentRequest, tangents};
