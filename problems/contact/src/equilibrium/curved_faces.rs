//! The faces of a scene behind whose facets curved surfaces lie.

use crate::body::Body;
use crate::error::SceneError;
use crate::names::find_face;
use crate::patches::{CurvedFace, MiddlePoint};
use crate::scene::{FaceGeometry, NormalKind, Scene};

/// The faces of contacts along true normals, with the surfaces behind their facets.
pub(super) struct CurvedFaces {
    /// By contact: faces whose gaps are those of surfaces, their points numbered after the nodes and points of the
    /// body; none where facets are taken as flat.
    pub contacts: Vec<Option<[CurvedFace; 2]>>,
    /// By body.
    pub points: Vec<Vec<MiddlePoint>>,
    /// By contact, slave and master where any of them is curved, as they are alone.
    pub alone: Vec<Option<[CurvedFace; 2]>>,
}

/// Finds the middles of edges of all pairs of faces between which gaps are those of surfaces. Where nothing is curved,
/// and no shape can curve it, flat facets are the surfaces.
///
/// # Errors
/// [`SceneError::OutOfRange`] for faces that a mesh does not have, and for middle nodes that fold a facet.
pub(super) fn curved_faces(scene: &Scene, bodies: &[Body]) -> Result<CurvedFaces, SceneError> {
    let mut all = CurvedFaces { contacts: Vec::new(), points: vec![Vec::new(); bodies.len()], alone: Vec::new() };
    for (index, contact) in scene.contacts.iter().enumerate() {
        let master = contact.master_face().filter(|_| contact.normal == NormalKind::Surface && !contact.is_tied());
        let Some(master) = master else {
            all.contacts.push(None);
            all.alone.push(None);
            continue;
        };
        let sides = [("slave", &contact.slave), ("master", master)];
        let [slave, master] = sides.map(|(side, face)| {
            let (name, mesh) = (format!("{}.{side}", scene.contact_field(index)), &bodies[face.body].mesh);
            CurvedFace::new(&name, mesh, find_face(&name, &face.face, mesh)?)
        });
        let both = [slave?, master?];
        let is_curved = both.iter().any(|face| face.is_curved);
        let moves = sides.iter().any(|(_, face)| scene.bodies[face.body].shape.is_some());
        all.contacts.push((contact.geometry == FaceGeometry::Curved && (moves || is_curved)).then(|| {
            [0, 1].map(|side| {
                let (face, body) = (both[side].clone(), sides[side].1.body);
                let by = all.points[body].len();
                all.points[body].extend(&face.points);
                face.shifted(&bodies[body].mesh, by)
            })
        }));
        all.alone.push(is_curved.then_some(both));
    }
    Ok(all)
}
