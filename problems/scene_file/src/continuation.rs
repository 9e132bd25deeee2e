//! The meshes of a continuation: bricks of blocks, or files of the only body that is a mesh.

use crate::{Case, OptimizerSection, SceneFile};
use contact::error::SceneError;
use contact::scene::Scene;
use contact::shape::ShapeScene;
use schemars::{JsonSchema, Schema, SchemaGenerator};
use serde::{Deserialize, Serialize};
use std::borrow::Cow;
use std::path::Path;

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
const FIELD: &str = "optimizer.continuation";

/// The cases of a continuation over files, in order; none of bricks. Their lattices have the extents of those of the
/// scene, so that a control means the same on all meshes.
///
/// # Errors
/// [`SceneError::OutOfRange`] for bricks that do not grow, bricks beside files, files where not exactly one body is a
/// mesh, and bricks where not all bodies are blocks; [`SceneError::InFile`] for a file on which the scene is none.
pub(crate) fn cases(file: &SceneFile, folder: &Path, scene: &Scene) -> Result<Vec<Case>, SceneError> {
    let OptimizerSection { continuation: meshes, starts, .. } = &file.optimizer;
    if *starts > 1 && !meshes.is_empty() {
        return Err(SceneError::out_of_range("optimizer.starts", starts, "1 with optimizer.continuation"));
    }
    let bricks: Vec<usize> = meshes.iter().filter_map(ContinuationMesh::bricks).collect();
    let bodies = scene.bodies.iter().filter(|body| body.block().is_none()).count();
    let allowed = match (bricks.len(), meshes.len() - bricks.len(), bodies) {
        (_, 0, 0) => match bricks.windows(2).find(|pair| pair[1] <= pair[0]) {
            None => return Ok(vec![]),
            Some(pair) => format!("growing meshes, here > {} in place of {}", pair[0], pair[1]),
        },
        (0, 0, _) => return Ok(vec![]),
        (0, _, 1) => return (0..meshes.len()).map(|index| case(file, index, folder, scene)).collect(),
        (_, 0, _) => "files of meshes, such as [\"coarse.msh\", \"fine.msh\"], for a body that is a mesh".to_owned(),
        (0, _, 0) => "an integer ≥ 1 and ≤ 400 for each mesh of blocks: no body of the scene is a mesh".to_owned(),
        (0, _, count) => format!("[] with {count} bodies that are meshes: a file takes the place of the only one"),
        _ => "bricks alone (each an integer ≥ 1 and ≤ 400), or files alone".to_owned(),
    };
    Err(SceneError::out_of_range(FIELD, serde_json::to_string(meshes).unwrap_or_default(), allowed))
}

/// The case on one of the meshes.
fn case(file: &SceneFile, index: usize, folder: &Path, scene: &Scene) -> Result<Case, SceneError> {
    let mut own = file.clone();
    let meshes = std::mem::take(&mut own.optimizer.continuation);
    let ContinuationMesh::File(name) = &meshes[index] else { return Case::new(&own, folder) };
    own.mesh_files_mut().for_each(|mesh| mesh.clone_from(name));
    let mut case = Case::new(&own, folder).map_err(|error| match error {
        error @ (SceneError::InFile { .. } | SceneError::File { .. }) => error,
        other => SceneError::InFile { file: format!("{FIELD}[{index}] = \"{name}\""), source: Box::new(other) },
    })?;
    for changed in std::iter::once(&mut case.scene).chain(case.cases.iter_mut().map(|case| &mut case.scene)) {
        for (body, model) in changed.bodies.iter_mut().zip(&scene.bodies) {
            if let (Some(ShapeScene::Lattice(own)), Some(ShapeScene::Lattice(model))) = (&mut body.shape, &model.shape)
            {
                own.coordinates = model.coordinates;
            }
        }
    }
    Ok(case)
}
