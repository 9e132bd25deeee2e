//! What a face of a mesh consists of: planes, cylinders, cones, spheres, and other smooth parts.

use super::CurvedFace;
use crate::body::mesh::{CellFace, Mesh};
use crate::error::SceneError;
use crate::mortar::Primitive;

/// A part of a face within which facets meet at 30° at most.
#[derive(Debug, Clone, PartialEq)]
pub struct FacePart {
    /// The surface that all its nodes lie on, to a millionth of its size.
    pub primitive: Option<Primitive>,
    /// Whether the outside of the body is that of the primitive, as on a shaft and not in a bore; of a plane, whether
    /// its normal points outwards.
    pub is_convex: bool,
}

/// The smooth parts of a face; `name` stands in messages.
///
/// # Errors
/// [`SceneError::OutOfRange`] for a middle node so far from its edge that the facet folds.
pub fn face_parts(name: &str, mesh: &Mesh, faces: &[CellFace]) -> Result<Vec<FacePart>, SceneError> {
    let part = |part: super::curved_face::SmoothPart| FacePart {
        is_convex: part.primitive.is_some_and(|(_, sign)| sign > 0.0),
        primitive: part.primitive.map(|(primitive, _)| primitive),
    };
    Ok(CurvedFace::new(name, mesh, faces)?.parts.into_iter().map(part).collect())
}
