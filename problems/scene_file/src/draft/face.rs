//! A named face with its form.

use contact::body::mesh::{CellFace, Mesh};
use contact::error::SceneError;
use contact::patches::{FacePart, Primitive, face_parts};

/// Part of the area of a face below which its mean normal says nothing: the face goes around the body.
const AROUND: f64 = 0.5;
/// Part of the area of a face that its mean normal has at least, where a plane may touch a face of any form.
const NEARLY_PLANE: f64 = 0.9;

/// A named face.
pub(super) struct Face<'a> {
    pub name: &'a str,
    pub area: f64,
    /// ∫n dA.
    pub normal: [f64; 3],
    /// The corners of its facets.
    pub points: Vec<[f64; 3]>,
    pub form: Form,
}

/// What a face is.
pub(super) enum Form {
    Plane,
    /// A cylinder, cone or sphere, and whether the body is inside of it.
    Round(Primitive, bool),
    /// One smooth part that is neither.
    Free,
    /// So many smooth parts, which meet at edges.
    Several(usize),
}

impl<'a> Face<'a> {
    pub fn new(mesh: &Mesh, name: &'a str, faces: &[CellFace]) -> Result<Self, SceneError> {
        let (mut area, mut normal, mut points) = (0.0, [0.0; 3], Vec::new());
        for &face in faces {
            let (nodes, count) = mesh.face_with_corners(face);
            points.extend(nodes[..count].iter().map(|&node| mesh.nodes()[node as usize]));
            let own = mesh.face_vector(face, mesh.nodes());
            area += length(own);
            (0..3).for_each(|axis| normal[axis] += own[axis]);
        }
        let form = match &face_parts(name, mesh, faces)?[..] {
            [FacePart { primitive: Some(Primitive::Plane { .. }), .. }] => Form::Plane,
            [FacePart { primitive: Some(primitive), is_convex, .. }] => Form::Round(*primitive, *is_convex),
            [_] => Form::Free,
            parts => Form::Several(parts.len()),
        };
        Ok(Self { name, area, normal, points, form })
    }

    /// The unit mean normal; none of a face that goes around the body.
    pub fn direction(&self) -> Option<[f64; 3]> {
        let size = length(self.normal);
        (size >= AROUND * self.area).then(|| self.normal.map(|part| part / size))
    }

    /// Whether a plane may touch it, whatever its form.
    pub fn is_nearly_plane(&self) -> bool {
        length(self.normal) >= NEARLY_PLANE * self.area
    }

    /// What it is, in words.
    pub fn words(&self) -> String {
        let inside = |convex: &bool, hole: &str, solid: &str| if *convex { solid.to_owned() } else { hole.to_owned() };
        match &self.form {
            Form::Plane => "plane".into(),
            Form::Round(Primitive::Cylinder { radius, .. }, convex) => {
                format!("{} of radius {} mm", inside(convex, "bore", "cylinder"), super::text::plain(*radius))
            }
            Form::Round(Primitive::Sphere { radius, .. }, convex) => {
                format!("{} of radius {} mm", inside(convex, "spherical seat", "sphere"), super::text::plain(*radius))
            }
            Form::Round(_, convex) => inside(convex, "conical seat", "cone"),
            Form::Free => "curved".into(),
            Form::Several(count) => format!("{count} smooth parts"),
        }
    }
}

pub(super) fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

pub(super) fn length(a: [f64; 3]) -> f64 {
    dot(a, a).sqrt()
}
