//! The mesh of a body with materials: what its stiffness needs.

use crate::body::elasticity::Material;
use crate::body::mesh::Mesh;
use crate::error::SceneError;
use crate::linear::parallel;
use crate::mortar::vector::plus;
use crate::names::find_volume;
use crate::scene::BodyScene;
use std::sync::Arc;

/// A mesh with materials.
#[derive(Debug, PartialEq)]
pub struct Solid {
    /// The mesh; positions of a shape are given apart from it.
    pub mesh: Arc<Mesh>,
    materials: Vec<Material>,
}

impl Solid {
    /// The solid of a body of a scene; `name` stands in messages.
    ///
    /// # Errors
    /// [`SceneError`] for volumes that the mesh does not have.
    pub fn new(name: &str, scene: &BodyScene, mesh: Arc<Mesh>) -> Result<Self, SceneError> {
        let mut materials = vec![scene.material; mesh.volumes().len()];
        for (volume, material) in &scene.materials {
            materials[find_volume(&format!("{name}.materials: volume"), volume, &mesh)?] = *material;
        }
        Ok(Self { materials, mesh })
    }

    /// The material of a cell.
    pub fn material(&self, cell: usize) -> &Material {
        &self.materials[self.mesh.volume_of(cell)]
    }

    /// K u per node for displacements u of the nodes at a shape, N.
    pub(crate) fn internal_forces(&self, positions: &[[f64; 3]], u: &[[f64; 3]]) -> Vec<[f64; 3]> {
        let of_cell = |cell: usize| {
            let own = self.mesh.cell_values(cell, u);
            // Fields of supports are zero in most cells.
            match own.iter().all(|entry| *entry == 0.0) {
                true => Vec::new(),
                false => self.mesh.cell_nodes(cell, positions).forces(self.material(cell), &own),
            }
        };
        let cells: Vec<Vec<f64>> = parallel::map(self.mesh.cell_count(), &of_cell);
        let mut sums = vec![[0.0; 3]; self.mesh.node_count()];
        for (cell, forces) in self.mesh.cells().zip(&cells) {
            for (&node, force) in cell.nodes.iter().zip(forces.as_chunks::<3>().0) {
                sums[node as usize] = plus(sums[node as usize], 1.0, *force);
            }
        }
        sums
    }

    /// The materials by volume of the mesh.
    pub fn materials(&self) -> &[Material] {
        &self.materials
    }
}
