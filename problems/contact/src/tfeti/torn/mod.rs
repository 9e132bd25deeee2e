//! Torn bodies: what is fixed for a run, and what is factored for one shape.
//!
//! ```text
//! pieces ─ numbering ─ rows B_E (constraints), coarse pattern ─ TornModel ── shape ──▶ TornSystem: K⁺, R, K_II⁻¹ per subdomain; B, B_D
//! torn displacement ─ recovery ──▶ whole bodies;   loads of whole bodies ─ recovery, transposed ──▶ torn loads
//! ```

mod cluster_factors;
mod cluster_rows;
mod coarse_pattern;
mod constraints;
mod copies;
mod distribution;
mod factored_body;
mod factorization;
mod factors;
mod interface;
mod joints;
mod model;
mod numbering;
mod options;
mod preconditioner_kind;
mod recovery;
mod rigid_modes;
mod row_sums;
mod scene_rows;
mod system;
mod vectors;

pub use coarse_pattern::CoarsePattern;
pub use constraints::Constraints;
pub use distribution::Distribution;
pub use factored_body::TornShelf;
pub use factors::SubdomainFactors;
pub use model::TornModel;
pub use options::TornOptions;
pub use preconditioner_kind::PreconditionerKind;
pub use recovery::{torn_loads, whole_bodies};
pub use system::TornSystem;
pub(crate) use vectors::parts_mut;
pub use vectors::{RowVector, TornVector};
