//! The dual problem: operator, coarse space, preconditioner, active rows.

pub mod active_rows;
pub mod coarse_space;
pub mod operator;
pub mod preconditioner;
