//! Semismooth Newton on the dual problem.

pub mod descent;
pub mod holding;
pub mod iteration;
pub mod limits;
pub mod linear_solve;
pub mod recycling;
