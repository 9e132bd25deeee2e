//! A body of a scene: its mesh with materials, supports, loads and trace. What does not depend on the shape.

use crate::body::loaded::Loaded;
use crate::body::mesh::{CellFace, Mesh, narrow};
use crate::body::support::{Directions, held_directions};
use crate::body::{Patterns, Piece, Solid, Trace};
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
    /// The mesh with materials.
    pub solid: Solid,
    /// What contact rows see of its displacements.
    pub(crate) trace: Trace,
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
        let free = |node: u32| held.get(&node).map_or_else(|| AXES.to_vec(), Directions::free);
        let trace = Trace::new(&mesh, contact, |node| held.get(&node).map_or(&[], Directions::held), free);
        let mut body = Self {
            name: name.to_owned(),
            solid: Solid::new(name, scene, Arc::clone(&mesh))?,
            trace,
            held,
            loads,
            pieces: Vec::new(),
            mesh,
        };
        let piece_of = body.mesh.pieces().map_or_else(|| body.mesh.partitioned(piece_count), <[u32]>::to_vec);
        let mut known = Patterns::default();
        let cells = cells_by_piece(&piece_of);
        body.pieces = cells.into_iter().map(|cells| Piece::new(&body.mesh, cells, &mut known)).collect();
        Ok(body)
    }

    /// The whole body as one piece.
    pub fn whole(&self) -> Piece {
        Piece::new(&self.mesh, (0..self.mesh.cell_count() as u32).collect(), &mut Patterns::default())
    }

    /// The orthonormal directions in which supports hold a node.
    pub fn held(&self, node: u32) -> &[[f64; 3]] {
        self.held.get(&node).map_or(&[], Directions::held)
    }

    /// The held directions of a node, each with the first support of the scene that holds it.
    pub fn held_by(&self, node: u32) -> impl Iterator<Item = ([f64; 3], usize)> + '_ {
        let held = self.held.get(&node).into_iter();
        held.flat_map(|held| held.held().iter().copied().zip(held.supports().iter().copied()))
    }

    /// The displacement that supports prescribe to a node, along the axes, mm: a sum of its held directions.
    pub fn prescribed(&self, node: u32) -> [f64; 3] {
        self.held.get(&node).map_or([0.0; 3], Directions::displacement)
    }

    /// The largest component of a displacement that supports prescribe, mm; 0 where they hold nodes at rest.
    pub fn largest_prescribed(&self) -> f64 {
        let components = self.held.values().flat_map(Directions::displacement);
        components.fold(0.0, |largest: f64, component| largest.max(component.abs()))
    }

    /// Orthonormal directions in which a node is free.
    pub fn free(&self, node: u32) -> Vec<[f64; 3]> {
        self.held.get(&node).map_or_else(|| AXES.to_vec(), Directions::free)
    }

    /// Nodes that supports hold, ascending.
    pub fn held_nodes(&self) -> Vec<u32> {
        let mut nodes: Vec<u32> = self.held.keys().copied().collect();
        nodes.sort_unstable();
        nodes
    }
}

/// The cells of every piece.
fn cells_by_piece(piece_of: &[u32]) -> Vec<Vec<u32>> {
    let count = piece_of.iter().copied().max().map_or(0, |last| last as usize + 1);
    let mut cells = vec![Vec::new(); count];
    piece_of.iter().enumerate().for_each(|(cell, &piece)| cells[piece as usize].push(narrow(cell)));
    cells
}
