//! Torn bodies: what is fixed for a run, and what is factored for one shape.
//!
//! ```text
//! scene ─ tearing ─ rows B, B_D (constraints) ─ TornModel ── shape ──▶ TornSystem: K⁺, R, K_II⁻¹ per subdomain
//! torn displacement ─ recovery ──▶ whole bodies
//! ```

pub mod communication;
pub mod constraints;
pub mod factors;
pub mod model;
pub mod preconditioner_kind;
pub mod recovery;
pub mod rigid_modes;
pub mod vectors;
