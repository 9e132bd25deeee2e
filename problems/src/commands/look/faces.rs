//! Bodies and their faces with what acts on them.

use crate::commands::facts::Fact;
use crate::commands::failure::Failure;
use crate::commands::look::case::{LookedCase, by_case};
use crate::commands::numbers::{exact, number};
use crate::commands::report::faces_by_names;
use crate::commands::scene_words;
use contact::body::elasticity::Material;
use contact::body::mesh::bounding_box;
use contact::scene::{BodyScene, ContactScene, Load, LoadKind, Scene};
use serde_json::json;

/// The contacts of a face, with their places in the scene.
pub fn contacts_of<'s>(scene: &'s Scene, body: usize, face: &str) -> impl Iterator<Item = (usize, &'s ContactScene)> {
    let contacts = scene.contacts.iter().enumerate();
    contacts.filter(move |(_, contact)| contact.faces().any(|side| side.body == body && side.face == face))
}

/// What supports hold on a face, in words.
pub fn held_on(body: &BodyScene, face: &str) -> impl Iterator<Item = String> {
    body.supports.iter().filter(move |support| support.face == face).filter_map(scene_words::held)
}

/// The loads on a face.
pub fn loads_on<'s>(body: &'s BodyScene, face: &str) -> impl Iterator<Item = &'s Load> {
    let is_own = move |load: &&Load| load.place.as_deref() == Some(face);
    body.loads.iter().filter(is_own).filter(|load| !matches!(load.kind, LoadKind::BodyForce(_)))
}

/// A line for every body and for every face, and the list `bodies` in JSON.
pub fn face_facts(cases: &[LookedCase<'_>]) -> Result<Vec<Fact>, Failure> {
    let (first, mut facts, mut list) = (&cases[0], Vec::new(), Vec::new());
    for (index, body) in first.problem.bodies.iter().enumerate() {
        let (mesh, places) = (&body.mesh, &first.positions[index]);
        let [low, high] = bounding_box(places);
        let side = |axis: usize| format!("{} … {}", number(low[axis]), number(high[axis]));
        let name = scene_words::body(&body.name);
        let (nodes, cells) = (mesh.node_count(), mesh.cell_count());
        let [x1, x2, x3] = [0, 1, 2].map(side);
        let of_body = of_volumes(&first.problem.scene.bodies[index]).join("; ");
        let words = format!("{nodes} nodes, {cells} cells, x1 = {x1}, x2 = {x2}, x3 = {x3} mm; {of_body}");
        facts.push(Fact::new("", &name, words, ""));
        let mut faces = Vec::new();
        // Names may share facets: every one stands with all that it has.
        let named = mesh.faces().iter().map(|(name, own)| (name.clone(), own.clone()));
        let nameless = faces_by_names(mesh).into_iter().filter(|(names, _)| names.is_empty());
        for (face, own) in named.chain(nameless.map(|(_, own)| (String::new(), own))) {
            let area: f64 = own.iter().map(|face| mesh.face_area(*face, places)).sum();
            let roles = by_case(cases, |case| roles(&case.problem.scene, index, &face, area));
            let shown = if roles.is_empty() { String::new() } else { format!("; {}", roles.join("; ")) };
            let label = format!("  {}", if face.is_empty() { "without a name" } else { &face });
            let words = format!("{} facets, {} mm²{shown}", own.len(), number(area));
            facts.push(Fact::new("", &label, words, ""));
            faces.push(json!({ "name": face, "facets": own.len(), "area": area, "roles": roles }));
        }
        list.push(json!({
            "name": body.name, "nodes": nodes, "cells": cells, "box": [low, high], "volumes": mesh.volumes(),
            "faces": faces, "names_without_elements": mesh.empty_names(),
        }));
    }
    facts.push(Fact::json("bodies", &list)?);
    Ok(facts)
}

/// Bodies with their materials, faces with their loads, contacts, faces that are held: a row each.
pub fn acting(cases: &[LookedCase<'_>]) -> Vec<Vec<String>> {
    let first = &cases[0];
    let scene = &first.problem.scene;
    let materials = |(index, body): (usize, &BodyScene)| {
        let words = by_case(cases, |case| of_volumes(&case.problem.scene.bodies[index]));
        vec![scene_words::body(&body.name), words.join("; ")]
    };
    let mut rows: Vec<Vec<String>> = scene.bodies.iter().enumerate().map(materials).collect();
    let (mut loads, mut supports) = (Vec::new(), Vec::new());
    for (index, body) in first.problem.bodies.iter().enumerate() {
        let of_body = if scene.bodies.len() > 1 { format!(" of {}", body.name) } else { String::new() };
        for (face, own) in body.mesh.faces() {
            let area: f64 = own.iter().map(|face| body.mesh.face_area(*face, &first.positions[index])).sum();
            let found = [load_words, held_words].map(|words: Words| {
                by_case(cases, |case| words(&case.problem.scene.bodies[index], face, area)).join("; ")
            });
            for (words, rows) in found.into_iter().zip([&mut loads, &mut supports]) {
                rows.extend((!words.is_empty()).then(|| vec![format!("{face}{of_body}"), words]));
            }
        }
    }
    let contacts = (0..scene.contacts.len()).map(|index| vec!["contact".to_owned(), contact_words(scene, index)]);
    rows.extend(loads.into_iter().chain(contacts));
    rows.extend(supports);
    rows
}

/// What is said of a face of a body, with its area.
type Words = fn(&BodyScene, &str, f64) -> Vec<String>;

/// Elastic constants and body forces in words.
fn of_volumes(body: &BodyScene) -> Vec<String> {
    let words = |place: &str, material: &Material| {
        let [modulus, ratio] = [material.young_modulus(), material.poisson_ratio()].map(number);
        format!("{place}E = {modulus} MPa, ν = {ratio}")
    };
    let forces = body.loads.iter().filter_map(|load| {
        let force = matches!(load.kind, LoadKind::BodyForce(_)).then(|| scene_words::load(load, || 0.0))?;
        Some(format!("body force {force} in {}", load.place.as_deref().unwrap_or("the whole body")))
    });
    let volumes = body.materials.iter().map(|(volume, material)| words(&format!("{volume}: "), material));
    std::iter::once(words("", &body.material)).chain(volumes).chain(forces).collect()
}

/// What acts on a face in words.
fn roles(scene: &Scene, body: usize, face: &str, area: f64) -> Vec<String> {
    let contacts = contacts_of(scene, body, face).map(|(index, _)| format!("contact: {}", contact_words(scene, index)));
    let own = &scene.bodies[body];
    contacts.chain(held_words(own, face, area)).chain(load_words(own, face, area)).collect()
}

/// The sides of a contact, and its friction.
fn contact_words(scene: &Scene, index: usize) -> String {
    let (contact, sides) = (&scene.contacts[index], scene_words::sides(scene, index));
    if contact.is_tied() { sides } else { format!("{sides}, friction {}", exact(contact.friction)) }
}

fn held_words(body: &BodyScene, face: &str, _area: f64) -> Vec<String> {
    held_on(body, face).map(|held| format!("held: {held}")).collect()
}

fn load_words(body: &BodyScene, face: &str, area: f64) -> Vec<String> {
    loads_on(body, face).map(|load| format!("load {}", scene_words::load(load, || area))).collect()
}
