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
    names.iter().position(|other| *other == name).ok_or_else(|| unknown(field, name, &names))
}

/// The faces of a mesh with a name.
///
/// # Errors
/// As [`find`].
pub fn find_face<'m>(field: &str, name: &str, mesh: &'m Mesh) -> Result<&'m [CellFace], SceneError> {
    let names: Vec<&str> = mesh.faces().keys().map(String::as_str).collect();
    mesh.faces().get(name).map(Vec::as_slice).ok_or_else(|| unknown(field, name, &names))
}

/// The nodes of a face, node set or volume of a mesh.
///
/// # Errors
/// As [`find`].
pub fn nodes_of(field: &str, name: &str, mesh: &Mesh) -> Result<Vec<u32>, SceneError> {
    if let Some(faces) = mesh.faces().get(name) {
        return Ok(faces.iter().flat_map(|face| mesh.face_nodes(*face)).collect());
    }
    if let Some(nodes) = mesh.node_sets().get(name) {
        return Ok(nodes.clone());
    }
    let names = mesh.faces().keys().chain(mesh.node_sets().keys()).chain(mesh.volumes()).map(String::as_str);
    let names: Vec<&str> = names.collect();
    match mesh.volumes().iter().position(|volume| volume == name) {
        Some(volume) => {
            let cells = (0..mesh.cell_count()).filter(|cell| mesh.volume_of(*cell) == volume);
            Ok(cells.flat_map(|cell| mesh.cell(cell).nodes).copied().collect())
        }
        None => Err(unknown(field, name, &names)),
    }
}

fn unknown(field: &str, name: &str, names: &[&str]) -> SceneError {
    let quoted: Vec<String> = names.iter().map(|name| format!("\"{name}\"")).collect();
    let list = if quoted.is_empty() { "none: the mesh has no names here".to_owned() } else { quoted.join(", ") };
    let similarity = |other: &str| strsim::jaro_winkler(&name.to_lowercase(), &other.to_lowercase());
    let nearest = names.iter().max_by(|a, b| similarity(a).total_cmp(&similarity(b)));
    let nearest = nearest.filter(|other| similarity(other) >= SIMILAR);
    let allowed = nearest.map_or_else(|| list.clone(), |nearest| format!("{list} (did you mean \"{nearest}\"?)"));
    SceneError::out_of_range(field, format!("\"{name}\""), allowed)
}
