//! A shape as a mesh: skins of bodies as triangles, meshes as files of Gmsh and of the Visualization Toolkit.

use crate::commands::export::files::{OutputFile, body_file};
use crate::commands::export::shape::failure;
use crate::commands::failure::Failure;
use crate::commands::scene_words;
use crate::vtk_files::vtk_cells;
use contact::body::Body;
use contact::body::mesh::{CellFace, CellKind, Mesh};
use contact::equilibrium::ContactProblem;
use contact::scene::{BodyFace, BodyScene};
use contact::shape::Positions;
use exchange::gmsh::{self, GmshCell, GmshFacet, GmshMesh};
use exchange::vtk::{Array, UnstructuredGrid, Values, unstructured};
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
        flat(mesh, faces, &positions[face.body])
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
fn skin(problem: &ContactProblem, body: usize, positions: &Positions) -> Result<OutputFile, Failure> {
    let Body { mesh, name, .. } = &problem.bodies[body];
    let triangles = flat(mesh, &mesh.skin(), &positions[body]);
    let what = format!("the {}, closed", scene_words::body(name));
    written(body_file(&problem.scene, body, "stl"), &what, &triangles)
}

fn written(name: String, what: &str, triangles: &[Triangle]) -> Result<OutputFile, Failure> {
    let (count, content) = (triangles.len(), stl(triangles).map_err(failure)?);
    let what = format!("{what}: {count} triangles between the nodes of the mesh");
    Ok(OutputFile { triangles: Some(count), ..OutputFile::new(name, content, what) })
}

/// Faces as triangles between nodes at some positions.
fn flat(mesh: &Mesh, faces: &[CellFace], positions: &[[f64; 3]]) -> Vec<Triangle> {
    let corner = |node: u32| positions[node as usize].map(|x| x as f32);
    faces.iter().flat_map(|face| divided(mesh, *face)).map(|nodes| nodes.map(corner)).collect()
}

/// The triangles of a face by their nodes, counterclockwise seen from outside.
pub fn divided(mesh: &Mesh, face: CellFace) -> impl Iterator<Item = [u32; 3]> {
    let nodes: Vec<u32> = mesh.face_nodes(face).collect();
    let corners: &[[usize; 3]] =
        if nodes.len() == 4 { &[[0, 1, 2], [0, 2, 3]] } else { &[[0, 3, 5], [3, 1, 4], [5, 4, 2], [3, 4, 5]] };
    corners.iter().map(move |corners| corners.map(|corner| nodes[corner]))
}

/// The meshes of the optimized bodies in the shape, with their names.
///
/// # Errors
/// [`Failure`] for names that no Gmsh file has.
pub fn gmsh_files(problem: &ContactProblem, controls: &[f64]) -> Result<Vec<OutputFile>, Failure> {
    let content = |mesh: &Mesh, nodes: &[[f64; 3]], _: &[[f64; 3]]| {
        gmsh::write(&gmsh_mesh(mesh, nodes), true).map_err(Failure::computation)
    };
    files(problem, controls, "msh", content)
}

/// The meshes of the optimized bodies in the shape as grids of the Visualization Toolkit, with their change.
///
/// # Errors
/// [`Failure`] for positions that are no numbers.
pub fn vtk_files(problem: &ContactProblem, controls: &[f64]) -> Result<Vec<OutputFile>, Failure> {
    let content = |mesh: &Mesh, nodes: &[[f64; 3]], start: &[[f64; 3]]| {
        let change = nodes.iter().zip(start).map(|(x, from)| std::array::from_fn(|axis| x[axis] - from[axis]));
        let volumes = (0..mesh.cell_count()).map(|cell| mesh.volume_of(cell) as i32 + 1).collect();
        let names = (1..).zip(mesh.volumes()).map(|(number, name)| format!("{number} {name}")).collect::<Vec<_>>();
        let grid = UnstructuredGrid {
            description: format!(
                "{}: the mesh in a shape. Lengths in mm. change: from the start of the scene. volume: {}.",
                problem.scene.name,
                names.join(", ")
            ),
            points: nodes.to_vec(),
            cells: vtk_cells(mesh, 0).collect(),
            point_data: vec![Array::new("change", "mm", Values::Vectors(change.collect()))],
            cell_data: vec![Array::new("volume", "", Values::Integers(volumes))],
            ..UnstructuredGrid::default()
        };
        Ok(unstructured(&grid).map_err(Failure::computation)?.into_bytes())
    };
    files(problem, controls, "vtu", content)
}

/// A file per optimized body, from its mesh, its positions in the shape and those at the start.
fn files(
    problem: &ContactProblem,
    controls: &[f64],
    ending: &str,
    content: impl Fn(&Mesh, &[[f64; 3]], &[[f64; 3]]) -> Result<Vec<u8>, Failure>,
) -> Result<Vec<OutputFile>, Failure> {
    let (start, positions) = (problem.start_positions(), problem.map.positions(controls));
    let file = |(number, body): (usize, &BodyScene)| {
        let mesh = &problem.bodies[number].mesh;
        let content = content(mesh, &positions[number], &start[number])?;
        let name = if body.name == "body" { "the body".to_owned() } else { format!("the {} body", body.name) };
        let (nodes, cells) = (mesh.node_count(), mesh.cell_count());
        let what = format!("the mesh of {name} in this shape: {nodes} nodes, {cells} cells, mm");
        Ok(OutputFile::new(body_file(&problem.scene, number, ending), content, what))
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
    for (name, faces) in mesh.faces().iter().chain(mesh.inner_faces()) {
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
    let of_nodes = mesh.node_sets().iter().filter(|(name, _)| !mesh.inner_faces().contains_key(*name));
    this.node_groups = of_nodes.map(|(name, nodes)| (name.clone(), wide(nodes))).collect();
    this.group_tags = mesh.group_tags().clone();
    // A facet with several names stands there once.
    this.merged().0.into_owned()
}
