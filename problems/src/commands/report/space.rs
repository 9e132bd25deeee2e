//! Solved shapes in three dimensions, for the reader to turn: skins of the bodies with fields at their nodes.

use crate::commands::failure::Failure;
use crate::commands::report::bodies::{MAX_LIFT, apart, magnification};
use crate::commands::report::contact_surface::ContactSurface;
use crate::commands::report::gallery::ShownShape;
use crate::commands::report::skin::{Skin, extent};
use crate::commands::scene_words;
use crate::commands::solved_shape::ContactObjective;
use crate::commands::vectors::{dot, minus};
use contact::equilibrium::{ContactProblem, ContactStatus};
use contact::fields::{BodyFields, Fields};
use figures::{Space, SpaceBody, SpaceField, SpaceShape, SpaceState, SpaceView, View, nice_below};
use std::collections::HashMap;

/// Shapes in all load cases, the cases of a shape one after the other, with what the shapes are called. None where the
/// fields of a state are not known.
pub fn space(
    objective: &ContactObjective,
    labels: &[&str],
    shapes: &[ShownShape<'_>],
) -> Result<Option<SpaceView>, Failure> {
    let problem = objective.solver().problem();
    let states: Vec<(&ShownShape<'_>, &Fields)> =
        shapes.iter().filter_map(|shape| Some((shape, shape.fields.as_ref()?))).collect();
    let cases = shapes.len() / labels.len().max(1);
    let first = match states.first() {
        Some((_, fields)) if states.len() == labels.len() * cases => &fields.bodies,
        _ => return Ok(None),
    };
    let skins: Vec<Skin> = first.iter().map(|body| Skin::new(&body.mesh)).collect();
    let mut fields = space_fields(problem);
    let several = labels.len() > 1;
    if several {
        fields.push(SpaceField { name: "change of shape".into(), unit: "mm".into(), classes: Vec::new() });
    }
    let surfaces = ContactSurface::all(problem);
    let state = |(index, (shape, fields)): (usize, &(&ShownShape<'_>, &Fields))| {
        let pairs = || fields.bodies.iter().zip(&skins);
        let displacement = |(body, skin): (&BodyFields, &Skin)| at(skin, &body.displacement);
        let stress = |(body, skin): (&BodyFields, &Skin)| at(skin, &body.nodal_von_mises);
        let [pressure, status] = contact_values(objective, shape, fields, &skins);
        // How far every node lies from its place at the first shape.
        let change = |((body, skin), first): ((&BodyFields, &Skin), &BodyFields)| {
            let moved = |node: &u32| length(minus(body.positions[*node as usize], first.positions[*node as usize]));
            skin.nodes.iter().map(moved).collect::<Vec<f64>>()
        };
        let changes = several.then(|| pairs().zip(first).map(change).collect());
        SpaceState {
            shape: index / cases,
            case: index % cases,
            displacements: pairs().map(displacement).collect(),
            values: [pressure, pairs().map(stress).collect(), status].into_iter().chain(changes).collect(),
        }
    };
    let places = |fields: &Fields| -> Vec<Vec<[f64; 3]>> {
        fields.bodies.iter().zip(&skins).map(|(body, skin)| at(skin, &body.positions)).collect()
    };
    let space = Space {
        name: "space".into(),
        towards: View::towards(surfaces.first().map_or([0.0, 0.0, 1.0], |surface| surface.normal)).towards_viewer(),
        magnification: magnification(|| states.iter().flat_map(|(_, fields)| &fields.bodies)),
        fields,
        bodies: bodies(problem, &surfaces, first, &skins),
        shapes: labels
            .iter()
            .zip(states.chunks(cases))
            .map(|(label, states)| SpaceShape { name: (*label).to_owned(), places: places(states[0].1) })
            .collect(),
        cases: (0..cases).map(|case| objective.cases().name(case).to_owned()).collect(),
        states: states.iter().enumerate().map(state).collect(),
    };
    Ok(Some(space.view().map_err(Failure::computation)?))
}

/// Values at the nodes of a skin.
fn at<T: Copy>(skin: &Skin, values: &[T]) -> Vec<T> {
    skin.nodes.iter().map(|&node| values[node as usize]).collect()
}

fn space_fields(problem: &ContactProblem) -> Vec<SpaceField> {
    let field = |name: &str, unit: &str, classes: &[&str]| SpaceField {
        name: name.into(),
        unit: unit.into(),
        classes: classes.iter().map(|name| (*name).to_owned()).collect(),
    };
    // Without friction, nothing says whether a closed node slides.
    let classes: &[&str] =
        if problem.boundary.has_friction() { &["open", "stick", "slip"] } else { &["open", "closed"] };
    let stress = "von Mises stress, nodal mean";
    vec![field("contact pressure", "MPa", &[]), field(stress, "MPa", &[]), field("contact status", "", classes)]
}

fn bodies(
    problem: &ContactProblem,
    surfaces: &[ContactSurface],
    fields: &[BodyFields],
    skins: &[Skin],
) -> Vec<SpaceBody> {
    let side = |axis: usize| {
        let extents = fields.iter().map(|body| extent(body.positions.iter().copied(), axis));
        extents.map(|[least, most]| most - least).fold(0.0, f64::max)
    };
    let lift = nice_below(MAX_LIFT * (0..3).map(side).fold(0.0, f64::max));
    let ways = apart(&problem.scene, surfaces, |surface| surface.normal.map(|part| lift * part));
    let body = |((body, skin), apart): ((&contact::body::Body, &Skin), [f64; 3])| SpaceBody {
        name: scene_words::body(&body.name),
        numbers: skin.nodes.clone(),
        faces: skin.faces.clone(),
        apart,
    };
    problem.bodies.iter().zip(skins).zip(ways).map(body).collect()
}

/// Pressures and statuses by bodies and nodes of their skins; NaN at nodes that are no contact nodes. Of a node of
/// several contacts, those where its pressure is largest.
fn contact_values(
    objective: &ContactObjective,
    shape: &ShownShape<'_>,
    fields: &Fields,
    skins: &[Skin],
) -> [Vec<Vec<f64>>; 2] {
    let friction = objective.solver().problem().boundary.has_friction();
    let class = |status: &ContactStatus| match status {
        ContactStatus::Open => 0.0,
        ContactStatus::Slip if friction => 2.0,
        ContactStatus::Stick | ContactStatus::Slip => 1.0,
    };
    let contact = &fields.contact;
    let nodes = contact.bodies.iter().zip(&contact.nodes);
    let mut found: HashMap<(usize, u32), [f64; 2]> = HashMap::new();
    for ((&body, &node), (pressure, status)) in
        nodes.zip(objective.pressures(shape.state()).iter().zip(&contact.status))
    {
        let own = found.entry((body, node)).or_insert([f64::NEG_INFINITY; 2]);
        if *pressure > own[0] {
            *own = [*pressure, class(status)];
        }
    }
    let values = |part: usize| {
        let of_node = |body: usize, node: u32| found.get(&(body, node)).map_or(f64::NAN, |own| own[part]);
        let of_body = |(body, skin): (usize, &Skin)| skin.nodes.iter().map(|&node| of_node(body, node)).collect();
        skins.iter().enumerate().map(of_body).collect()
    };
    [values(0), values(1)]
}

fn length(vector: [f64; 3]) -> f64 {
    dot(vector, vector).sqrt()
}
