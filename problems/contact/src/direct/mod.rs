//! Direct condensation onto the contact nodes: an independent path, used as a cross-check.
//!
//! ```text
//! S u_c = f_c − λ,   S = K_cc − K_ci K_ii⁻¹ K_ic,   f_c = f_c − K_ci K_ii⁻¹ f_i            (per body, whole and untorn)
//! ```
//! Nothing of the total FETI path is used: neither rows, nor rigid modes, nor Krylov methods.

mod adjoint;
mod condensation;
mod diagnosis;
mod error_estimate;
mod newton;
mod recovery;
mod solver;

pub use condensation::{CondensationPattern, CondensedBody};
pub use solver::{DirectSolver, DirectState};
