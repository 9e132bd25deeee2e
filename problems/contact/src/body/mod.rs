//! Elastic bodies: meshes, elasticity on their cells, materials, supports and loads; pieces with their matrices; the
//! element sums of the adjoint.
//!
//! ```text
//! mesh ─ materials, supports, loads, trace ─▶ Body ─ cells ─▶ Piece: pattern, matrix
//! positions of a shape, u, p ─ shape_sensitivity ─▶ −pᵀ∂(K u − f)/∂x      velocities ─ shape_force ─▶ −∂(K u − f)[x′]
//! ```

#[expect(clippy::module_inception, reason = "the type that the folder is named for")]
mod body;
pub mod elasticity;
mod loaded;
pub(crate) mod loads;
pub mod mesh;
mod nodal_axes;
mod piece;
mod rigid_motions;
pub(crate) mod shape_force;
pub(crate) mod shape_sensitivity;
mod solid;
mod support;
mod trace;

pub use body::Body;
pub use loads::load_size;
pub(crate) use nodal_axes::NodalAxes;
pub use piece::{Patterns, Piece, PiecePattern};
pub use rigid_motions::{MOTIONS, rigid_motions};
pub use solid::Solid;
pub(crate) use support::{beyond, nodal_normals, onto};
pub(crate) use trace::{Trace, TraceWeights};
