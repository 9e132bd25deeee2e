//! A shape as a mesh: its skin as triangles, the mesh as a Gmsh file, the contact nodes as a table.

use crate::commands::export::files::OutputFile;
use crate::commands::export::shape::failure;
use crate::commands::failure::Failure;
use crate::commands::numbers::exact;
use contact::body::mesh::{CellFace, CellKind, Mesh};
use contact::equilibrium::ContactProblem;
use exchange::gmsh::{self, GmshCell, GmshFacet, GmshMesh};
use exchange::{Triangle, stl};

/// The skin of the body and its contact face as triangles between the nodes of the mesh.
///
/// # Errors
/// [`Failure`] for positions that are no numbers.
pub fn triangles(problem: &ContactProblem, controls: &[f64]) -> Result<Vec<OutputFile>, Failure> {
    let (mesh, positions) = (&problem.bodies[0].mesh, problem.map.positions(controls));
    let contact = mesh.faces().get(&problem.scene.contact.face).map_or(&[][..], Vec::as_slice);
    let written = |name, what: &str, faces: &[CellFace]| {
        let triangles: Vec<Triangle> = faces.iter().flat_map(|face| divided(mesh, *face, &positions)).collect();
        let (count, content) = (triangles.len(), stl(&triangles).map_err(failure)?);
        let what = format!("{what}: {count} triangles between the nodes of the mesh");
        Ok::<_, Failure>(OutputFile { name, content, what, triangles: Some(count) })
    };
    Ok(vec![
        written("surface.stl", "the contact face alone", contact)?,
        written("lower_body.stl", "the body, closed", &mesh.skin())?,
    ])
}

/// A face as triangles, counterclockwise seen from outside.
fn divided(mesh: &Mesh, face: CellFace, positions: &[[f64; 3]]) -> Vec<Triangle> {
    let x: Vec<[f64; 3]> = mesh.face_nodes(face).map(|node| positions[node as usize]).collect();
    let corners: &[[usize; 3]] =
        if x.len() == 4 { &[[0, 1, 2], [0, 2, 3]] } else { &[[0, 3, 5], [3, 1, 4], [5, 4, 2], [3, 4, 5]] };
    corners.iter().map(|corners| corners.map(|corner| x[corner].map(|x| x as f32))).collect()
}

/// The mesh of the shape with its names.
///
/// # Errors
/// [`Failure`] for names that no Gmsh file has.
pub fn gmsh_file(problem: &ContactProblem, controls: &[f64]) -> Result<OutputFile, Failure> {
    let mesh = &problem.bodies[0].mesh;
    let gmsh = gmsh_mesh(mesh, problem.map.positions(controls));
    let content = gmsh::write(&gmsh, true).map_err(Failure::computation)?;
    let what = format!(
        "the mesh of the lower body in this shape: {} nodes, {} cells, mm",
        mesh.node_count(),
        mesh.cell_count()
    );
    Ok(OutputFile { name: "lower_body.msh", content, what, triangles: None })
}

fn gmsh_mesh(mesh: &Mesh, nodes: Vec<[f64; 3]>) -> GmshMesh {
    let wide = |nodes: &[u32]| nodes.iter().map(|&node| node as usize).collect::<Vec<usize>>();
    let kind = |kind| match kind {
        CellKind::Hex8 => gmsh::CellKind::Hex8,
        CellKind::Tet10 => gmsh::CellKind::Tet10,
    };
    let cells: Vec<GmshCell> = (1..)
        .zip(mesh.cells())
        .map(|(tag, cell)| GmshCell { kind: kind(cell.kind), nodes: wide(cell.nodes), tag })
        .collect();
    let mut this = GmshMesh { node_tags: (1..=nodes.len() as u64).collect(), nodes, cells, ..GmshMesh::default() };
    for (name, faces) in mesh.faces() {
        let first = this.facets.len();
        for &face in faces {
            let nodes: Vec<usize> = mesh.face_nodes(face).map(|node| node as usize).collect();
            let kind = if nodes.len() == 4 { gmsh::FacetKind::Quad4 } else { gmsh::FacetKind::Tri6 };
            let tag = (this.cells.len() + this.facets.len() + 1) as u64;
            this.facets.push(GmshFacet { kind, nodes, tag });
        }
        this.surfaces.insert(name.clone(), (first..this.facets.len()).collect());
    }
    for (number, name) in mesh.volumes().iter().enumerate() {
        let cells = (0..mesh.cell_count()).filter(|cell| mesh.volume_of(*cell) == number);
        this.volumes.insert(name.clone(), cells.collect());
    }
    this.node_groups = mesh.node_sets().iter().map(|(name, nodes)| (name.clone(), wide(nodes))).collect();
    this
}

/// Places of the contact nodes at the start and in the shape.
pub fn table(problem: &ContactProblem, controls: &[f64]) -> OutputFile {
    let (start, positions) = (problem.start_positions(), problem.map.positions(controls));
    let mut table = String::from("node,start_x1_mm,start_x2_mm,start_x3_mm,x1_mm,x2_mm,x3_mm\n");
    for point in &problem.boundary.points {
        let node = point.node as usize;
        let numbers: Vec<String> = start[0][node].into_iter().chain(positions[node]).map(exact).collect();
        table += &format!("{node},{}\n", numbers.join(","));
    }
    let count = problem.boundary.points.len();
    OutputFile::text(
        "surface.csv",
        table,
        format!("places of the {count} contact nodes at the start and in this shape"),
    )
}
