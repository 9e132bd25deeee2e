//! Contact of a scene file: what touches, along which normals, over which areas, with which friction.

use contact::scene::{AreaKind, BodyFace, ContactScene, Master, NormalKind};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// The contact of the lower body, or of the body of a mesh.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct ContactSection {
    /// The face that may touch what is above it. Default "top" for blocks; required for a mesh.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub face: Option<String>,
    /// Along which normals contact acts: those of the counter surface at the points nearest to the contact nodes
    /// (between two blocks the averaged ones of the lower block), or x3 as in the paper. Default "surface" with a rigid
    /// obstacle, "x3" between two blocks.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub normal: Option<NormalKind>,
    /// How the areas of contact nodes are measured: on the surface itself, or projected along x3 as in the paper.
    /// Default "projected" with contact.normal = "x3", else "surface".
    #[serde(skip_serializing_if = "Option::is_none")]
    pub area: Option<AreaKind>,
    /// How far the bodies are pressed into each other before loading: every gap is smaller by it. Negative: a
    /// clearance. Default 0.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = -1e9, max = 1e9), extend("x-unit" = "mm"))]
    pub interference: Option<f64>,
    /// Other friction coefficients on parts of the face.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub regions: Vec<FrictionSection>,
}

/// The friction coefficient of a part of the contact face.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct FrictionSection {
    /// The face, set of nodes or volume whose nodes have this coefficient; of several, the last one counts.
    pub region: String,
    /// Coulomb friction coefficient.
    #[schemars(range(min = 0.0, max = 1e6), extend("x-unit" = "1"))]
    pub friction: f64,
}

impl ContactSection {
    /// The contact of the first body of a scene, whose contact face has this name by default.
    pub(crate) fn scene(&self, face: &str, friction: f64, master: Master) -> ContactScene {
        let usual = if let Master::Body(_) = master { NormalKind::X3 } else { NormalKind::Surface };
        let normal = self.normal.unwrap_or(usual);
        let area = if normal == NormalKind::X3 { AreaKind::Projected } else { AreaKind::Surface };
        ContactScene {
            normal,
            area: self.area.unwrap_or(area),
            interference: self.interference.unwrap_or_default(),
            friction_by_region: self.regions.iter().map(|part| (part.region.clone(), part.friction)).collect(),
            ..ContactScene::new(BodyFace::new(0, self.face.as_deref().unwrap_or(face)), master, friction)
        }
    }
}
