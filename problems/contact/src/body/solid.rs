//! The mesh of a body with materials: what its stiffness needs.

use crate::body::elasticity::Material;
use crate::body::mesh::Mesh;
use crate::error::SceneError;
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

    /// The materials by volume of the mesh.
    pub fn materials(&self) -> &[Material] {
        &self.materials
    }
}
