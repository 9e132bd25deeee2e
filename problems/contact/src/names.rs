//! Names that users give, looked up among those that there are.

use crate::body::mesh::{CellFace, Mesh};
use crate::error::SceneError;

/// Names at least this similar to a misspelt one are suggested (Jaro–Winkler, 1 for equal names).
const SIMILAR: f64 = 0.75;

/// The place of a name among others.
///
/// # Errors
/// [`SceneError::OutOfRange`] with all names, the most similar one first.
pub fn find<'n>(field: &str, name: &str, names: impl Iterator<Item = &'n str>) -> Result<usize, SceneError> {
    let names: Vec<&str> = names.collect();
    names.iter().position(|other| *other == name).ok_or_else(|| unknown(field, &format!("\"{name}\""), name, &names))
}

/// The faces of a mesh with a name.
///
/// # Errors
/// As [`find`], with the file of the mesh; for a name without elements as well.
pub fn find_face<'m>(field: &str, name: &str, mesh: &'m Mesh) -> Result<&'m [CellFace], SceneError> {
    check_among(field, name, &[mesh], &[Kind::Faces])?;
    Ok(mesh.faces().get(name).map_or(&[], Vec::as_slice))
}

/// The place of a volume of a mesh.
///
/// # Errors
/// As [`find_face`].
pub fn find_volume(field: &str, name: &str, mesh: &Mesh) -> Result<usize, SceneError> {
    check_among(field, name, &[mesh], &[Kind::Volumes])?;
    Ok(mesh.volumes().iter().position(|volume| volume == name).unwrap_or(0))
}

/// The nodes of a face, node set or volume of a mesh.
///
/// # Errors
/// As [`find_face`].
pub fn nodes_of(field: &str, name: &str, mesh: &Mesh) -> Result<Vec<u32>, SceneError> {
    check_among(field, name, &[mesh], &[Kind::Faces, Kind::Nodes, Kind::Volumes])?;
    if let Some(faces) = mesh.faces().get(name) {
        return Ok(faces.iter().flat_map(|face| mesh.face_nodes(*face)).collect());
    }
    if let Some(nodes) = mesh.node_sets().get(name) {
        return Ok(nodes.clone());
    }
    let inside = |cell: &usize| mesh.volumes()[mesh.volume_of(*cell)] == name;
    let cells = (0..mesh.cell_count()).filter(inside);
    Ok(cells.flat_map(|cell| mesh.cell(cell).nodes).copied().collect())
}

/// What a name of a mesh stands for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Kind {
    Faces,
    Nodes,
    Volumes,
}

impl Kind {
    fn names(self, mesh: &Mesh) -> Vec<&str> {
        match self {
            Self::Faces => mesh.faces().keys().map(String::as_str).collect(),
            Self::Nodes => mesh.node_sets().keys().map(String::as_str).collect(),
            Self::Volumes => mesh.volumes().iter().map(String::as_str).collect(),
        }
    }

    fn words(self) -> &'static str {
        match self {
            Self::Faces => "faces",
            Self::Nodes => "nodes",
            Self::Volumes => "cells",
        }
    }
}

/// Checks that one of some meshes has a name of one of some kinds, with elements.
///
/// # Errors
/// As [`find_face`].
pub(crate) fn check_among(field: &str, name: &str, meshes: &[&Mesh], kinds: &[Kind]) -> Result<(), SceneError> {
    let names: Vec<&str> = meshes.iter().flat_map(|mesh| kinds.iter().flat_map(|kind| kind.names(mesh))).collect();
    if names.contains(&name) {
        return Ok(());
    }
    let mut value = format!("\"{name}\"");
    let others = [Kind::Faces, Kind::Nodes, Kind::Volumes].into_iter().filter(|kind| !kinds.contains(kind));
    let other = others.into_iter().find(|kind| meshes.iter().any(|mesh| kind.names(mesh).contains(&name)));
    if let Some(other) = other {
        value.push_str(&format!(", a group of {}", other.words()));
    } else if meshes.iter().any(|mesh| mesh.empty_names().contains(name)) {
        value.push_str(", a group without elements");
    }
    let files: Vec<&str> = meshes.iter().filter_map(|mesh| mesh.file()).collect();
    if !files.is_empty() {
        value.push_str(&format!(" in {}", files.join(", ")));
    }
    Err(unknown(field, &value, name, &names))
}

fn unknown(field: &str, value: &str, name: &str, names: &[&str]) -> SceneError {
    let quoted: Vec<String> = names.iter().map(|name| format!("\"{name}\"")).collect();
    let list = if quoted.is_empty() { "none: the mesh has no names here".to_owned() } else { quoted.join(", ") };
    let similarity = |other: &str| strsim::jaro_winkler(&name.to_lowercase(), &other.to_lowercase());
    let nearest = names.iter().max_by(|a, b| similarity(a).total_cmp(&similarity(b)));
    let nearest = nearest.filter(|other| similarity(other) >= SIMILAR);
    let allowed = nearest.map_or_else(|| list.clone(), |nearest| format!("{list} (did you mean \"{nearest}\"?)"));
    SceneError::out_of_range(field, value, allowed)
}
