//! The contact of a scene: what touches what, along which normals, over which areas, with which friction.

pub use crate::body::elasticity::facet::AreaKind;
use serde::{Deserialize, Serialize};

/// Along which normals contact acts.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema), schemars(rename = "NormalName", transform = crate::schema::names_only))]
pub enum NormalKind {
    /// The normal of the counter surface at the point nearest to the contact node.
    #[default]
    Surface,
    /// The axis x₃, as in the paper; gaps are measured along it.
    X3,
}

/// The contact face of the lower body, and how contact is measured there.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ContactScene {
    /// Name of the contact face of the lower body.
    pub face: String,
    /// Along which normals contact acts.
    pub normal: NormalKind,
    /// How tributary areas are measured.
    pub area: AreaKind,
    /// Coulomb friction coefficient 𝓕.
    pub friction: f64,
    /// Other friction coefficients by the names of faces or node sets.
    pub friction_by_region: Vec<(String, f64)>,
    /// How far the bodies are pressed into each other before loading, along the normals of the contact nodes, mm: every
    /// gap is smaller by it. Negative: a clearance.
    pub interference: f64,
}

impl ContactScene {
    /// Whether any node has friction.
    pub fn has_friction(&self) -> bool {
        self.friction > 0.0 || self.friction_by_region.iter().any(|(_, friction)| *friction > 0.0)
    }

    /// The contact of the paper's scenes: normal along x₃, areas of the projected grid.
    pub fn along_x3(face: impl Into<String>, friction: f64) -> Self {
        Self {
            face: face.into(),
            normal: NormalKind::X3,
            area: AreaKind::Projected,
            friction,
            friction_by_region: Vec::new(),
            interference: 0.0,
        }
    }
}
