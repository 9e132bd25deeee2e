//! The faces of a scene behind whose facets curved surfaces lie.

use crate::body::Body;
use crate::body::mesh::narrow;
use crate::equilibrium::facet_noise::FacetNoise;
use crate::error::SceneError;
use crate::names::find_face;
use crate::patches::{BentFace, MiddlePoint};
use crate::scene::{BodyFace, FaceGeometry, NormalKind, Scene};

/// The faces of contacts whose gaps are those of surfaces.
pub(super) struct BentFaces {
    /// By contact; none where facets are taken as flat.
    pub contacts: Vec<Option<[BentFace; 2]>>,
    /// By body.
    pub points: Vec<Vec<MiddlePoint>>,
    /// By contact.
    pub noise: Vec<Option<FacetNoise>>,
}

/// Finds the middles of edges of all pairs of faces between which gaps are those of surfaces. Where nothing is bent,
/// and no shape can bend it, flat facets are the surfaces.
pub(super) fn bent_faces(scene: &Scene, bodies: &[Body]) -> Result<BentFaces, SceneError> {
    let mut all = BentFaces { contacts: Vec::new(), points: vec![Vec::new(); bodies.len()], noise: Vec::new() };
    for (index, contact) in scene.contacts.iter().enumerate() {
        let master = contact.master_face().filter(|_| contact.normal == NormalKind::Surface && !contact.is_tied());
        let Some(master) = master else {
            all.contacts.push(None);
            all.noise.push(None);
            continue;
        };
        let field = scene.contact_field(index);
        let mut next: Vec<usize> =
            (0..bodies.len()).map(|b| bodies[b].mesh.node_count() + all.points[b].len()).collect();
        let mut face = |side: &str, face: &BodyFace| -> Result<BentFace, SceneError> {
            let mesh = &bodies[face.body].mesh;
            let faces = find_face(&format!("{field}.{side}"), &face.face, mesh)?;
            let bent = BentFace::new(mesh, faces, narrow(next[face.body]));
            next[face.body] += bent.points.len();
            Ok(bent)
        };
        let both = [face("slave", &contact.slave)?, face("master", master)?];
        let is_curved = contact.geometry == FaceGeometry::Curved;
        let meshes = [contact.slave.body, master.body].map(|body| &*bodies[body].mesh);
        let is_bent = both.iter().any(|face| face.is_bent);
        all.noise.push(is_bent.then(|| FacetNoise::new(is_curved, meshes, &both)));
        let bodies = [contact.slave.body, master.body];
        let moves = bodies.iter().any(|&body| scene.bodies[body].shape.is_some());
        if !is_curved || (!moves && !is_bent) {
            all.contacts.push(None);
            continue;
        }
        for (body, face) in bodies.into_iter().zip(&both) {
            all.points[body].extend(&face.points);
        }
        all.contacts.push(Some(both));
    }
    Ok(all)
}
