//! A body of a scene: its mesh with materials, supports, loads and tied nodes. What does not depend on the shape.

use crate::body::loaded::Loaded;
use crate::body::mesh::{CellFace, Mesh, narrow};
use crate::body::support::{Directions, held_directions};
use crate::body::{Patterns, Piece, Solid};
use crate::error::SceneError;
use crate::scene::BodyScene;
use std::collections::HashMap;
use std::sync::Arc;

/// The axes.
const AXES: [[f64; 3]; 3] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

/// A body without a shape.
#[derive(Debug)]
pub struct Body {
    /// What messages call it.
    pub name: String,
    /// Its mesh; positions of a shape are given apart from it.
    pub mesh: Arc<Mesh>,
    /// The mesh with materials and tied nodes.
    pub solid: Solid,
    held: HashMap<u32, Directions>,
    pub(crate) loads: Vec<Loaded>,
    /// Its pieces for total FETI.
    pub pieces: Vec<Piece>,
}

impl Body {
    /// A body of a scene with some contact faces, divided into the pieces of its mesh, or into about `piece_count`.
    ///
    /// # Errors
    /// [`SceneError`] for names that the mesh does not have, and for loads and supports that mean nothing.
    pub fn new(
        scene: &BodyScene,
        mesh: Arc<Mesh>,
        contact: &[CellFace],
        piece_count: usize,
    ) -> Result<Self, SceneError> {
        let name = scene.name.as_str();
        let held = held_directions(name, &mesh, &scene.supports)?;
        let loads = scene.loads.iter().enumerate();
        let loads = loads.map(|(index, load)| Loaded::new(&format!("{name}.loads[{index}]"), load, &mesh));
        let loads = loads.collect::<Result<_, _>>()?;
        let mut body = Self {
            name: name.to_owned(),
            solid: Solid::new(name, scene, Arc::clone(&mesh), contact)?,
            held,
            loads,
            pieces: Vec::new(),
            mesh,
        };
        let piece_of = body.mesh.pieces().map_or_else(|| body.mesh.partitioned(piece_count), <[u32]>::to_vec);
        let mut known = Patterns::default();
        let cells = cells_by_piece(&piece_of);
        body.pieces = cells.into_iter().map(|cells| Piece::new(&body.solid, cells, &mut known)).collect();
        Ok(body)
    }

    /// The whole body as one piece.
    pub fn whole(&self) -> Piece {
        Piece::new(&self.solid, (0..self.mesh.cell_count() as u32).collect(), &mut Patterns::default())
    }

    /// The orthonormal directions in which supports hold a node; all for a tied node, which has displacements against
    /// its ends alone.
    pub fn held(&self, node: u32) -> &[[f64; 3]] {
        if self.solid.ends_of(node).is_some() { &AXES } else { self.supported(node) }
    }

    /// The orthonormal directions in which supports hold a node, tied or not: those in which a shape does not move it.
    pub fn supported(&self, node: u32) -> &[[f64; 3]] {
        self.held.get(&node).map_or(&[], Directions::held)
    }

    /// The held directions of a node, each with the first support of the scene that holds it; none for a tied node.
    pub fn held_by(&self, node: u32) -> impl Iterator<Item = ([f64; 3], usize)> + '_ {
        let held = self.held.get(&node).filter(|_| self.solid.ends_of(node).is_none());
        held.into_iter().flat_map(|held| held.held().iter().copied().zip(held.supports().iter().copied()))
    }

    /// The displacement that supports prescribe to a node, along the axes, mm: a sum of its held directions; 0 against
    /// its ends for a tied node.
    pub fn prescribed(&self, node: u32) -> [f64; 3] {
        let held = self.held.get(&node).filter(|_| self.solid.ends_of(node).is_none());
        held.map_or([0.0; 3], Directions::displacement)
    }

    /// The largest component of a displacement that supports prescribe, mm; 0 where they hold nodes at rest.
    pub fn largest_prescribed(&self) -> f64 {
        let components = self.held.values().flat_map(Directions::displacement);
        components.fold(0.0, |largest: f64, component| largest.max(component.abs()))
    }

    /// Orthonormal directions in which a node is free.
    pub fn free(&self, node: u32) -> Vec<[f64; 3]> {
        match self.held.get(&node) {
            _ if self.solid.ends_of(node).is_some() => Vec::new(),
            Some(held) => held.free(),
            None => AXES.to_vec(),
        }
    }

    /// Nodes that supports hold, ascending; tied ones move with their ends and are left out.
    pub fn held_nodes(&self) -> Vec<u32> {
        let mut nodes: Vec<u32> =
            self.held.keys().copied().filter(|node| self.solid.ends_of(*node).is_none()).collect();
        nodes.sort_unstable();
        nodes
    }

    /// Displacements of all nodes, from those of the nodes of a piece that is the whole body.
    pub fn extended(&self, whole: &Piece, values: &[f64]) -> Vec<[f64; 3]> {
        (0..self.mesh.node_count() as u32).map(|node| whole.value_at(&self.solid, node, values)).collect()
    }
}

/// The cells of every piece.
fn cells_by_piece(piece_of: &[u32]) -> Vec<Vec<u32>> {
    let count = piece_of.iter().copied().max().map_or(0, |last| last as usize + 1);
    let mut cells = vec![Vec::new(); count];
    piece_of.iter().enumerate().for_each(|(cell, &piece)| cells[piece as usize].push(narrow(cell)));
    cells
}
