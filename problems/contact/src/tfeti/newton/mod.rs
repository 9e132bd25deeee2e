//! Semismooth Newton for Coulomb friction on the dual problem.
//!
//! ```text
//! start ─▶ iteration ─┬─ descent: one product with F at a time, all directions recycled
//!                     └─ steps: one linear solve (projected GMRES) per active set, step halving
//! iterate ─ derivatives ─ holding: an active set that holds every rigid motion
//! ```

pub mod descent;
pub mod holding;
pub mod iteration;
pub mod linear_solve;
pub mod recycling;
pub mod rounding;
pub mod settings;
pub mod stagnation;
pub mod start;
