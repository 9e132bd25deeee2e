//! Sizes of a scene before it is made discrete: what estimates of work and memory need.

use crate::scene::{Geometry, Scene};
use std::collections::BTreeSet;

/// Numbers of nodes and pieces; all bodies of a scene are alike.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SceneSize {
    /// Number of bodies.
    pub bodies: f64,
    /// Nodes of a body.
    pub nodes: f64,
    /// Cells of a body.
    pub cells: f64,
    /// Pieces of a body.
    pub pieces: f64,
    /// Nodes of a piece.
    pub piece_nodes: f64,
    /// Contact nodes.
    pub contact_nodes: f64,
    /// Pieces of a body with contact nodes.
    pub contact_pieces: f64,
}

impl SceneSize {
    /// The sizes of a scene; those of the pieces of a mesh are estimated.
    pub fn of(scene: &Scene) -> Self {
        let bodies = scene.body_count() as f64;
        match &scene.geometry {
            Geometry::Blocks(blocks) => {
                let nodes = |cells: [f64; 3]| cells.iter().map(|cells| cells + 1.0).product::<f64>();
                let cells = blocks.bricks.map(|cells| cells as f64);
                let of_piece = std::array::from_fn(|axis| cells[axis] / blocks.subdomains[axis] as f64);
                Self {
                    bodies,
                    nodes: nodes(cells),
                    cells: cells.iter().product(),
                    pieces: blocks.subdomains.iter().product::<usize>() as f64,
                    piece_nodes: nodes(of_piece),
                    contact_nodes: (cells[0] + 1.0) * (cells[1] + 1.0),
                    contact_pieces: (blocks.subdomains[0] * blocks.subdomains[1]) as f64,
                }
            }
            Geometry::Mesh(geometry) => {
                let mesh = &geometry.mesh;
                let faces = mesh.faces().get(&scene.contact.face).into_iter().flatten();
                let corners = faces.flat_map(|face| {
                    let (nodes, corners) = mesh.face_with_corners(*face);
                    nodes.into_iter().take(corners)
                });
                let contact_nodes = corners.collect::<BTreeSet<u32>>().len() as f64;
                let (nodes, pieces) = (mesh.node_count() as f64, geometry.piece_count() as f64);
                // Pieces are as long along all axes, and share their outer layers of nodes.
                let piece_nodes = if pieces > 1.0 { ((nodes / pieces).cbrt() + 1.0).powi(3) } else { nodes };
                Self {
                    bodies,
                    nodes,
                    cells: mesh.cell_count() as f64,
                    pieces,
                    piece_nodes,
                    contact_nodes,
                    contact_pieces: pieces.min(1.0 + contact_nodes / piece_nodes.powf(2.0 / 3.0)),
                }
            }
        }
    }
}
