//! A part of the bodies in a scene file.

use contact::cost::Region;
use contact::error::SceneError;
use contact::names::find;
use contact::scene::Scene;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A box in one body or in all, a volume of a mesh, or a face.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct RegionSection {
    /// Name of the body. Default all bodies.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub body: Option<String>,
    /// Smallest and largest x1. Default no bound.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(inner(range(min = -1e9, max = 1e9)), extend("x-unit" = "mm"))]
    pub x1: Option<[f64; 2]>,
    /// Smallest and largest x2. Default no bound.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(inner(range(min = -1e9, max = 1e9)), extend("x-unit" = "mm"))]
    pub x2: Option<[f64; 2]>,
    /// Smallest and largest x3. Default no bound.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(inner(range(min = -1e9, max = 1e9)), extend("x-unit" = "mm"))]
    pub x3: Option<[f64; 2]>,
    /// A physical volume of the mesh. Default all volumes.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub volume: Option<String>,
    /// A face, whose nodes alone belong to the region; for `displacement` and `reaction`.
    /// Default none: the nodes of all its cells.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub face: Option<String>,
}

/// Checks the body that a table names which messages call `field`.
pub(crate) fn check_body(field: &str, name: Option<&String>, scene: &Scene) -> Result<(), SceneError> {
    let Some(name) = name else { return Ok(()) };
    let names = scene.bodies.iter().map(|body| body.name.as_str());
    find(&format!("{field}.body"), name, names).map(|_| ())
}

/// The region of a section that messages call `field`; the whole bodies without one.
pub(crate) fn region(field: &str, section: Option<&RegionSection>) -> Result<Region, SceneError> {
    let section = section.cloned().unwrap_or_default();
    let (mut lower, mut upper) = ([f64::NEG_INFINITY; 3], [f64::INFINITY; 3]);
    for (axis, bounds) in [section.x1, section.x2, section.x3].into_iter().enumerate() {
        let Some([low, high]) = bounds else { continue };
        if low > high {
            let field = format!("{field}.x{}", axis + 1);
            return Err(SceneError::out_of_range(field, format!("[{low}, {high}]"), "the smaller number first"));
        }
        (lower[axis], upper[axis]) = (low, high);
    }
    Ok(Region { lower, upper, body: section.body, volume: section.volume, face: section.face })
}
