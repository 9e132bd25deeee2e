//! Bodies from Gmsh files: units, tetrahedra of first order, faces by their owner cells; what is wrong is told before
//! any work.

use crate::UnitName;
use contact::body::mesh::{CellFace, CellKind, Mesh};
use contact::error::SceneError;
use exchange::gmsh::{self, GmshMesh};
use std::collections::HashMap;
use std::fs;
use std::path::Path;

/// Largest mesh file, bytes.
const LARGEST_FILE: u64 = 4 << 30;
/// Scaled Jacobian below which a cell is told of.
const POOR: f64 = 0.2;

/// A mesh with what is to be said of it.
#[derive(Debug)]
pub(crate) struct MeshFile {
    pub mesh: Mesh,
    pub notes: Vec<String>,
}

/// Edges of a tetrahedron in Gmsh's order of their middles.
const EDGES: [[usize; 2]; 6] = [[0, 1], [1, 2], [0, 2], [0, 3], [2, 3], [1, 3]];

/// Reads a Gmsh file as a body.
///
/// # Errors
/// [`SceneError::File`] for a file that cannot be read and for what the format does not allow; [`SceneError::InFile`]
/// for cells that are inverted, a body in several parts, and surfaces that are no faces of cells.
pub(crate) fn read(file: &Path, unit: UnitName) -> Result<MeshFile, SceneError> {
    let path = file.display().to_string();
    let failed = |reason: String| SceneError::File { path: path.clone(), reason };
    let size = fs::metadata(file).map_err(|error| failed(error.to_string()))?.len();
    if size > LARGEST_FILE {
        return Err(failed(format!("the file is too long; allowed: at most {} GiB", LARGEST_FILE >> 30)));
    }
    let bytes = fs::read(file).map_err(|error| failed(error.to_string()))?;
    let gmsh = gmsh::read(&bytes).map_err(|error| failed(error.to_string()))?;
    let name = file.file_name().map_or_else(|| path.clone(), |name| name.to_string_lossy().into_owned());
    convert(&gmsh, unit, &name).map_err(|source| SceneError::InFile { file: path, source: Box::new(source) })
}

/// The body of a mesh of Gmsh.
///
/// # Errors
/// As [`read`], without the name of the file.
pub(crate) fn convert(gmsh: &GmshMesh, unit: UnitName, name: &str) -> Result<MeshFile, SceneError> {
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
    let mesh = Mesh::new(nodes, cells)?;
    check_cells(gmsh, &mesh, &mut notes, name)?;
    check_parts(gmsh, &mesh)?;
    let mesh = with_volumes(gmsh, mesh)?;
    let mesh = with_surfaces(gmsh, mesh, &mut notes, name)?;
    let narrow = |nodes: &Vec<usize>| nodes.iter().map(|&node| node as u32).collect();
    let mesh = gmsh.node_groups.iter().try_fold(mesh, |mesh, (name, nodes)| mesh.with_node_set(name, narrow(nodes)))?;
    Ok(MeshFile { mesh, notes })
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

/// Refuses inverted cells, and tells of the worst shaped one.
fn check_cells(gmsh: &GmshMesh, mesh: &Mesh, notes: &mut Vec<String>, name: &str) -> Result<(), SceneError> {
    let (mut worst, mut poor) = ((f64::INFINITY, 0), 0);
    let mut inverted = Vec::new();
    for cell in 0..mesh.cell_count() {
        let nodes = mesh.cell_nodes(cell, mesh.nodes());
        let determinant = nodes.smallest_determinant();
        if !(determinant > 0.0 && determinant.is_finite()) {
            inverted.push(cell);
            continue;
        }
        let quality = nodes.scaled_jacobian();
        worst = if quality < worst.0 { (quality, cell) } else { worst };
        poor += usize::from(quality < POOR);
    }
    if let Some(&first) = inverted.first() {
        let value = format!("an inverted or flat cell (element {}, {} in all)", gmsh.cells[first].tag, inverted.len());
        return Err(SceneError::out_of_range("cells", value, "cells of positive volume at every integration point"));
    }
    if poor > 0 {
        let tag = gmsh.cells[worst.1].tag;
        notes.push(format!(
            "{name}: {poor} cells have a scaled Jacobian below {POOR}; the worst is {:.3} at element {tag}",
            worst.0
        ));
    }
    Ok(())
}

/// Refuses a mesh that falls into parts.
fn check_parts(gmsh: &GmshMesh, mesh: &Mesh) -> Result<(), SceneError> {
    let parts = mesh.parts();
    let [_, second, ..] = &parts[..] else { return Ok(()) };
    let [x1, x2, x3] = mesh.centre(second[0] as usize, mesh.nodes());
    let value = format!(
        "{} parts; the second one has {} cells, with element {} at ({x1:.4}, {x2:.4}, {x3:.4}) mm",
        parts.len(),
        second.len(),
        gmsh.cells[second[0] as usize].tag
    );
    let allowed = "one body, whose cells hang together by common faces (merge duplicate nodes in Gmsh)";
    Err(SceneError::out_of_range("mesh", value, allowed))
}

/// Gives every cell its volume: the first physical group that it is in.
fn with_volumes(gmsh: &GmshMesh, mesh: Mesh) -> Result<Mesh, SceneError> {
    if gmsh.volumes.is_empty() {
        return Ok(mesh);
    }
    let mut names: Vec<String> = gmsh.volumes.keys().cloned().collect();
    let mut volume_of: Vec<Option<u16>> = vec![None; mesh.cell_count()];
    let allowed = "at most 65534 physical volumes";
    let too_many = || SceneError::out_of_range("physical volumes", names.len(), allowed);
    for (number, (name, cells)) in gmsh.volumes.iter().enumerate() {
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

/// Gives names to the faces of cells on which surface elements lie. Where these lie between cells, the name is one of
/// nodes.
fn with_surfaces(gmsh: &GmshMesh, mut mesh: Mesh, notes: &mut Vec<String>, name: &str) -> Result<Mesh, SceneError> {
    let skin = mesh.skin_by_corners();
    for (surface, facets) in &gmsh.surfaces {
        let corners = |facet: usize| {
            let facet = &gmsh.facets[facet];
            let count = if facet.kind == gmsh::FacetKind::Quad4 { 4 } else { 3 };
            let mut key = [u32::MAX; 4];
            facet.nodes[..count].iter().zip(&mut key).for_each(|(node, key)| *key = *node as u32);
            key.sort_unstable();
            key
        };
        let faces: Vec<Option<CellFace>> = facets.iter().map(|&facet| skin.get(&corners(facet)).copied()).collect();
        let outside = faces.iter().flatten().count();
        if outside == facets.len() {
            mesh = mesh.with_face(surface, faces.into_iter().flatten().collect())?;
        } else if outside == 0 {
            let nodes = facets.iter().flat_map(|&facet| &gmsh.facets[facet].nodes).map(|&node| node as u32).collect();
            mesh = mesh.with_node_set(surface, nodes)?;
            notes.push(format!("{name}: the surface \"{surface}\" lies between cells: it is a set of nodes, no face"));
        } else {
            let first = faces.iter().position(Option::is_none).unwrap_or(0);
            let value = format!("element {} among {outside} faces of the skin", gmsh.facets[facets[first]].tag);
            let field = format!("physical surface \"{surface}\"");
            return Err(SceneError::out_of_range(field, value, "outer faces of cells alone, or inner ones alone"));
        }
    }
    Ok(mesh)
}
