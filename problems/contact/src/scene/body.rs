//! The bodies of a scene: geometry, materials, supports, loads, shape.

use crate::body::elasticity::Material;
use crate::body::mesh::Mesh;
use crate::error::SceneError;
use crate::scene::{Block, CounterSurface, Geometry, Load, Support};
use crate::shape::{HeightShape, ShapeScene, ShapedFace};
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// One elastic body.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct BodyScene {
    /// What messages and results call it.
    pub name: String,
    /// Where its mesh comes from.
    pub geometry: Geometry,
    /// The elastic constants of the body.
    pub material: Material,
    /// Other elastic constants by the names of volumes.
    pub materials: Vec<(String, Material)>,
    /// The faces that are held.
    pub supports: Vec<Support>,
    /// The loads.
    pub loads: Vec<Load>,
    /// What its controls move; none for a body of fixed shape.
    pub shape: Option<ShapeScene>,
}

impl BodyScene {
    /// A body of one material without supports, loads and controls.
    pub fn new(name: impl Into<String>, geometry: Geometry, material: Material) -> Self {
        let (materials, supports, loads) = (Vec::new(), Vec::new(), Vec::new());
        Self { name: name.into(), geometry, material, materials, supports, loads, shape: None }
    }

    /// The block that the body is, where it is one.
    pub fn block(&self) -> Option<&Block> {
        match &self.geometry {
            Geometry::Block(block) => Some(block),
            Geometry::Mesh(_) => None,
        }
    }

    /// The height surface that shapes the body, where one does.
    pub fn heights(&self) -> Option<&HeightShape> {
        match &self.shape {
            Some(ShapeScene::Heights(heights)) => Some(heights),
            _ => None,
        }
    }

    /// The mesh at the start, and the number of pieces that it is to be divided into where it does not say so itself.
    ///
    /// # Errors
    /// As [`Block::mesh`].
    pub fn mesh(&self) -> Result<(Arc<Mesh>, usize), SceneError> {
        match &self.geometry {
            Geometry::Mesh(geometry) => Ok((Arc::clone(&geometry.mesh), geometry.piece_count())),
            Geometry::Block(block) => {
                let mut block = block.clone();
                if let Some(heights) = self.heights() {
                    let start = CounterSurface::Plane { height: heights.start_height };
                    match heights.face {
                        ShapedFace::Top => block.top = start,
                        ShapedFace::Bottom => block.bottom = start,
                    }
                }
                Ok((Arc::new(block.mesh()?), 1))
            }
        }
    }

    /// The largest move of a node across x₃ by its controls, mm.
    pub(crate) fn reach(&self) -> f64 {
        match &self.shape {
            Some(ShapeScene::Lattice(lattice)) => {
                3.0_f64.sqrt() * lattice.displacement.iter().fold(0.0, |largest: f64, value| largest.max(value.abs()))
            }
            Some(ShapeScene::Heights(_)) | None => 0.0,
        }
    }

    /// The body moved by a vector, mm: its mesh, or its block.
    ///
    /// # Errors
    /// [`SceneError::OutOfRange`] for a height surface moved along
    /// x₃, whose heights are controls.
    pub fn moved(mut self, by: [f64; 3]) -> Result<Self, SceneError> {
        if self.heights().is_some() && by[2] != 0.0 {
            let allowed = "0 along x3 for a body whose heights are controls";
            return Err(SceneError::out_of_range(format!("{}.offset", self.name), by[2], allowed));
        }
        match &mut self.geometry {
            Geometry::Mesh(geometry) => {
                let moved = |x: [f64; 3]| std::array::from_fn(|axis| x[axis] + by[axis]);
                geometry.mesh = Arc::new(Mesh::clone(&geometry.mesh).moved(moved));
            }
            Geometry::Block(block) => {
                (0..2).for_each(|axis| block.corner[axis] += by[axis]);
                (block.bottom, block.top) = (block.bottom.moved(by), block.top.moved(by));
            }
        }
        Ok(self)
    }

    /// Number of controls.
    pub fn control_count(&self) -> usize {
        self.shape.as_ref().map_or(0, ShapeScene::control_count)
    }
}
