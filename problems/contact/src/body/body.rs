//! A body of a scene: its mesh with materials, supports, loads and tied nodes. What does not depend on the shape.

use crate::body::elasticity::Material;
use crate::body::loads::Loaded;
use crate::body::mesh::{CellFace, Mesh};
use crate::body::support::{Directions, held_directions};
use crate::body::{Patterns, Piece, Place};
use crate::error::SceneError;
use crate::names::find;
use crate::scene::BodyScene;
use std::collections::HashMap;
use std::sync::Arc;

/// The two ends of an edge whose middle node is tied to them: u = û + (mean of the ends), with û held at zero.
pub type Ends = [u32; 2];

/// The axes.
const AXES: [[f64; 3]; 3] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

/// A body without a shape.
#[derive(Debug)]
pub struct Body {
    /// What messages call it.
    pub name: String,
    /// Its mesh; positions of a shape are given apart from it.
    pub mesh: Arc<Mesh>,
    materials: Vec<Material>,
    held: HashMap<u32, Directions>,
    pub(crate) loads: Vec<Loaded>,
    ends: HashMap<u32, Ends>,
    /// Its pieces for total FETI.
    pub pieces: Vec<Piece>,
}

impl Body {
    /// A body of a scene with some contact faces, divided into the pieces of its mesh, or into about `piece_count`.
    ///
    /// # Errors
    /// [`SceneError`] for names that the mesh does not have, and for loads and supports that mean nothing.
    pub fn new(
        name: &str,
        scene: &BodyScene,
        mesh: Arc<Mesh>,
        contact: &[CellFace],
        piece_count: usize,
    ) -> Result<Self, SceneError> {
        let mut materials = vec![scene.material; mesh.volumes().len()];
        for (volume, material) in &scene.materials {
            let allowed = || mesh.volumes().iter().map(String::as_str);
            materials[find(&format!("{name}.materials: volume"), volume, allowed())?] = *material;
        }
        let held = held_directions(name, &mesh, &scene.supports)?;
        let loads = scene.loads.iter().enumerate();
        let loads = loads.map(|(index, load)| Loaded::new(&format!("{name}.loads[{index}]"), load, &mesh));
        let loads = loads.collect::<Result<_, _>>()?;
        let mut body = Self {
            name: name.to_owned(),
            ends: tied_nodes(&mesh, contact),
            materials,
            held,
            loads,
            pieces: Vec::new(),
            mesh,
        };
        let piece_of = body.mesh.pieces().map_or_else(|| body.mesh.partitioned(piece_count), <[u32]>::to_vec);
        let mut known = Patterns::default();
        let cells = body.mesh.cells_by_piece(&piece_of);
        body.pieces = cells.into_iter().map(|cells| Piece::new(&body, cells, &mut known)).collect();
        Ok(body)
    }

    /// The whole body as one piece.
    pub fn whole(&self) -> Piece {
        Piece::new(self, (0..self.mesh.cell_count() as u32).collect(), &mut Patterns::default())
    }

    /// The material of a cell.
    pub fn material(&self, cell: usize) -> &Material {
        &self.materials[self.mesh.volume_of(cell)]
    }

    /// The materials by volume of the mesh.
    pub fn materials(&self) -> &[Material] {
        &self.materials
    }

    /// The orthonormal directions in which supports hold a node; all for a tied node, which has displacements against its
    /// ends alone.
    pub fn held(&self, node: u32) -> &[[f64; 3]] {
        if self.ends_of(node).is_some() {
            return &AXES;
        }
        self.held.get(&node).map_or(&[], Directions::held)
    }

    /// Orthonormal directions in which a node is free.
    pub fn free(&self, node: u32) -> Vec<[f64; 3]> {
        match self.held.get(&node) {
            _ if self.ends_of(node).is_some() => Vec::new(),
            Some(held) => held.free(),
            None => AXES.to_vec(),
        }
    }

    /// From the middle between their ends to the tied nodes, mm: zero on straight edges.
    pub(crate) fn arms<'a>(&'a self, positions: &'a [[f64; 3]]) -> impl Iterator<Item = [f64; 3]> + 'a {
        let mut tied: Vec<u32> = self.ends.keys().copied().collect();
        tied.sort_unstable();
        tied.into_iter().filter_map(|node| match self.place(node, positions) {
            Place::Arm(arm) => Some(arm),
            Place::Point(_) => None,
        })
    }

    /// What of a node moves in rigid motions: the node, or the arm of a tied one.
    pub(crate) fn place(&self, node: u32, positions: &[[f64; 3]]) -> Place {
        let x = positions[node as usize];
        match self.ends_of(node).map(|ends| ends.map(|end| positions[end as usize])) {
            None => Place::Point(x),
            Some([a, b]) => Place::Arm(std::array::from_fn(|axis| x[axis] - 0.5 * (a[axis] + b[axis]))),
        }
    }

    /// Nodes that supports hold, ascending; tied ones move with their ends and are left out.
    pub fn held_nodes(&self) -> Vec<u32> {
        let mut nodes: Vec<u32> = self.held.keys().copied().filter(|node| self.ends_of(*node).is_none()).collect();
        nodes.sort_unstable();
        nodes
    }

    /// The ends of the edge in whose middle a node is tied: on contact faces of cells of second order, displacements
    /// are linear.
    pub fn ends_of(&self, node: u32) -> Option<Ends> {
        self.ends.get(&node).copied()
    }

    /// Displacements of all nodes, from those of the nodes of a piece that is the whole body.
    pub fn extended(&self, whole: &Piece, values: &[f64]) -> Vec<[f64; 3]> {
        (0..self.mesh.node_count() as u32).map(|node| whole.value_at(self, node, values)).collect()
    }
}

/// Middle nodes of contact faces with the ends of their edges.
fn tied_nodes(mesh: &Mesh, contact: &[CellFace]) -> HashMap<u32, Ends> {
    let mut ends = HashMap::new();
    for &face in contact {
        let (nodes, corners) = mesh.face_with_corners(face);
        for (edge, &middle) in nodes[corners..].iter().enumerate() {
            ends.insert(middle, [nodes[edge], nodes[(edge + 1) % corners]]);
        }
    }
    ends
}
