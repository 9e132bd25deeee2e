//! What must hold of the cells of a mesh: none inverted, none on top of another one, one body.

use contact::body::load_size;
use contact::body::mesh::{CellKind, Mesh, SharedFace, bounding_box};
use contact::error::SceneError;
use contact::scene::BodyScene;
use exchange::gmsh::GmshMesh;
use std::collections::HashMap;

/// Scaled Jacobian below which a cell is told of.
const POOR: f64 = 0.2;

/// Edges of a tetrahedron in Gmsh's order of their middles.
pub(crate) const EDGES: [[usize; 2]; 6] = [[0, 1], [1, 2], [0, 2], [0, 3], [2, 3], [1, 3]];

/// Refuses inverted cells, and tells of the worst shaped one.
pub(crate) fn check_cells(gmsh: &GmshMesh, mesh: &Mesh, notes: &mut Vec<String>, name: &str) -> Result<(), SceneError> {
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

/// The faces of the cells by their corners. Refuses cells that overlap, as far as common faces show it.
pub(crate) fn faces(gmsh: &GmshMesh, mesh: &Mesh) -> Result<HashMap<[u32; 4], SharedFace>, SceneError> {
    let faces = mesh.faces_by_corners().map_err(|[one, other]| {
        let [one_cell, other_cell] = [one, other].map(|face| element(gmsh, face.cell as usize));
        let corners = mesh.face_with_corners(one);
        let corner = |axis: usize| corners.0[..corners.1].iter().map(move |&node| mesh.nodes()[node as usize][axis]);
        let [x1, x2, x3] = [0, 1, 2].map(|axis| corner(axis).sum::<f64>() / corners.1 as f64);
        let value = format!(
            "cells that overlap: {one_cell} and {other_cell} lie on one side of their common face at \
             ({x1:.4e}, {x2:.4e}, {x3:.4e}) mm"
        );
        SceneError::out_of_range("cells", value, "at most one cell on each side of a face")
    })?;
    check_middles(gmsh, mesh)?;
    Ok(faces)
}

/// A cell by its tag and its groups.
fn element(gmsh: &GmshMesh, cell: usize) -> String {
    let has_it =
        |(name, cells): (&String, &Vec<usize>)| cells.binary_search(&cell).is_ok().then(|| format!("\"{name}\""));
    let groups: Vec<String> = gmsh.volumes.iter().filter_map(has_it).collect();
    let groups = if groups.is_empty() { String::new() } else { format!(" ({})", groups.join(", ")) };
    format!("element {}{groups}", gmsh.cells[cell].tag)
}

/// Refuses an edge with two nodes in its middle: the cells around it would come apart there.
fn check_middles(gmsh: &GmshMesh, mesh: &Mesh) -> Result<(), SceneError> {
    let mut middles = HashMap::new();
    for (cell, found) in mesh.cells().enumerate().filter(|(_, cell)| cell.kind == CellKind::Tet10) {
        for (edge, &middle) in EDGES.iter().zip(&found.nodes[4..]) {
            let mut ends = edge.map(|corner| found.nodes[corner]);
            ends.sort_unstable();
            let (first, node) = *middles.entry(ends).or_insert((cell, middle));
            if node != middle {
                let [first, second] = [first, cell].map(|cell| element(gmsh, cell));
                let value = format!("{first} and {second} have different nodes in the middle of a common edge");
                let allowed = "one node in the middle of an edge, for all cells around it";
                return Err(SceneError::out_of_range("cells", value, allowed));
            }
        }
    }
    Ok(())
}

/// Refuses a mesh that falls into parts.
pub(crate) fn check_parts(gmsh: &GmshMesh, mesh: &Mesh) -> Result<(), SceneError> {
    let parts = mesh.parts();
    let [_, second, ..] = &parts[..] else { return Ok(()) };
    let place = |cell: usize| {
        let [x1, x2, x3] = mesh.centre(cell, mesh.nodes());
        format!("element {} at ({x1:.4e}, {x2:.4e}, {x3:.4e}) mm", gmsh.cells[cell].tag)
    };
    let first_of = |kind: CellKind| mesh.cells().position(|cell| cell.kind == kind);
    let (value, allowed) = match (first_of(CellKind::Hex8), first_of(CellKind::Tet10)) {
        (Some(hexahedron), Some(tetrahedron)) => (
            format!(
                "hexahedra beside tetrahedra, with {} and {}; quadrilaterals and triangles have no face in common",
                place(hexahedron),
                place(tetrahedron)
            ),
            "cells of one kind in one body (two bodies can be tied)",
        ),
        _ => (
            format!(
                "{} parts; the second one has {} cells, with {}",
                parts.len(),
                second.len(),
                place(second[0] as usize)
            ),
            "one body, whose cells hang together by common faces (merge duplicate nodes in Gmsh)",
        ),
    };
    Err(SceneError::out_of_range("mesh", value, allowed))
}

/// Extents of a body, mm, outside which its unit is doubtful.
const USUAL_EXTENTS: [f64; 2] = [1.0, 2e4];
/// Nominal strain above which loads, unit or elastic constants are doubtful: linear elasticity ends before.
const USUAL_STRAIN: f64 = 0.05;

/// Signs of a mesh in another unit than the scene says: an unusual extent, and loads that strain the body too much.
/// `at`: the place of the body in the file.
pub(crate) fn doubts_of_unit(at: &str, mesh: &Mesh, body: &BodyScene) -> Result<Vec<String>, SceneError> {
    let [least, most] = bounding_box(mesh.nodes());
    let mut extents = [0, 1, 2].map(|axis| most[axis] - least[axis]);
    extents.sort_by(f64::total_cmp);
    let mut doubts = Vec::new();
    if extents[2] < USUAL_EXTENTS[0] || extents[2] > USUAL_EXTENTS[1] {
        doubts.push(format!(
            "the body is {:.3e} mm long: is {at}.unit the unit of the mesh? (\"mm\", \"cm\", \"m\" or \"inch\")",
            extents[2]
        ));
    }
    let (load, section) = (load_size(mesh, &body.loads)?, extents[0] * extents[1]);
    let strain = load / section / body.material.young_modulus();
    if strain > USUAL_STRAIN {
        doubts.push(format!(
            "the loads, {load:.3e} N in all, over the section of the body, {section:.3e} mm^2, strain it by {:.1e} %: are \
             {at}.unit, the loads (N, MPa) and young_modulus (MPa) what they should be?",
            100.0 * strain
        ));
    }
    Ok(doubts)
}
