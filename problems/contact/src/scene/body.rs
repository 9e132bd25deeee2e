//! The bodies of a scene: geometry, materials, supports, loads, shape.

use crate::body::elasticity::Material;
use crate::body::mesh::Mesh;
use crate::error::SceneError;
use crate::scene::{Block, CounterSurface, Geometry, Load, Support};
use crate::shape::{LatticeShape, ShapedFace};
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
    pub shape: Option<LatticeShape>,
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

    /// Its block at the start, where it is one: heights that are controls begin at a plane.
    pub fn start_block(&self) -> Option<Block> {
        let mut block = self.block()?.clone();
        if let Some(heights) = self.heights() {
            let start = CounterSurface::Plane { height: heights.start };
            match heights.face() {
                Some(ShapedFace::Bottom) => block.bottom = start,
                Some(ShapedFace::Top) | None => block.top = start,
            }
        }
        Some(block)
    }

    /// Its shape where the controls are heights of a face of a block.
    pub fn heights(&self) -> Option<&LatticeShape> {
        self.shape.as_ref().filter(|shape| shape.face().is_some())
    }

    /// The mesh at the start, and the number of pieces that it is to be divided into where it does not say so itself.
    ///
    /// # Errors
    /// As [`Block::mesh`].
    pub fn mesh(&self) -> Result<(Arc<Mesh>, usize), SceneError> {
        match &self.geometry {
            Geometry::Mesh(geometry) => Ok((Arc::clone(&geometry.mesh), geometry.piece_count())),
            Geometry::Block(block) => Ok((Arc::new(self.start_block().as_ref().unwrap_or(block).mesh()?), 1)),
        }
    }

    /// The largest move of a node across x₃ by its controls, mm.
    pub(crate) fn reach(&self) -> f64 {
        match &self.shape {
            Some(shape) if shape.face().is_none() => {
                3.0_f64.sqrt() * shape.range.iter().fold(0.0, |largest: f64, value| largest.max(value.abs()))
            }
            _ => 0.0,
        }
    }

    /// The body moved by a vector, mm: its mesh, or its block.
    ///
    /// # Errors
    /// [`SceneError::OutOfRange`] for a body moved along x₃ whose heights are controls.
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
        self.shape.as_ref().map_or(0, LatticeShape::control_count)
    }
}
