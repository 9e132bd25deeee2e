//! Curved faces behind meshes: middles of facet edges on the true surface, and the primitives that faces lie on.
//!
//! ```text
//! Y(ξ) = Σ Q_k(ξ) X_k + r₀(ξ)      Q: six or eight functions of second degree,  r₀: primitive less patch, at the start
//! ```
//! A face is divided where facets meet at more than 30°, so that sharp edges stay sharp.

mod curved_face;
pub(crate) mod fit;
mod quadric;
mod recognition;
pub(crate) mod smooth_parts;

pub use crate::mortar::Primitive;
pub(crate) use curved_face::{CurvedFace, MiddlePoint, is_off};
pub use recognition::{FacePart, face_parts};
