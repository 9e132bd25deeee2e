//! Faces of Gmsh and STL files as rigid obstacles.

use crate::lookup::required;
use crate::surfaces::is_stl;
use crate::{UnitName, mesh_file};
use contact::error::SceneError;
use contact::names::find_face;
use contact::scene::{MeshSurface, Side};
use exchange::gmsh::{self, GmshMesh};
use exchange::read_stl;
use std::path::Path;

/// Nodes (mm), and the nodes of every facet.
type Facets = (Vec<[f64; 3]>, Vec<Vec<u32>>);

/// The surface of a face; `field` stands in messages.
///
/// # Errors
/// [`SceneError`] for a file that is no mesh, for a face that it does not have, and as [`MeshSurface::new`].
pub(crate) fn read(
    field: &str,
    file: &Path,
    face: Option<&str>,
    unit: UnitName,
    side: Side,
) -> Result<MeshSurface, SceneError> {
    let path = file.display().to_string();
    let failed = |reason: String| SceneError::File { path: path.clone(), reason };
    let bytes = mesh_file::bytes(file)?;
    let (nodes, facets) = if is_stl(file) {
        let allowed = "none: an STL file is one face";
        SceneError::require(face.is_none(), format!("{field}.face"), format!("{face:?}"), allowed)?;
        let (nodes, triangles) = read_stl(&bytes).map_err(|error| failed(error.to_string()))?;
        (nodes, triangles.into_iter().map(Vec::from).collect())
    } else {
        let gmsh = gmsh::read_surfaces(&bytes).map_err(|error| failed(error.to_string()))?;
        let place = format!("{field}.face");
        let face = *required(&place, face.as_ref(), "the name of a physical surface of the file")?;
        of_gmsh(&place, &gmsh, face).map_err(|source| SceneError::InFile { file: path, source: Box::new(source) })?
    };
    let in_millimetres = nodes.into_iter().map(|x| x.map(|x| unit.millimetres() * x)).collect();
    MeshSurface::new(field, in_millimetres, facets, side)
}

/// A physical surface; the outside of its facets is that of the cells, where there are any.
fn of_gmsh(place: &str, gmsh: &GmshMesh, face: &str) -> Result<Facets, SceneError> {
    if !gmsh.cells.is_empty() {
        let mesh = mesh_file::convert(gmsh, UnitName::Mm, "the obstacle")?.mesh;
        let facets = find_face(place, face, &mesh)?.iter().map(|facet| mesh.face_nodes(*facet).collect()).collect();
        return Ok((mesh.nodes().to_vec(), facets));
    }
    let (gmsh, _) = gmsh.merged();
    let facets = gmsh.surfaces.get(face).filter(|facets| !facets.is_empty()).ok_or_else(|| {
        let names: Vec<&str> = gmsh.surfaces.keys().map(String::as_str).collect();
        SceneError::out_of_range(place, format!("\"{face}\""), format!("one of {}", names.join(", ")))
    })?;
    let nodes = |&facet: &usize| gmsh.facets[facet].nodes.iter().map(|&node| node as u32).collect();
    Ok((gmsh.nodes.clone(), facets.iter().map(nodes).collect()))
}
