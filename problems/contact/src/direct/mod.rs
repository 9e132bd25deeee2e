//! Direct condensation onto the contact nodes: an independent path, and the one that finds loosely held equilibria.
//!
//! ```text
//! S u_c = f̂_c − Bᵀλ,   S = K_cc − K_ci K_ii⁻¹ K_ic,   f̂_c = f_c − K_ci K_ii⁻¹ f_i           (per body, whole and untorn)
//! ```
//! The solution uses nothing of total FETI: neither its constraint rows, nor its coarse space, nor its Krylov methods.

mod adjoint;
mod compliant_body;
mod compliant_contact;
mod condensation;
mod condensation_key;
mod cone_programs;
mod congruence;
mod continuation;
mod coordinates;
mod diagnosis;
mod displacement_load;
mod displacement_tangents;
mod force_rounding;
mod forces;
mod newton;
mod questions;
mod recovery;
#[cfg(feature = "interior-point")]
mod resistance;
mod shape;
mod solver;
mod tangents;

pub use compliant_contact::CompliantContact;
pub use condensation::CondensationPattern;
pub use condensation_key::CondensedShelf;
pub use cone_programs::by_cone_programs;
#[cfg(feature = "interior-point")]
pub use resistance::resistance;
pub use solver::{DirectSolver, DirectState};
