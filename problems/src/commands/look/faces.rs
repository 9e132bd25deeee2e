//! Bodies and their faces with what acts on them.

use crate::commands::facts::Fact;
use crate::commands::failure::Failure;
use crate::commands::numbers::{exact, number};
use crate::commands::report::faces_by_name;
use crate::commands::scene_words;
use contact::body::mesh::bounding_box;
use contact::equilibrium::{ContactProblem, Positions};
use contact::scene::{LoadKind, Scene};
use serde_json::json;

/// What acts on a face.
#[derive(Debug, Clone, Copy, Default)]
pub struct Acts {
    pub touches: bool,
    pub held: bool,
    pub loaded: bool,
}

impl Acts {
    /// What acts on a named face of a body in a scene.
    pub fn of(scene: &Scene, body: usize, face: &str) -> Self {
        let sides =
            scene.contacts.iter().flat_map(|contact| std::iter::once(&contact.slave).chain(contact.master_face()));
        let own = &scene.bodies[body];
        Self {
            touches: sides.into_iter().any(|side| side.body == body && side.face == face),
            held: own.supports.iter().any(|support| support.face == face && scene_words::held(support).is_some()),
            loaded: own
                .loads
                .iter()
                .any(|load| load.place.as_deref() == Some(face) && !matches!(load.kind, LoadKind::BodyForce(_))),
        }
    }
}

/// A line for every body and for every face, and the list `bodies` in JSON.
pub fn face_facts(cases: &[(String, ContactProblem)], positions: &Positions) -> Result<Vec<Fact>, Failure> {
    let (problem, mut facts, mut list) = (&cases[0].1, Vec::new(), Vec::new());
    for (index, body) in problem.bodies.iter().enumerate() {
        let (mesh, places) = (&body.mesh, &positions[index]);
        let [low, high] = bounding_box(places);
        let side = |axis: usize| format!("{} … {}", number(low[axis]), number(high[axis]));
        let name = scene_words::body(&body.name);
        let (nodes, cells) = (mesh.node_count(), mesh.cell_count());
        let [x1, x2, x3] = [0, 1, 2].map(side);
        let words = format!("{nodes} nodes, {cells} cells, x1 = {x1}, x2 = {x2}, x3 = {x3} mm");
        facts.push(Fact::new("", &name, words, ""));
        let mut faces = Vec::new();
        for (face, own) in faces_by_name(mesh).iter().filter(|(_, own)| !own.is_empty()) {
            let area: f64 = own.iter().map(|face| mesh.face_area(*face, places)).sum();
            let roles = roles(cases, index, face, area);
            let shown = if roles.is_empty() { String::new() } else { format!("; {}", roles.join("; ")) };
            let label = format!("  {}", if face.is_empty() { "without a name" } else { face });
            let words = format!("{} facets, {} mm²{shown}", own.len(), number(area));
            facts.push(Fact::new("", &label, words, ""));
            faces.push(json!({ "name": face, "facets": own.len(), "area": area, "roles": roles }));
        }
        let volumes = mesh.volumes();
        list.push(json!({ "name": body.name, "nodes": nodes, "cells": cells, "box": [low, high], "volumes": volumes, "faces": faces }));
    }
    facts.push(Fact::json("bodies", &list)?);
    Ok(facts)
}

/// What acts on a face in words; what is not the same in all load cases, with the case.
fn roles(cases: &[(String, ContactProblem)], body: usize, face: &str, area: f64) -> Vec<String> {
    let of_case = |(_, problem): &(String, ContactProblem)| -> Vec<String> {
        let scene = &problem.scene;
        let contacts = scene.contacts.iter().enumerate().filter(|(_, contact)| {
            let mut sides = std::iter::once(&contact.slave).chain(contact.master_face());
            sides.any(|side| side.body == body && side.face == face)
        });
        let words = |(index, contact): (usize, &contact::scene::ContactScene)| match contact.is_tied() {
            true => format!("contact: {}", scene_words::sides(scene, index)),
            false => format!("contact: {}, friction {}", scene_words::sides(scene, index), exact(contact.friction)),
        };
        let own = &scene.bodies[body];
        let held = own.supports.iter().filter(|support| support.face == face).filter_map(scene_words::held);
        let loads = own
            .loads
            .iter()
            .filter(|load| load.place.as_deref() == Some(face) && !matches!(load.kind, LoadKind::BodyForce(_)));
        let loads = loads.map(|load| format!("load {}", scene_words::load(load, || area)));
        contacts.map(words).chain(held.map(|held| format!("held: {held}"))).chain(loads).collect()
    };
    let all: Vec<Vec<String>> = cases.iter().map(of_case).collect();
    let is_common = |words: &String| all.iter().all(|own| own.contains(words));
    let mut found: Vec<String> = all[0].iter().filter(|words| is_common(words)).cloned().collect();
    for ((name, _), own) in cases.iter().zip(&all) {
        found.extend(own.iter().filter(|words| !is_common(words)).map(|words| format!("case \"{name}\": {words}")));
    }
    found
}
