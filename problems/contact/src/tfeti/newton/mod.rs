//! Semismooth Newton for Coulomb friction on the dual problem.
//!
//! ```text
//! start ─▶ iteration ─┬─ descent: one product with F at a time, all directions recycled
//!                     ├─ steps: one linear solve (projected GMRES) per active set, step halving
//!                     └─ continuation: steps at contact nodes that yield less and less
//! iterate ─ derivatives ─ holding: an active set that holds every rigid motion
//! ```

mod continuation;
mod descent;
mod holding;
mod iteration;
mod linear_solve;
mod recycling;
mod rounding;
mod settings;
mod stagnation;
mod start;
mod steps;

pub use iteration::solve;
pub use settings::{NewtonSettings, Recycling};
pub(crate) use start::{balanced, first_iterate, slip_bounds};
