//! Direct condensation onto the contact nodes: an independent path, and the one that finds loosely held equilibria.
//!
//! ```text
//! w = C (f̂ − Bᵀλ) + N a,   C = B K⁻¹ Bᵀ                  (per body, whole and untorn; N a: rigid motions left free)
//! ```
//! The solution uses nothing of total FETI: neither its constraint rows, nor its coarse space, nor its Krylov methods.

mod active_system;
mod adjoint;
mod compliant_body;
mod compliant_contact;
mod condensation;
mod condensation_key;
mod condensed_shelf;
mod cone_programs;
mod continuation;
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
pub use condensed_shelf::CondensedShelf;
pub use cone_programs::by_cone_programs;
#[cfg(feature = "interior-point")]
pub use resistance::resistance;
pub use solver::{DirectSolver, DirectState};
