//! A shape as input files of CalculiX: the optimized bodies with the supports and loads of a case, without contact.

use crate::commands::export::files::{OutputFile, body_file};
use crate::commands::export::shape::failure;
use crate::commands::failure::Failure;
use contact::body::Body;
use contact::body::mesh::CellKind;
use contact::equilibrium::ContactProblem;
use exchange::calculix::{Deck, ElementKind, Part};
use std::collections::{BTreeMap, BTreeSet};

/// Size up to which a component of a unit vector is rounding.
const NO_COMPONENT: f64 = 1e-12;

/// A file per optimized body.
///
/// # Errors
/// [`Failure`] for inverted cells, and for displacements that supports prescribe along other directions than axes.
pub fn files(problem: &ContactProblem, controls: &[f64]) -> Result<Vec<OutputFile>, Failure> {
    let positions = problem.positions(controls).map_err(|error| Failure::Input(error.to_string()))?;
    let shaped = problem.scene.bodies.iter().enumerate().filter(|(_, body)| body.shape.is_some());
    let file = |(number, _): (usize, _)| {
        let body = &problem.bodies[number];
        let forces = problem.nodal_loads(number, &positions[number]);
        let deck = deck(problem, number, &positions[number], forces)?;
        let what = format!(
            "input of CalculiX: {} nodes, {} elements, supports and loads; contact faces are held, see the comments",
            body.mesh.node_count(),
            body.mesh.cell_count()
        );
        let text = deck.text().map_err(failure)?;
        Ok(OutputFile::text(body_file(&problem.scene, number, "inp"), text, what))
    };
    shaped.map(file).collect()
}

fn deck(
    problem: &ContactProblem,
    number: usize,
    positions: &[[f64; 3]],
    forces: Vec<(u32, [f64; 3])>,
) -> Result<Deck, Failure> {
    let body = &problem.bodies[number];
    let mesh = &body.mesh;
    let wide = |nodes: &[u32]| nodes.iter().map(|&node| node as usize).collect::<Vec<usize>>();
    let kind = |kind| match kind {
        CellKind::Hex8 => ElementKind::C3D8,
        CellKind::Tet10 => ElementKind::C3D10,
    };
    let parts = mesh.volumes().iter().enumerate().filter_map(|(volume, name)| {
        let elements: Vec<usize> = (0..mesh.cell_count()).filter(|cell| mesh.volume_of(*cell) == volume).collect();
        let material = body.solid.material(*elements.first()?);
        let (young_modulus, poisson_ratio) = (material.young_modulus(), material.poisson_ratio());
        Some(Part { name: name.clone(), elements, young_modulus, poisson_ratio })
    });
    let on_face = |face: &str| -> BTreeSet<u32> {
        let faces = mesh.faces().get(face).into_iter().flatten();
        faces.flat_map(|face| mesh.face_nodes(*face)).collect()
    };
    let node_sets =
        mesh.faces().keys().map(|name| (name.clone(), on_face(name).into_iter().map(|n| n as usize).collect()));
    let contact_faces: BTreeSet<&str> = problem
        .scene
        .contacts
        .iter()
        .flat_map(|contact| contact.faces())
        .filter(|face| face.body == number)
        .map(|face| face.face.as_str())
        .collect();
    let contact: BTreeSet<u32> = contact_faces.iter().flat_map(|face| on_face(face)).collect();
    let (mut held, mut equations) = (Vec::new(), Vec::new());
    for &node in &contact {
        held.extend((0..3).map(|axis| (node as usize, axis, 0.0)));
    }
    for node in body.held_nodes().into_iter().filter(|node| !contact.contains(node)) {
        hold(body, node, &mut held, &mut equations)?;
    }
    let faces = contact_faces.into_iter().collect::<Vec<_>>().join(", ");
    Ok(Deck {
        comments: vec![
            format!("{}: lengths in mm, forces in N, stresses in MPa.", problem.scene.name.replace('\n', " ")),
            format!("There is no contact here: all nodes of the contact faces ({faces}) are held."),
            "Replace their lines below *BOUNDARY by contact, or by the contact forces of a state (--vtk, pressure_*.csv).".into(),
        ],
        nodes: positions[..mesh.node_count()].to_vec(),
        elements: mesh.cells().map(|cell| (kind(cell.kind), wide(cell.nodes))).collect(),
        parts: parts.collect(),
        node_sets: node_sets.collect(),
        held,
        equations,
        loads: summed(forces),
    })
}

/// One force per node.
fn summed(forces: Vec<(u32, [f64; 3])>) -> Vec<(usize, [f64; 3])> {
    let mut sums: BTreeMap<u32, [f64; 3]> = BTreeMap::new();
    for (node, force) in forces {
        let sum = sums.entry(node).or_default();
        (0..3).for_each(|axis| sum[axis] += force[axis]);
    }
    sums.into_iter().map(|(node, force)| (node as usize, force)).collect()
}

/// The supports of a node: along axes as prescribed displacements, along other directions as equations.
fn hold(
    body: &Body,
    node: u32,
    held: &mut Vec<(usize, usize, f64)>,
    equations: &mut Vec<Vec<(usize, usize, f64)>>,
) -> Result<(), Failure> {
    let (directions, prescribed, place) = (body.held(node), body.prescribed(node), node as usize);
    let is_axis = |d: &[f64; 3]| d.iter().filter(|d| d.abs() > NO_COMPONENT).count() == 1;
    if directions.len() == 3 {
        held.extend((0..3).map(|axis| (place, axis, prescribed[axis])));
        return Ok(());
    }
    if directions.iter().all(is_axis) {
        let axes = directions.iter().filter_map(|d| (0..3).find(|&axis| d[axis].abs() > NO_COMPONENT));
        held.extend(axes.map(|axis| (place, axis, prescribed[axis])));
        return Ok(());
    }
    if prescribed.iter().any(|value| *value != 0.0) {
        let words = "supports prescribe displacements along other directions than axes, which --inp does not write";
        return Err(Failure::Input(format!("body \"{}\", node {}: {words}", body.name, node + 1)));
    }
    // Each equation eliminates another axis: that of its largest component once the others are out of it.
    let mut rows: Vec<([f64; 3], usize)> = Vec::new();
    for direction in directions {
        let mut row = *direction;
        for (other, axis) in &rows {
            let share = row[*axis] / other[*axis];
            (0..3).for_each(|k| row[k] -= share * other[k]);
            row[*axis] = 0.0;
        }
        let axis = (0..3).fold(0, |best, axis| if row[axis].abs() > row[best].abs() { axis } else { best });
        rows.push((row, axis));
    }
    // What is eliminated later must not stand in an equation before.
    for later in (1..rows.len()).rev() {
        let (row, axis) = rows[later];
        for (earlier, _) in &mut rows[..later] {
            let share = earlier[axis] / row[axis];
            (0..3).for_each(|k| earlier[k] -= share * row[k]);
            earlier[axis] = 0.0;
        }
    }
    for (row, first) in rows {
        let axes =
            std::iter::once(first).chain((0..3).filter(|axis| *axis != first && row[*axis].abs() > NO_COMPONENT));
        let terms: Vec<(usize, usize, f64)> = axes.map(|axis| (place, axis, row[axis])).collect();
        match terms[..] {
            [(node, axis, _)] => held.push((node, axis, 0.0)),
            _ => equations.push(terms),
        }
    }
    Ok(())
}
