//! Bodies from Gmsh files: units, tetrahedra of first order, faces by their owner cells; what is wrong is told before
//! any work.

use crate::UnitName;
use crate::mesh_check::{self, EDGES, check_cells, check_parts};
use contact::body::mesh::{CellKind, Mesh, SharedFace};
use contact::error::SceneError;
use exchange::gmsh::{self, GmshFacet, GmshMesh, Repeated};
use std::collections::{BTreeSet, HashMap};
use std::fs;
use std::path::Path;

/// Largest mesh file, bytes.
const LARGEST_FILE: u64 = 4 << 30;

/// A mesh with what is to be said of it.
#[derive(Debug)]
pub(crate) struct MeshFile {
    pub mesh: Mesh,
    pub notes: Vec<String>,
}

/// Reads a Gmsh file as a body.
///
/// # Errors
/// [`SceneError::File`] for a file that cannot be read and for what the format does not allow; [`SceneError::InFile`]
/// for cells that are inverted or overlap, a body in several parts, and surfaces that are no faces of cells.
pub(crate) fn read(file: &Path, unit: UnitName) -> Result<MeshFile, SceneError> {
    let (path, bytes) = (file.display().to_string(), bytes(file)?);
    let gmsh =
        gmsh::read(&bytes).map_err(|error| SceneError::File { path: path.clone(), reason: error.to_string() })?;
    let name = file.file_name().map_or_else(|| path.clone(), |name| name.to_string_lossy().into_owned());
    convert(&gmsh, unit, &name).map_err(|source| SceneError::InFile { file: path, source: Box::new(source) })
}

/// The bytes of a mesh file.
///
/// # Errors
/// [`SceneError::File`] for a file that cannot be read or is too long.
pub(crate) fn bytes(file: &Path) -> Result<Vec<u8>, SceneError> {
    let failed = |reason: String| SceneError::File { path: file.display().to_string(), reason };
    let size = fs::metadata(file).map_err(|error| failed(error.to_string()))?.len();
    if size > LARGEST_FILE {
        return Err(failed(format!("the file is too long; allowed: at most {} GiB", LARGEST_FILE >> 30)));
    }
    fs::read(file).map_err(|error| failed(error.to_string()))
}

/// The body of a mesh of Gmsh.
///
/// # Errors
/// As [`read`], without the name of the file.
pub(crate) fn convert(gmsh: &GmshMesh, unit: UnitName, name: &str) -> Result<MeshFile, SceneError> {
    let (gmsh, repeated) = gmsh.merged();
    let gmsh = &*gmsh;
    let factor = unit.millimetres();
    let mut nodes: Vec<[f64; 3]> = gmsh.nodes.iter().map(|x| x.map(|x| factor * x)).collect();
    let (mut middles, mut cells) = (HashMap::new(), Vec::with_capacity(gmsh.cells.len()));
    for cell in &gmsh.cells {
        cells.push(match cell.kind {
            gmsh::CellKind::Hex8 => (CellKind::Hex8, cell.nodes.clone()),
            gmsh::CellKind::Tet10 => (CellKind::Tet10, cell.nodes.clone()),
            gmsh::CellKind::Tet4 => {
                let mut all = cell.nodes.clone();
                all.extend(EDGES.map(|[a, b]| middle(&mut middles, &mut nodes, [cell.nodes[a], cell.nodes[b]])));
                (CellKind::Tet10, all)
            }
        });
    }
    let mut notes = vec![description(gmsh, &nodes, name, unit)];
    if !middles.is_empty() {
        let count = middles.len();
        notes.push(format!(
            "{name}: tet4 cells got {count} nodes in the middles of their edges and are tet10 cells now"
        ));
    }
    notes.extend(note_of_repeated(repeated).map(|words| format!("{name}: {words}")));
    let mesh = Mesh::new(nodes, cells)?;
    check_cells(gmsh, &mesh, &mut notes, name)?;
    let faces = mesh_check::faces(gmsh, &mesh)?;
    check_parts(gmsh, &mesh)?;
    let mesh = with_volumes(gmsh, mesh)?;
    let mesh = with_node_groups(gmsh, mesh)?;
    let mesh = with_surfaces(gmsh, mesh, &faces, &mut notes, name)?;
    let empty = empty_names(gmsh);
    if !empty.is_empty() {
        let names: Vec<String> = empty.iter().map(|name| format!("\"{name}\"")).collect();
        notes.push(format!("{name}: names without elements: {}; nothing can be asked of them", names.join(", ")));
    }
    let mesh = mesh.with_group_tags(gmsh.group_tags.clone()).from_file(name, empty);
    Ok(MeshFile { mesh, notes })
}

/// Names of physical groups none of which has elements: those of a part that a boolean operation has taken away.
fn empty_names(gmsh: &GmshMesh) -> BTreeSet<String> {
    let groups = || [&gmsh.volumes, &gmsh.surfaces, &gmsh.node_groups].into_iter().flatten();
    let full: BTreeSet<&String> = groups().filter(|(_, members)| !members.is_empty()).map(|(name, _)| name).collect();
    groups().map(|(name, _)| name).filter(|name| !full.contains(name)).cloned().collect()
}

/// What is said of facets and cells that were listed more than once.
fn note_of_repeated(repeated: Repeated) -> Option<String> {
    let counted = |count: usize, one: &str, many: &str| match count {
        0 => None,
        1 => Some(format!("1 {one}")),
        _ => Some(format!("{count} {many}")),
    };
    let counts = [counted(repeated.facets, "facet", "facets"), counted(repeated.cells, "cell", "cells")];
    let counts: Vec<String> = counts.into_iter().flatten().collect();
    let verb = if repeated.facets + repeated.cells == 1 { "is" } else { "are" };
    let words =
        || format!("{} {verb} listed more than once; each counts once, in all its groups", counts.join(" and "));
    (!counts.is_empty()).then(words)
}

/// The node in the middle of an edge.
fn middle(middles: &mut HashMap<[usize; 2], usize>, nodes: &mut Vec<[f64; 3]>, [a, b]: [usize; 2]) -> usize {
    *middles.entry([a.min(b), a.max(b)]).or_insert_with(|| {
        let (a, b) = (nodes[a], nodes[b]);
        nodes.push(std::array::from_fn(|axis| 0.5 * (a[axis] + b[axis])));
        nodes.len() - 1
    })
}

/// Numbers of nodes and cells, and the box around the mesh in mm.
fn description(gmsh: &GmshMesh, nodes: &[[f64; 3]], name: &str, unit: UnitName) -> String {
    let kinds = [gmsh::CellKind::Hex8, gmsh::CellKind::Tet4, gmsh::CellKind::Tet10];
    let count = |kind: gmsh::CellKind| gmsh.cells.iter().filter(|cell| cell.kind == kind).count();
    let names = ["hex8", "tet4", "tet10"];
    let counts = kinds.into_iter().map(count).zip(names).filter(|(count, _)| *count > 0);
    let counts: Vec<String> = counts.map(|(count, name)| format!("{count} {name}")).collect();
    let side = |axis: usize| {
        let along = || nodes.iter().map(|x| x[axis]);
        let (least, most) = (along().fold(f64::INFINITY, f64::min), along().fold(f64::NEG_INFINITY, f64::max));
        format!("{least:.6} … {most:.6}")
    };
    format!(
        "{name}: {} nodes, {} cells; in {}, it lies in x1 = {}, x2 = {}, x3 = {} mm",
        gmsh.nodes.len(),
        counts.join(", "),
        unit.words(),
        side(0),
        side(1),
        side(2)
    )
}

/// Gives every cell its volume: the first physical group that it is in.
fn with_volumes(gmsh: &GmshMesh, mesh: Mesh) -> Result<Mesh, SceneError> {
    let volumes = || gmsh.volumes.iter().filter(|(_, cells)| !cells.is_empty());
    let mut names: Vec<String> = volumes().map(|(name, _)| name.clone()).collect();
    if names.is_empty() {
        return Ok(mesh);
    }
    let mut volume_of: Vec<Option<u16>> = vec![None; mesh.cell_count()];
    let allowed = "at most 65534 physical volumes";
    let too_many = || SceneError::out_of_range("physical volumes", names.len(), allowed);
    for (number, (name, cells)) in volumes().enumerate() {
        let number = u16::try_from(number).map_err(|_| too_many())?;
        for &cell in cells {
            if let Some(other) = volume_of[cell].replace(number) {
                let value = format!("\"{}\" and \"{name}\"", names[usize::from(other)]);
                let field = format!("physical volumes of element {}", gmsh.cells[cell].tag);
                return Err(SceneError::out_of_range(field, value, "one, which gives its material"));
            }
        }
    }
    let rest = u16::try_from(names.len()).map_err(|_| too_many())?;
    if volume_of.contains(&None) {
        names.push("without name".into());
    }
    mesh.with_volumes(names, volume_of.into_iter().map(|volume| volume.unwrap_or(rest)).collect())
}

fn with_node_groups(gmsh: &GmshMesh, mesh: Mesh) -> Result<Mesh, SceneError> {
    let narrow = |nodes: &[usize]| nodes.iter().map(|&node| node as u32).collect();
    let mut groups = gmsh.node_groups.iter().filter(|(_, nodes)| !nodes.is_empty());
    groups.try_fold(mesh, |mesh, (name, nodes)| mesh.with_node_set(name, narrow(nodes)))
}

/// Gives names to the faces of cells on which surface elements lie. Where these lie between cells, the name is one of
/// nodes.
fn with_surfaces(
    gmsh: &GmshMesh,
    mut mesh: Mesh,
    faces: &HashMap<[u32; 4], SharedFace>,
    notes: &mut Vec<String>,
    name: &str,
) -> Result<Mesh, SceneError> {
    for (surface, facets) in gmsh.surfaces.iter().filter(|(_, facets)| !facets.is_empty()) {
        let field = || format!("physical surface \"{surface}\"");
        let mut found = Vec::with_capacity(facets.len());
        for facet in facets.iter().map(|&facet| &gmsh.facets[facet]) {
            let face = faces.get(&corners(facet)).ok_or_else(|| {
                let value = format!("element {}, which is no face of a cell", facet.tag);
                SceneError::out_of_range(field(), value, "faces of cells")
            })?;
            found.push(face);
        }
        let inner = found.iter().filter(|face| face.second.is_some()).count();
        if inner > 0 && inner < found.len() {
            let first = found.iter().position(|face| face.second.is_some()).unwrap_or(0);
            let outside = found.len() - inner;
            let value = format!("element {} among {outside} faces of the skin", gmsh.facets[facets[first]].tag);
            return Err(SceneError::out_of_range(field(), value, "outer faces of cells alone, or inner ones alone"));
        }
        let first_cells = found.iter().map(|face| face.first).collect();
        if inner == 0 {
            mesh = mesh.with_face(surface, first_cells)?;
        } else {
            mesh = mesh.with_inner_face(surface, first_cells)?;
            notes.push(format!("{name}: the surface \"{surface}\" lies between cells: it is a set of nodes, no face"));
        }
    }
    Ok(mesh)
}

/// The corners of a facet, ascending; the fourth one of a triangle is the largest number.
fn corners(facet: &GmshFacet) -> [u32; 4] {
    let count = if facet.kind == gmsh::FacetKind::Quad4 { 4 } else { 3 };
    let mut key = [u32::MAX; 4];
    facet.nodes[..count].iter().zip(&mut key).for_each(|(node, key)| *key = *node as u32);
    key.sort_unstable();
    key
}
