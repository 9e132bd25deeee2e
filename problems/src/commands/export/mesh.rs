//! A shape as a mesh: skins of bodies as triangles, meshes as Gmsh files, the contact nodes as a table.

use crate::commands::export::files::{OutputFile, body_file};
use crate::commands::export::shape::failure;
use crate::commands::failure::Failure;
use crate::commands::numbers::exact;
use crate::commands::scene_words::{self, stem};
use contact::body::Body;
use contact::body::mesh::{CellFace, CellKind, Mesh};
use contact::equilibrium::ContactProblem;
use contact::scene::{BodyFace, BodyScene};
use contact::shape::Positions;
use exchange::gmsh::{self, GmshCell, GmshFacet, GmshMesh};
use exchange::{Triangle, stl};

/// The slave faces of all contacts and the skins of all bodies as triangles between the nodes of the meshes.
///
/// # Errors
/// [`Failure`] for positions that are no numbers.
pub fn triangles(problem: &ContactProblem, controls: &[f64]) -> Result<Vec<OutputFile>, Failure> {
    let (scene, positions) = (&problem.scene, problem.map.positions(controls));
    let facets = |face: &BodyFace| {
        let mesh = &problem.bodies[face.body].mesh;
        let faces = mesh.faces().get(&face.face).map_or(&[][..], Vec::as_slice);
        faces.iter().flat_map(|own| divided(mesh, *own, &positions[face.body])).collect::<Vec<_>>()
    };
    let contact: Vec<Triangle> = scene.contacts.iter().flat_map(|contact| facets(&contact.slave)).collect();
    let what = if scene.contacts.len() == 1 { "the contact face alone" } else { "the slave faces of all contacts" };
    let mut files = vec![written("surface.stl".into(), what, &contact)?];
    for body in 0..problem.bodies.len() {
        files.push(skin(problem, body, &positions)?);
    }
    Ok(files)
}

/// The skin of a body as triangles between the nodes of its mesh.
///
/// # Errors
/// [`Failure`] for positions that are no numbers.
pub fn skin(problem: &ContactProblem, body: usize, positions: &Positions) -> Result<OutputFile, Failure> {
    let Body { mesh, name, .. } = &problem.bodies[body];
    let triangles: Vec<Triangle> = mesh.skin().iter().flat_map(|face| divided(mesh, *face, &positions[body])).collect();
    let what = format!("the {}, closed", scene_words::body(name));
    written(body_file(&problem.scene, body, "stl"), &what, &triangles)
}

fn written(name: String, what: &str, triangles: &[Triangle]) -> Result<OutputFile, Failure> {
    let (count, content) = (triangles.len(), stl(triangles).map_err(failure)?);
    let what = format!("{what}: {count} triangles between the nodes of the mesh");
    Ok(OutputFile { name, content, what, triangles: Some(count) })
}

/// A face as triangles, counterclockwise seen from outside.
fn divided(mesh: &Mesh, face: CellFace, positions: &[[f64; 3]]) -> Vec<Triangle> {
    let x: Vec<[f64; 3]> = mesh.face_nodes(face).map(|node| positions[node as usize]).collect();
    let corners: &[[usize; 3]] =
        if x.len() == 4 { &[[0, 1, 2], [0, 2, 3]] } else { &[[0, 3, 5], [3, 1, 4], [5, 4, 2], [3, 4, 5]] };
    corners.iter().map(|corners| corners.map(|corner| x[corner].map(|x| x as f32))).collect()
}

/// The meshes of the optimized bodies in the shape, with their names.
///
/// # Errors
/// [`Failure`] for names that no Gmsh file has.
pub fn gmsh_files(problem: &ContactProblem, controls: &[f64]) -> Result<Vec<OutputFile>, Failure> {
    let positions = problem.map.positions(controls);
    let file = |(number, body): (usize, &BodyScene)| {
        let mesh = &problem.bodies[number].mesh;
        let content = gmsh::write(&gmsh_mesh(mesh, &positions[number]), true).map_err(Failure::computation)?;
        // The body of a mesh alone has always been the lower one here.
        let name = if body.name == "body" { "lower" } else { &body.name };
        let (nodes, cells) = (mesh.node_count(), mesh.cell_count());
        let what = format!("the mesh of the {name} body in this shape: {nodes} nodes, {cells} cells, mm");
        let name = body_file(&problem.scene, number, "msh");
        Ok(OutputFile { name, content, what, triangles: None })
    };
    problem.scene.bodies.iter().enumerate().filter(|(_, body)| body.shape.is_some()).map(file).collect()
}

fn gmsh_mesh(mesh: &Mesh, nodes: &[[f64; 3]]) -> GmshMesh {
    let wide = |nodes: &[u32]| nodes.iter().map(|&node| node as usize).collect::<Vec<usize>>();
    let kind = |kind| match kind {
        CellKind::Hex8 => gmsh::CellKind::Hex8,
        CellKind::Tet10 => gmsh::CellKind::Tet10,
    };
    let cells: Vec<GmshCell> = (1..)
        .zip(mesh.cells())
        .map(|(tag, cell)| GmshCell { kind: kind(cell.kind), nodes: wide(cell.nodes), tag })
        .collect();
    let mut this =
        GmshMesh { node_tags: (1..=nodes.len() as u64).collect(), nodes: nodes.to_vec(), cells, ..GmshMesh::default() };
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

/// Places of the contact nodes at the start and in the shape; where there are several contacts, with the name of the
/// slave body.
pub fn table(problem: &ContactProblem, controls: &[f64]) -> OutputFile {
    let (start, positions) = (problem.start_positions(), problem.map.positions(controls));
    let several = problem.scene.contacts.len() > 1;
    let head = "node,start_x1_mm,start_x2_mm,start_x3_mm,x1_mm,x2_mm,x3_mm\n";
    let mut table = if several { format!("contact,body,{head}") } else { head.to_owned() };
    let points = problem.boundary.contact_points();
    for point in points {
        let node = point.node as usize;
        let (start, here) = (start[point.body][node], positions[point.body][node]);
        let numbers: Vec<String> = start.into_iter().chain(here).map(exact).collect();
        let lead = if several {
            format!("{},{},", point.contact + 1, stem(&problem.scene, point.body))
        } else {
            String::new()
        };
        table += &format!("{lead}{node},{}\n", numbers.join(","));
    }
    let count = points.len();
    OutputFile::text(
        "surface.csv",
        table,
        format!("places of the {count} contact nodes at the start and in this shape"),
    )
}
