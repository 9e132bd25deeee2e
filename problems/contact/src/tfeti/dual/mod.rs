//! The dual problem of one shape: find multipliers λ and rigid amplitudes a.
//!
//! ```text
//! TornSystem ─┬─ operator: F λ ────────────────┐
//!             ├─ coarse space: G, e, Gᵀ a ─────┼─▶ TornContact: residual of (λ, a), derivatives, active sets
//!             └─ preconditioner: B_D S B_Dᵀ ───┘
//! derivatives ─ active rows: T, Q ─ active set: (T, Q) with its projector P
//! ```

pub mod active_rows;
pub mod active_set;
pub mod coarse_space;
pub mod contact;
pub mod iterate;
pub mod operator;
pub mod preconditioner;
