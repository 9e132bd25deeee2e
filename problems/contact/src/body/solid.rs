//! The mesh of a body with materials and tied nodes: what its stiffness needs.

use crate::body::Place;
use crate::body::elasticity::Material;
use crate::body::mesh::{CellFace, Mesh};
use crate::error::SceneError;
use crate::names::find_volume;
use crate::scene::BodyScene;
use std::collections::HashMap;
use std::sync::Arc;

/// The two ends of an edge whose middle node is tied to them: u = û + (mean of the ends), with û held at zero.
pub type Ends = [u32; 2];

/// A mesh with materials and tied nodes.
#[derive(Debug, PartialEq)]
pub struct Solid {
    /// The mesh; positions of a shape are given apart from it.
    pub mesh: Arc<Mesh>,
    materials: Vec<Material>,
    ends: HashMap<u32, Ends>,
}

impl Solid {
    /// The solid of a body of a scene with some contact faces; `name` stands in messages.
    ///
    /// # Errors
    /// [`SceneError`] for volumes that the mesh does not have.
    pub fn new(name: &str, scene: &BodyScene, mesh: Arc<Mesh>, contact: &[CellFace]) -> Result<Self, SceneError> {
        let mut materials = vec![scene.material; mesh.volumes().len()];
        for (volume, material) in &scene.materials {
            materials[find_volume(&format!("{name}.materials: volume"), volume, &mesh)?] = *material;
        }
        Ok(Self { ends: tied_nodes(&mesh, contact), materials, mesh })
    }

    /// The material of a cell.
    pub fn material(&self, cell: usize) -> &Material {
        &self.materials[self.mesh.volume_of(cell)]
    }

    /// The materials by volume of the mesh.
    pub fn materials(&self) -> &[Material] {
        &self.materials
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

    /// The ends of the edge in whose middle a node is tied: on contact faces of cells of second order, displacements
    /// are linear.
    pub fn ends_of(&self, node: u32) -> Option<Ends> {
        self.ends.get(&node).copied()
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
