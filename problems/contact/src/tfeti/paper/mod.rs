//! The paper's method: successive approximations over Tresca problems.

pub mod projected_dual;
pub mod successive_approximations;
