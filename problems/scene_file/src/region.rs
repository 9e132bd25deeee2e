//! A part of the bodies in a scene file.

use contact::cost::Region;
use contact::error::SceneError;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A box in one body or in all, a volume of a mesh, or a face.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct RegionSection {
    /// The body. Default all bodies.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub body: Option<BodyName>,
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
    /// A face, whose nodes alone belong to the region; for `displacement`. Default none: the nodes of all its cells.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub face: Option<String>,
}

/// One of the bodies.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
#[allow(missing_docs, reason = "the names are the meaning")]
pub enum BodyName {
    Lower,
    Upper,
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
    let body = section.body.map(|body| match body {
        BodyName::Lower => 0,
        BodyName::Upper => 1,
    });
    Ok(Region { lower, upper, body, volume: section.volume, face: section.face })
}
