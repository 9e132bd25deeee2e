//! The dual problem of one shape: find multipliers λ and rigid amplitudes a.
//!
//! ```text
//! TornSystem ─┬─ operator: F λ ────────────────┐
//!             ├─ coarse space: G, e, Gᵀ a ─────┼─▶ TornContact: residual of (λ, a), derivatives, active sets
//!             └─ preconditioner: B_D S B_Dᵀ ───┘
//! derivatives ─ active rows: T, Q ─ active set: (T, Q) with its projector P; its coarse matrix: constant part and contact
//! ```

mod active_rows;
mod active_set;
mod coarse_matrix;
mod coarse_rows;
mod coarse_space;
mod contact;
mod iterate;
mod operator;
mod preconditioner;
mod rigid_rows;

pub use active_rows::ActiveRows;
pub use active_set::ActiveSet;
pub use coarse_space::CoarseSpace;
pub use contact::TornContact;
pub use iterate::{Iterate, TornSolution};
pub use operator::{DualOperator, Precision};
pub use preconditioner::Preconditioner;
