//! Scenes in words: bodies with their meshes, contacts with their sides.

use crate::commands::facts::Fact;
use crate::commands::failure::Failure;
use crate::commands::numbers::exact;
use contact::scene::{BodyFace, BodyScene, Geometry, Held, Load, LoadKind, Master, Scene, Support};
use figures::number;
use serde_json::json;

/// What a body is called in a sentence: "lower body", or "body" where there is only one.
pub fn body(name: &str) -> String {
    if name == "body" { name.to_owned() } else { format!("{name} body") }
}

/// What names of files call a body, different for all bodies: "lower".
pub fn stem(scene: &Scene, body: usize) -> String {
    let plain = |name: &str| name.replace(|c: char| !(c.is_ascii_alphanumeric() || c == '-' || c == '_'), "_");
    let mut stems: Vec<String> = Vec::new();
    for own in &scene.bodies[..=body] {
        let mut stem = plain(&own.name);
        while stems.contains(&stem) {
            stem.push('_');
        }
        stems.push(stem);
    }
    stems.pop().unwrap_or_default()
}

/// "12×12×12 bricks", or "1881 cells"; of bodies that differ, one after the other.
pub fn mesh(scene: &Scene) -> String {
    distinct(scene.bodies.iter().map(mesh_of)).join(", ")
}

/// The friction coefficients of the contacts that may slide, in their order: "0.3", or "0.3, 0".
pub fn friction(scene: &Scene) -> String {
    let contacts = scene.contacts.iter().filter(|contact| !contact.is_tied());
    match distinct(contacts.map(|contact| exact(contact.friction))) {
        found if found.is_empty() => exact(0.0),
        found => found.join(", "),
    }
}

/// The sides of a contact: "top of lower on bottom of upper", or "top of lower on the obstacle".
pub fn sides(scene: &Scene, contact: usize) -> String {
    let contact = &scene.contacts[contact];
    let face = |face: &BodyFace| format!("{} of {}", face.face, scene.bodies[face.body].name);
    let (slave, word) = (face(&contact.slave), if contact.is_tied() { "glued to" } else { "on" });
    match &contact.master {
        Master::Obstacle(_) => format!("{slave} {word} the obstacle"),
        Master::Body(master) => format!("{slave} {word} {}", face(master)),
    }
}

/// What pictures and tables say of a contact: nothing where there is only one.
pub fn contact_label(scene: &Scene, contact: usize) -> String {
    if scene.contacts.len() == 1 {
        String::new()
    } else {
        format!("contact {}: {}", contact + 1, sides(scene, contact))
    }
}

/// "1 body", "2 bodies"
pub fn counted(count: usize, [one, several]: [&str; 2]) -> String {
    format!("{count} {}", if count == 1 { one } else { several })
}

/// The bodies and the contacts of a scene: their numbers, then a line for each of them, and both as lists in JSON.
///
/// # Errors
/// [`Failure::Computation`] for a value that has no JSON.
pub fn facts(scene: &Scene) -> Result<Vec<Fact>, Failure> {
    let bodies = counted(scene.bodies.len(), ["body", "bodies"]);
    let words = format!("{bodies}, {}", counted(scene.contacts.len(), ["contact", "contacts"]));
    let mut facts = vec![Fact::new("", "scene", words, "")];
    for body in &scene.bodies {
        let shape = if body.shape.is_some() { format!(", {} controls", body.control_count()) } else { String::new() };
        let words = format!("{}, {}{shape}", mesh_of(body), pieces_of(body).trim_end_matches(" each"));
        facts.push(Fact::new("", &format!("body {}", body.name), words, ""));
    }
    for (index, contact) in scene.contacts.iter().enumerate() {
        let friction =
            if contact.is_tied() { String::new() } else { format!(", friction {}", exact(contact.friction)) };
        let words = sides(scene, index) + &friction;
        facts.push(Fact::new("", &format!("contact {}", index + 1), words, ""));
    }
    let bodies: Vec<_> = scene
        .bodies
        .iter()
        .map(|body| json!({ "name": body.name, "mesh": mesh_of(body), "controls": body.control_count() }))
        .collect();
    let side = |face: &BodyFace| json!({ "body": scene.bodies[face.body].name, "face": face.face });
    let contacts: Vec<_> = scene
        .contacts
        .iter()
        .map(|contact| {
            let master = contact.master_face().map_or_else(|| json!("obstacle"), side);
            let (friction, tied) = (contact.friction, contact.is_tied());
            json!({ "slave": side(&contact.slave), "master": master, "friction": friction, "tied": tied })
        })
        .collect();
    facts.extend([Fact::json("bodies", &bodies)?, Fact::json("contacts", &contacts)?]);
    Ok(facts)
}

/// What a support holds: "u₁ = u₂ = 0"; none for one that holds nothing.
pub fn held(support: &Support) -> Option<String> {
    // Components of one value share it.
    let mut values: Vec<(String, f64)> = Vec::new();
    match support.held {
        Held::Components(held) => {
            for (held, name) in held.iter().zip(["u₁", "u₂", "u₃"]) {
                match (held, values.last_mut()) {
                    (Some(value), Some((names, last))) if value == last => *names += &format!(" = {name}"),
                    (Some(value), _) => values.push((name.into(), *value)),
                    (None, _) => {}
                }
            }
        }
        Held::Normal(value) => values.push(("u along the normal".into(), value)),
    }
    let held: Vec<String> = values.iter().map(|(names, value)| format!("{names} = {}", number(*value))).collect();
    (!held.is_empty()).then(|| held.join(", "))
}

/// A load on a face in words; `area`: that of the face, mm².
pub fn load(load: &Load, area: impl FnOnce() -> f64) -> String {
    match &load.kind {
        LoadKind::Traction(traction) => {
            let size = traction.iter().map(|part| part * part).sum::<f64>().sqrt();
            format!("{} MPa, in all {} N", vector(*traction), number(size * area()))
        }
        LoadKind::Pressure(pressure) => format!("pressure {} MPa", number(*pressure)),
        LoadKind::Resultant { force, moment, point } => {
            let moment = match moment {
                [0.0, 0.0, 0.0] => String::new(),
                moment => format!(" with moment {} N mm", vector(*moment)),
            };
            let point = point.map_or_else(String::new, |point| format!(" at {} mm", vector(point)));
            format!("{} N{moment}{point}", vector(*force))
        }
        LoadKind::Formula(texts) => format!("traction ({}) MPa", texts.join(", ")),
        LoadKind::BodyForce(force) => format!("{} N/mm³", vector(*force)),
    }
}

fn vector(vector: [f64; 3]) -> String {
    format!("({})", vector.map(number).join(", "))
}

fn mesh_of(body: &BodyScene) -> String {
    match &body.geometry {
        Geometry::Block(block) => format!("{} bricks", joined(block.bricks)),
        Geometry::Mesh(geometry) => format!("{} cells", geometry.mesh.cell_count()),
    }
}

fn pieces_of(body: &BodyScene) -> String {
    match &body.geometry {
        Geometry::Block(block) => format!("{} subdomains each", joined(block.subdomains)),
        Geometry::Mesh(geometry) => format!("about {} pieces", geometry.piece_count()),
    }
}

/// Texts in their order, each once.
fn distinct(texts: impl Iterator<Item = String>) -> Vec<String> {
    texts.fold(Vec::new(), |mut found, text| {
        if !found.contains(&text) {
            found.push(text);
        }
        found
    })
}

fn joined(counts: [usize; 3]) -> String {
    counts.map(|count| count.to_string()).join("×")
}
