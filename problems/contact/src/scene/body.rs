//! The bodies of a scene: geometry, materials, supports, loads, shape.

use crate::body::elasticity::Material;
use crate::body::mesh::Mesh;
use crate::error::SceneError;
use crate::scene::{Block, CounterSurface, Geometry};
use crate::shape::{HeightShape, ShapeScene, ShapedFace};
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// What a support prescribes at the nodes of its face.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub enum Held {
    /// The values of u₁, u₂, u₃, mm; none where a component is free.
    Components([Option<f64>; 3]),
    /// The displacement along the outward normal of the face at the reference shape, mm.
    Normal(f64),
}

/// Displacements prescribed on a face of a body.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Support {
    /// Name of the face.
    pub face: String,
    /// What is held there.
    pub held: Held,
}

impl Support {
    /// Some components held at zero on a face.
    pub fn new(face: impl Into<String>, components: [bool; 3]) -> Self {
        Self { face: face.into(), held: Held::Components(components.map(|held| held.then_some(0.0))) }
    }

    /// The displacement along the normals of a face held at zero.
    pub fn along_normal(face: impl Into<String>) -> Self {
        Self { face: face.into(), held: Held::Normal(0.0) }
    }
}

/// A load on a body.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Load {
    /// Name of the face, or of the volume of a body force; none for all volumes.
    pub place: Option<String>,
    /// What acts there.
    pub kind: LoadKind,
}

/// What acts on a face or in a volume.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub enum LoadKind {
    /// A constant force per area along the axes, MPa.
    Traction([f64; 3]),
    /// A pressure on the face, MPa; against its outward normal.
    Pressure(f64),
    /// A force (N) at a point, and a moment (N·mm) besides, as a traction over the face that is linear in the position:
    /// t = F/A + ω × (x − c), c the centroid. The point is the centroid if none is given.
    Resultant {
        /// Total force along the axes, N.
        force: [f64; 3],
        /// Moment about the point, N·mm.
        moment: [f64; 3],
        /// Point of attack, mm.
        point: Option<[f64; 3]>,
    },
    /// A force per area along the axes as formulas in x1, x2, x3 (mm), MPa.
    Formula([String; 3]),
    /// A force per volume along the axes, N/mm³.
    BodyForce([f64; 3]),
}

impl Load {
    /// A constant traction on a face, MPa.
    pub fn traction(face: impl Into<String>, traction: [f64; 3]) -> Self {
        Self { place: Some(face.into()), kind: LoadKind::Traction(traction) }
    }

    /// The load times a factor.
    #[must_use]
    pub fn scaled(&self, factor: f64) -> Self {
        let vector = |vector: [f64; 3]| vector.map(|x| factor * x);
        let kind = match &self.kind {
            LoadKind::Traction(traction) => LoadKind::Traction(vector(*traction)),
            LoadKind::Pressure(pressure) => LoadKind::Pressure(factor * pressure),
            LoadKind::Resultant { force, moment, point } => {
                LoadKind::Resultant { force: vector(*force), moment: vector(*moment), point: *point }
            }
            LoadKind::Formula(texts) => LoadKind::Formula(texts.clone().map(|text| format!("{factor:?}*({text})"))),
            LoadKind::BodyForce(force) => LoadKind::BodyForce(vector(*force)),
        };
        Self { place: self.place.clone(), kind }
    }
}

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
