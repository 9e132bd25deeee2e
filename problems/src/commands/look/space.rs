//! The scene in three dimensions: a part per named face, with what acts on it and with its gaps; rigid obstacles.

use crate::commands::failure::Failure;
use crate::commands::look::case::LookedCase;
use crate::commands::look::faces::{contacts_of, held_on, loads_on};
use crate::commands::report::{ContactSurface, LIFT, Skin, apart, extent, faces_by_names};
use crate::commands::scene_words;
use contact::scene::Scene;
use figures::{Space, SpaceBody, SpaceField, SpaceShape, SpaceState, SpaceView, View, nice_below};

/// What acts on a face, by the numbers of their colours.
const CLASSES: [&str; 5] = ["free", "may touch", "loaded", "held", "held and loaded"];

/// A part of the view.
struct Part {
    name: String,
    /// Its body and the names of its facets; none of an obstacle.
    face: Option<(usize, Vec<String>)>,
    numbers: Vec<u32>,
    faces: Vec<Vec<usize>>,
    places: Vec<[f64; 3]>,
    apart: [f64; 3],
}

/// Named faces of all bodies and obstacles, in all load cases.
pub fn view(cases: &[LookedCase<'_>]) -> Result<SpaceView, Failure> {
    let surfaces = ContactSurface::all(cases[0].problem);
    let parts = parts(&cases[0], &surfaces);
    let state = |(number, case): (usize, &LookedCase<'_>)| SpaceState {
        shape: 0,
        case: number,
        displacements: parts.iter().map(|part| vec![[0.0; 3]; part.numbers.len()]).collect(),
        values: vec![
            parts.iter().map(|part| vec![class(&case.problem.scene, part); part.numbers.len()]).collect(),
            parts.iter().map(|part| gaps(case, part)).collect(),
        ],
    };
    let field = |name: &str, unit: &str, classes: &[&str]| SpaceField {
        name: name.into(),
        unit: unit.into(),
        classes: classes.iter().map(|name| (*name).to_owned()).collect(),
    };
    let space = Space {
        name: "look".into(),
        towards: View::towards(surfaces.first().map_or([0.0, 0.0, 1.0], |surface| surface.normal)).towards_viewer(),
        magnification: 0.0,
        fields: vec![field("what acts", "", &CLASSES), field("gap before loading", "mm", &[])],
        shapes: vec![SpaceShape {
            name: "shape".into(),
            places: parts.iter().map(|part| part.places.clone()).collect(),
        }],
        cases: cases.iter().map(|case| case.name.clone()).collect(),
        states: cases.iter().enumerate().map(state).collect(),
        bodies: parts
            .iter()
            .map(|part| SpaceBody {
                name: part.name.clone(),
                numbers: part.numbers.clone(),
                faces: part.faces.clone(),
                apart: part.apart,
            })
            .collect(),
    };
    space.view().map_err(Failure::computation)
}

/// The parts of the first load case.
fn parts(LookedCase { problem, positions, rows, .. }: &LookedCase<'_>, surfaces: &[ContactSurface]) -> Vec<Part> {
    let side = |axis: usize| {
        let extents = positions.iter().map(|nodes| extent(nodes.iter().copied(), axis));
        extents.map(|[least, most]| most - least).fold(0.0, f64::max)
    };
    let lift = nice_below(LIFT * (0..3).map(side).fold(0.0, f64::max));
    let ways = apart(&problem.scene, surfaces, |surface| surface.normal.map(|part| lift * part));
    let mut parts = Vec::new();
    for (number, body) in problem.bodies.iter().enumerate() {
        for (names, faces) in faces_by_names(&body.mesh) {
            let Skin { nodes, faces } = Skin::of(&body.mesh, &faces);
            let own = if names.is_empty() { "without a name".to_owned() } else { names.join(" and ") };
            let label = match problem.bodies.len() {
                1 => own,
                _ => format!("{}, {own}", scene_words::body(&body.name)),
            };
            let places = nodes.iter().map(|&node| positions[number][node as usize]).collect();
            parts.push(Part {
                name: label,
                face: Some((number, names)),
                numbers: nodes,
                faces,
                places,
                apart: ways[number],
            });
        }
    }
    for surface in surfaces.iter().filter(|surface| problem.scene.contacts[surface.contact].obstacle().is_some()) {
        let foot = |(&node, point): (&u32, &Option<usize>)| {
            let x = positions[surface.body][node as usize];
            point.map_or(x, |point| {
                let row = &rows.nodes[point];
                std::array::from_fn(|axis| x[axis] + row.gap * row.normal[axis])
            })
        };
        let way = surface.normal.map(|part| lift * part);
        let name = match surface.label.as_str() {
            "" => "rigid obstacle".to_owned(),
            label => format!("rigid obstacle of {label}"),
        };
        parts.push(Part {
            name,
            face: None,
            numbers: surface.nodes().to_vec(),
            faces: surface.faces(),
            places: surface.nodes().iter().zip(surface.points()).map(foot).collect(),
            apart: std::array::from_fn(|axis| ways[surface.body][axis] + way[axis]),
        });
    }
    parts
}

/// The number of what acts on a part; none for an obstacle.
fn class(scene: &Scene, part: &Part) -> f64 {
    let Some((body, names)) = &part.face else { return f64::NAN };
    let touches = names.iter().any(|face| contacts_of(scene, *body, face).next().is_some());
    let held = names.iter().any(|face| held_on(&scene.bodies[*body], face).next().is_some());
    let loaded = names.iter().any(|face| loads_on(&scene.bodies[*body], face).next().is_some());
    match (touches, held, loaded) {
        (true, ..) => 1.0,
        (_, true, true) => 4.0,
        (_, true, false) => 3.0,
        (_, false, true) => 2.0,
        _ => 0.0,
    }
}

/// Gaps at the contact nodes of a part; NaN elsewhere.
fn gaps(LookedCase { problem, rows, .. }: &LookedCase<'_>, part: &Part) -> Vec<f64> {
    let mut found = vec![f64::NAN; part.numbers.len()];
    let Some((body, names)) = &part.face else { return found };
    let points = problem.boundary.contact_points().iter().zip(&rows.nodes);
    for (point, row) in points.filter(|(point, row)| point.body == *body && row.is_covered) {
        let is_own = names.contains(&problem.scene.contacts[point.contact].slave.face);
        if let (true, Ok(place)) = (is_own, part.numbers.binary_search(&point.node)) {
            found[place] = row.gap;
        }
    }
    found
}
