//! Fields of a solved shape: displacements and stresses of the bodies, pressures and tractions of contact.
//!
//! ```text
//! σ per cell at its centre (elasticity/stress.rs);   von Mises per node: Σ V_e σ_vM,e / Σ V_e over the adjoining cells e
//! pressure λ_N/A,   traction λ_T/A,   A the tributary area
//! ```
//! Computed on request, from what the contact solver has: no contact problem is solved again. Units: N, mm, MPa.

mod bodies;
mod contact;
mod resultants;
mod solved_shape;

pub use bodies::BodyFields;
pub use contact::ContactFields;
pub use resultants::{BodyResultants, LargestStress, Resultants, SupportReaction};
pub use solved_shape::Fields;
