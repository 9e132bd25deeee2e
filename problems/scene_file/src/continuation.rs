//! The meshes of a continuation: bricks of blocks, or files of the only body that is a mesh.

use crate::{Case, OptimizerSection, SceneFile};
use contact::error::SceneError;
use contact::scene::{BodyScene, Geometry, Scene};
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
/// [`SceneError::OutOfRange`] for meshes that do not grow, bricks beside files, files where not exactly one body is a
/// mesh, and bricks where not all bodies are blocks; [`SceneError::InFile`] for a file on which the scene is none.
pub(crate) fn cases(file: &SceneFile, folder: &Path, scene: &Scene) -> Result<Vec<Case>, SceneError> {
    let OptimizerSection { continuation: meshes, starts, .. } = &file.optimizer;
    let shown = || meshes.iter().map(shown).collect::<Vec<_>>().join(", ");
    let refused = |allowed: &str| Err(SceneError::out_of_range(FIELD, format!("[{}]", shown()), allowed));
    if *starts > 1 && !meshes.is_empty() {
        return Err(SceneError::out_of_range("optimizer.starts", starts, "1 with optimizer.continuation"));
    }
    let bricks: Vec<usize> = meshes.iter().filter_map(ContinuationMesh::bricks).collect();
    if bricks.len() == meshes.len() {
        if !bricks.is_empty() && !scene.is_of_blocks() {
            return refused("files of meshes, such as [\"coarse.msh\", \"fine.msh\"], for a body that is a mesh");
        }
        grow(&bricks, "bricks", |index| bricks[index].to_string())?;
        return Ok(vec![]);
    }
    if !bricks.is_empty() {
        return refused("bricks alone (each an integer ≥ 1 and ≤ 400), or files alone");
    }
    let count = scene.bodies.iter().filter(|body| body.block().is_none()).count();
    if count != 1 {
        let allowed = match count {
            0 => "an integer ≥ 1 and ≤ 400 for each mesh of blocks: no body of the scene is a mesh".to_owned(),
            _ => format!("[] with {count} bodies that are meshes: a file takes the place of the only one"),
        };
        return refused(&allowed);
    }
    let cases = (0..meshes.len()).map(|index| case(file, index, folder, scene)).collect::<Result<Vec<Case>, _>>()?;
    let nodes: Vec<usize> = cases.iter().map(|case| node_count(&case.scene)).collect();
    grow(&nodes, "nodes", |index| format!("{} of {} nodes", self::shown(&meshes[index]), nodes[index]))?;
    Ok(cases)
}

/// Refuses counts that do not grow.
fn grow(counts: &[usize], what: &str, shown: impl Fn(usize) -> String) -> Result<(), SceneError> {
    let Some(place) = counts.windows(2).position(|pair| pair[1] <= pair[0]) else { return Ok(()) };
    let allowed = format!("growing meshes, here > {} {what}", counts[place]);
    Err(SceneError::out_of_range(FIELD, shown(place + 1), allowed))
}

fn shown(mesh: &ContinuationMesh) -> String {
    match mesh {
        ContinuationMesh::Bricks(count) => count.to_string(),
        ContinuationMesh::File(name) => format!("\"{name}\""),
    }
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
                own.coordinates = model.coordinates.clone();
            }
        }
    }
    Ok(case)
}

/// Nodes of all bodies that are meshes.
fn node_count(scene: &Scene) -> usize {
    let nodes = |body: &BodyScene| match &body.geometry {
        Geometry::Mesh(own) => own.mesh.node_count(),
        _ => 0,
    };
    scene.bodies.iter().map(nodes).sum()
}
