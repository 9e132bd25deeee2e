//! What a solved state says beyond itself: adjoint, error of a cost, contraction.

pub mod adjoint;
pub mod contraction;
pub mod error_estimate;
