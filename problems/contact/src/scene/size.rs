//! Sizes of a scene before it is made discrete: what estimates of work and memory need.

use crate::body::mesh::Mesh;
use crate::scene::{BodyScene, Geometry, Scene};
use std::collections::BTreeSet;

/// Numbers of nodes and pieces of a body.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BodySize {
    /// Nodes of the body.
    pub nodes: f64,
    /// Cells of the body.
    pub cells: f64,
    /// Whether most of them are of second order.
    pub is_second_order: bool,
    /// Cubes of as many nodes per edge as the body is thick, side by side, that have its nodes; at least 1.
    pub cubes: f64,
    /// Pieces of the body.
    pub pieces: f64,
    /// Nodes of a piece.
    pub piece_nodes: f64,
    /// Nodes on its contact faces.
    pub contact_nodes: f64,
    /// Pieces with nodes on contact faces.
    pub contact_pieces: f64,
}

/// The sizes of all bodies.
#[derive(Debug, Clone, PartialEq)]
pub struct SceneSize {
    /// The bodies, in the order of the scene.
    pub bodies: Vec<BodySize>,
    /// Contact nodes: those of the slave faces.
    pub contact_nodes: f64,
}

impl SceneSize {
    /// The sizes of a scene; those of the pieces of a mesh are estimated.
    pub fn of(scene: &Scene) -> Self {
        let faces = |body: usize, with_masters: bool| {
            let faces = scene.contacts.iter().flat_map(move |contact| {
                std::iter::once(&contact.slave).chain(contact.master_face().filter(|_| with_masters))
            });
            let own = faces.filter(|face| face.body == body).map(|face| face.face.as_str());
            own.collect::<BTreeSet<&str>>()
        };
        let bodies = || scene.bodies.iter().enumerate();
        Self {
            bodies: bodies().map(|(number, body)| BodySize::of(body, &faces(number, true))).collect(),
            contact_nodes: bodies().map(|(number, body)| face_nodes(body, &faces(number, false))).sum(),
        }
    }

    /// The sum of a number over all bodies.
    pub fn sum(&self, number: impl Fn(&BodySize) -> f64) -> f64 {
        self.bodies.iter().map(number).sum()
    }
}

impl BodySize {
    fn of(body: &BodyScene, faces: &BTreeSet<&str>) -> Self {
        let contact_nodes = face_nodes(body, faces);
        match &body.geometry {
            Geometry::Block(block) => {
                let nodes = |cells: [f64; 3]| cells.iter().map(|cells| cells + 1.0).product::<f64>();
                let cells = block.bricks.map(|cells| cells as f64);
                let of_piece = std::array::from_fn(|axis| cells[axis] / block.subdomains[axis] as f64);
                Self {
                    nodes: nodes(cells),
                    cells: cells.iter().product(),
                    is_second_order: false,
                    cubes: cubes(nodes(cells), nodes(cells) - cells.iter().map(|cells| cells - 1.0).product::<f64>()),
                    pieces: block.subdomains.iter().product::<usize>() as f64,
                    piece_nodes: nodes(of_piece),
                    contact_nodes,
                    contact_pieces: (faces.len() * block.subdomains[0] * block.subdomains[1]) as f64,
                }
            }
            Geometry::Mesh(geometry) => {
                let mesh = &geometry.mesh;
                let (nodes, pieces) = (mesh.node_count() as f64, geometry.piece_count() as f64);
                // Pieces are as long along all axes, and share their outer layers of nodes.
                let piece_nodes = if pieces > 1.0 { ((nodes / pieces).cbrt() + 1.0).powi(3) } else { nodes };
                Self {
                    nodes,
                    cells: mesh.cell_count() as f64,
                    is_second_order: geometry.is_second_order(),
                    cubes: cubes(nodes, skin_nodes(mesh)),
                    pieces,
                    piece_nodes,
                    contact_nodes,
                    contact_pieces: pieces.min(1.0 + contact_nodes / piece_nodes.powf(2.0 / 3.0)),
                }
            }
        }
    }
}

/// Cubes of as many nodes as a body, as thick as it is: its thickness is that of a cube of equal share of skin.
fn cubes(nodes: f64, skin_nodes: f64) -> f64 {
    let thickness = 6.0 * nodes / skin_nodes;
    (nodes / thickness.powi(3)).max(1.0)
}

/// Nodes on the skin of a mesh.
fn skin_nodes(mesh: &Mesh) -> f64 {
    let nodes: BTreeSet<u32> = mesh.skin().into_iter().flat_map(|face| mesh.face_nodes(face)).collect();
    nodes.len() as f64
}

/// Nodes on some faces of a body.
fn face_nodes(body: &BodyScene, faces: &BTreeSet<&str>) -> f64 {
    match &body.geometry {
        Geometry::Block(block) => faces.len() as f64 * (block.bricks[0] as f64 + 1.0) * (block.bricks[1] as f64 + 1.0),
        Geometry::Mesh(geometry) => faces.iter().map(|face| corners(&geometry.mesh, face)).sum(),
    }
}

/// Corners of the facets of a face of a mesh.
fn corners(mesh: &Mesh, face: &str) -> f64 {
    let faces = mesh.faces().get(face).into_iter().flatten();
    let corners = faces.flat_map(|face| {
        let (nodes, corners) = mesh.face_with_corners(*face);
        nodes.into_iter().take(corners)
    });
    corners.collect::<BTreeSet<u32>>().len() as f64
}
