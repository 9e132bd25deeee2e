//! Fields of a solved shape: displacements and stresses of the bodies, pressures and tractions of contact.
//!
//! ```text
//! σ per brick at its centre (elasticity/stress.rs);   von Mises per node: Σ V_e σ_vM,e / Σ V_e over the adjoining bricks e
//! pressure λ_N/A,   traction λ_T/A,   A the tributary area of the projected grid
//! ```
//! Computed on request, from what the contact solver has: no contact problem is solved again. Units: N, mm, MPa.

mod bodies;
mod contact;
mod solved_shape;

pub use bodies::BodyFields;
pub use contact::ContactFields;
pub use solved_shape::Fields;
