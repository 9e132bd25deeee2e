//! The meshes of a continuation: bricks of blocks, or files of the only body that is a mesh.

use contact::error::SceneError;
use contact::scene::Scene;
use schemars::{JsonSchema, Schema, SchemaGenerator};
use serde::{Deserialize, Serialize};
use std::borrow::Cow;

/// One of the growing meshes of an optimization.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum ContinuationMesh {
    /// Bricks of blocks along the axis that has most.
    Bricks(usize),
    /// A Gmsh file beside the scene file, in place of that of the only body that is a mesh.
    File(String),
}

impl ContinuationMesh {
    /// The bricks; none of a file.
    pub fn bricks(&self) -> Option<usize> {
        match self {
            Self::Bricks(count) => Some(*count),
            Self::File(_) => None,
        }
    }

    /// The file; none of bricks.
    pub(crate) fn file(&self) -> Option<&str> {
        match self {
            Self::Bricks(_) => None,
            Self::File(file) => Some(file),
        }
    }

    /// The file, for changes; none of bricks.
    pub(crate) fn file_mut(&mut self) -> Option<&mut String> {
        match self {
            Self::Bricks(_) => None,
            Self::File(file) => Some(file),
        }
    }
}

/// The range holds for numbers alone.
impl JsonSchema for ContinuationMesh {
    fn schema_name() -> Cow<'static, str> {
        "ContinuationMesh".into()
    }

    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        schemars::json_schema!({ "type": ["integer", "string"], "minimum": 1, "maximum": 400 })
    }
}

/// What a refusal calls the field.
pub(crate) const FIELD: &str = "optimizer.continuation";

/// Refuses meshes that the scene does not take.
///
/// # Errors
/// [`SceneError::OutOfRange`] for bricks that do not grow, bricks beside files, files where not exactly one body is a
/// mesh, bricks where not all bodies are blocks, and further starts beside meshes.
pub(crate) fn check(meshes: &[ContinuationMesh], starts: usize, scene: &Scene) -> Result<(), SceneError> {
    if starts > 1 && !meshes.is_empty() {
        return Err(SceneError::out_of_range("optimizer.starts", starts, "1 with optimizer.continuation"));
    }
    let bricks: Vec<usize> = meshes.iter().filter_map(ContinuationMesh::bricks).collect();
    let bodies = scene.bodies.iter().filter(|body| body.block().is_none()).count();
    let allowed = match (bricks.len(), meshes.len() - bricks.len(), bodies) {
        (_, 0, 0) => match bricks.windows(2).find(|pair| pair[1] <= pair[0]) {
            None => return Ok(()),
            Some(pair) => format!("growing meshes, here > {} in place of {}", pair[0], pair[1]),
        },
        (0, 0, _) | (0, _, 1) => return Ok(()),
        (_, 0, _) => "files of meshes, such as [\"coarse.msh\", \"fine.msh\"], for a body that is a mesh".to_owned(),
        (0, _, 0) => "an integer ≥ 1 and ≤ 400 for each mesh of blocks: no body of the scene is a mesh".to_owned(),
        (0, _, count) => format!("[] with {count} bodies that are meshes: a file takes the place of the only one"),
        _ => "bricks alone (each an integer ≥ 1 and ≤ 400), or files alone".to_owned(),
    };
    Err(SceneError::out_of_range(FIELD, serde_json::to_string(meshes).unwrap_or_default(), allowed))
}
