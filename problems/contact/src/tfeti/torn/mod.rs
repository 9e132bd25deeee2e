//! Torn bodies: what is fixed for a run, and what is factored for one shape.
//!
//! ```text
//! scene ─ tearing ─ rows B, B_D (constraints), coarse pattern ─ TornModel ── shape ──▶ TornSystem: K⁺, R, K_II⁻¹ per subdomain
//! torn displacement ─ recovery ──▶ whole bodies
//! ```

mod coarse_pattern;
mod constraints;
mod factors;
mod model;
mod preconditioner_kind;
mod recovery;
mod rigid_modes;
mod vectors;

pub use coarse_pattern::CoarsePattern;
pub use constraints::Constraints;
pub use factors::{SubdomainFactors, SubdomainRigid};
pub use model::{TornModel, TornSubdomain, TornSystem};
pub use preconditioner_kind::PreconditionerKind;
pub use recovery::whole_bodies;
pub use vectors::{RowVector, TornVector};
