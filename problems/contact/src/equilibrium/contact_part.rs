//! One contact of a scene: its slave facets with an obstacle or the master facets of another body.

use crate::body::Body;
use crate::body::mesh::CellFace;
use crate::equilibrium::obstacle::{Obstacle, SlaveFace};
use crate::equilibrium::opposite::Opposite;
use crate::equilibrium::pair::{Pair, Sides};
use crate::error::SceneError;
use crate::names::find_face;
use crate::patches::CurvedFace;
use crate::scene::{AreaKind, BodyFace, ContactScene, CounterSurface, Master, Scene};
use crate::shape::{Positions, ShapeMap};
use std::sync::Arc;

/// What the rows of a contact are computed from.
#[derive(Debug, Clone)]
pub struct ContactPart {
    /// The slave body.
    pub(crate) slave: usize,
    /// The slave facets.
    pub(crate) faces: Vec<CellFace>,
    pub(crate) opposite: Arc<dyn Opposite>,
    pub(crate) interference: f64,
    pub(crate) is_tied: bool,
    /// The contact nodes, ascending, each with the master nodes that may have weights in its rows, ascending.
    nodes: Vec<(u32, Vec<u32>)>,
    /// Slave nodes that too little of the master lies opposite to at the start: they carry no force.
    pub(crate) uncovered: usize,
}

impl ContactPart {
    /// A contact of a scene, with the positions of all nodes at the start.
    ///
    /// # Errors
    /// [`SceneError::OutOfRange`] for names that the meshes do not have, and for faces that do not lie opposite to each
    /// other.
    pub(crate) fn new(
        (scene, index): (&Scene, usize),
        bodies: &[Body],
        (map, curved): (&ShapeMap, Option<&[CurvedFace; 2]>),
        start: &Positions,
    ) -> Result<Self, SceneError> {
        let (contact, field) = (&scene.contacts[index], scene.contact_field(index));
        let slave = contact.slave.body;
        let name = if contact.master_face().is_some() { format!("{field}.slave") } else { format!("{field}.face") };
        let faces = faces_of(&name, &contact.slave, bodies)?;
        match &contact.master {
            Master::Obstacle(surface) => Ok(Self::on_obstacle(contact, surface, (&bodies[slave], faces), map)),
            Master::Body(master) => {
                let opposite = faces_of(&format!("{field}.master"), master, bodies)?;
                let facets = [(slave, &faces), (master.body, &opposite)];
                let sides = Sides::new(facets.map(|(body, faces)| (body, &bodies[body], faces.as_slice())), curved);
                let reach = sides.bodies.map(|body| scene.bodies[body].reach()).into_iter().sum();
                let (pair, nodes, uncovered) = Pair::new(contact, sides, (map, reach), start);
                let (names, allowed) = (
                    format!("\"{}\" and \"{}\"", contact.slave.face, master.face),
                    "two faces that lie opposite to each other",
                );
                SceneError::require(!nodes.is_empty(), format!("{field}.master"), names, allowed)?;
                let (opposite, interference) = (Arc::new(pair), contact.interference);
                Ok(Self { slave, faces, opposite, interference, is_tied: contact.is_tied(), nodes, uncovered })
            }
        }
    }

    fn on_obstacle(
        contact: &ContactScene,
        surface: &CounterSurface,
        (body, faces): (&Body, Vec<CellFace>),
        map: &ShapeMap,
    ) -> Self {
        let slave = contact.slave.body;
        let moves_across = map.moves_along(slave, 0) || map.moves_along(slave, 1);
        let areas_change = map.shapes(slave) && (contact.area != AreaKind::Projected || moves_across);
        let facets = faces.iter().map(|&face| body.mesh.face_nodes(face).collect()).collect();
        let face = SlaveFace { body: slave, facets, area: contact.area, areas_change };
        let opposite = Arc::new(Obstacle { surface: surface.clone(), normal: contact.normal, face });
        let mut nodes: Vec<u32> = corners(body, &faces).into_iter().flatten().collect();
        nodes.sort_unstable();
        nodes.dedup();
        let nodes = nodes.into_iter().map(|node| (node, Vec::new())).collect();
        let (interference, is_tied) = (contact.interference, contact.is_tied());
        Self { slave, faces, opposite, interference, is_tied, nodes, uncovered: 0 }
    }

    /// The contact nodes with the master nodes in their rows.
    pub(crate) fn nodes(&self) -> impl Iterator<Item = (u32, &[u32])> {
        self.nodes.iter().map(|(node, masters)| (*node, masters.as_slice()))
    }

    /// The corners of the slave facets.
    pub(crate) fn slave_facets(&self, body: &Body) -> Vec<Vec<u32>> {
        corners(body, &self.faces)
    }
}

/// The corners of some facets.
fn corners(body: &Body, faces: &[CellFace]) -> Vec<Vec<u32>> {
    let corners = |face: &CellFace| {
        let (mut nodes, corners) = body.mesh.face_with_corners(*face);
        nodes.truncate(corners);
        nodes
    };
    faces.iter().map(corners).collect()
}

/// The facets of a face that a scene names, at least one.
fn faces_of(field: &str, face: &BodyFace, bodies: &[Body]) -> Result<Vec<CellFace>, SceneError> {
    let faces = find_face(field, &face.face, &bodies[face.body].mesh)?.to_vec();
    SceneError::require(!faces.is_empty(), field, &face.face, "a face with at least one facet")?;
    Ok(faces)
}
