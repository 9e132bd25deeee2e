//! Contacts of a scene file: what touches, along which normals, over which areas, with which friction.

use crate::ObstacleSection;
use contact::scene::{AreaKind, FaceGeometry, NormalKind};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A face of a body.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct FaceSection {
    /// Name of the body. Default the only one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub body: Option<String>,
    /// Name of its face.
    pub face: String,
}

/// Two faces that may touch or are glued, or a face and a rigid obstacle: slave and master, faces, or slave and
/// obstacle. Contact nodes, pressures and gaps belong to the slave.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct ContactSection {
    /// The slave face. Default chosen among faces.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub slave: Option<FaceSection>,
    /// The master face, on another body.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub master: Option<FaceSection>,
    /// Two faces in place of slave and master: the softer and finer one, with the smaller product of Young's modulus
    /// and mean width of facets, becomes the slave.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub faces: Option<[FaceSection; 2]>,
    /// A rigid obstacle in place of a master face.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub obstacle: Option<ObstacleSection>,
    /// Whether the faces are glued as they lie.
    pub tied: bool,
    /// Coulomb friction coefficient. Default that of the scene; none between glued faces.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0.0, max = 1e6), extend("x-unit" = "1"))]
    pub friction: Option<f64>,
    /// Along which normals contact acts: those of the obstacle, between two bodies the averaged ones of the slave face;
    /// or x3 as in the paper.
    pub normal: NormalKind,
    /// How areas on an obstacle are measured: on the surface itself, or projected along x3 as in the paper. Default
    /// "projected" with normal = "x3", else "surface".
    #[serde(skip_serializing_if = "Option::is_none")]
    pub area: Option<AreaKind>,
    /// By how much every gap is smaller before loading; negative: a clearance. Default 0.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = -1e9, max = 1e9), extend("x-unit" = "mm"))]
    pub interference: Option<f64>,
    /// The gap at the start between two bodies, whatever their meshes say. Negative: an interference. Default: the gaps
    /// of the faces. Not with interference.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = -1e9, max = 1e9), extend("x-unit" = "mm"))]
    pub clearance: Option<f64>,
    /// Whether gaps between two bodies are those of curved surfaces, or of flat facets for comparison.
    pub geometry: FaceGeometry,
    /// Other friction coefficients on parts of the slave face.
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
