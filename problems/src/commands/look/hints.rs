//! What is to be looked at before a solve, and what to do about it.

use crate::commands::numbers::number;
use crate::commands::scene_words;
use contact::body::mesh::smallest_extent;
use contact::equilibrium::{ContactProblem, Preview};
use contact::scene::{Held, Support};

/// Part of a force along a direction, and of the size of a body, that is rounding.
const ROUNDING: f64 = 1e-9;
/// Part of the unit normal along an axis from which a face keeps a body from moving along it.
const INTO: f64 = 0.2;

/// Sentences on all load cases; what holds in all of them stands once.
pub fn hints(cases: &[(String, ContactProblem)]) -> Vec<String> {
    let all: Vec<Vec<String>> = cases.iter().map(|(_, problem)| of_case(problem)).collect();
    let is_common = |words: &String| all.iter().all(|own| own.contains(words));
    let mut found: Vec<String> = all[0].iter().filter(|words| is_common(words)).cloned().collect();
    for ((name, _), own) in cases.iter().zip(&all) {
        found.extend(own.iter().filter(|words| !is_common(words)).map(|words| format!("case \"{name}\": {words}")));
    }
    found
}

fn of_case(problem: &ContactProblem) -> Vec<String> {
    let preview = problem.preview();
    let mut found = Vec::new();
    let size = problem.start_positions().iter().map(|nodes| smallest_extent(nodes)).fold(f64::INFINITY, f64::min);
    found.extend(of_gaps(&preview, ROUNDING * size));
    let loads = preview.bodies.iter().map(|body| body.load.iter().map(|part| part.abs()).sum::<f64>()).sum::<f64>();
    let has_loads = problem.scene.bodies.iter().any(|body| !body.loads.is_empty());
    let is_driven = problem.scene.bodies.iter().flat_map(|body| &body.supports).any(prescribes_motion);
    if !has_loads && !is_driven && preview.overlapping == 0 {
        found.push("no load acts and nothing overlaps, so that all pressures are 0: give a body loads".into());
    }
    for contact in problem.scene.contacts.iter().filter(|contact| contact.obstacle().is_some()) {
        let body = &preview.bodies[contact.slave.body];
        let normal = mean_normal(problem, contact.slave.body, &contact.slave.face);
        let along: f64 = body.load.iter().zip(normal).map(|(force, n)| force * n).sum();
        if body.free_translations == [true; 3] && along <= ROUNDING * loads && has_loads {
            let name = scene_words::body(&body.name);
            found.push(format!(
                "nothing holds the {name}, and its loads do not press {} on the obstacle: turn them, or add supports",
                contact.slave.face
            ));
        }
    }
    for (number, body) in preview.bodies.iter().enumerate() {
        let free = (0..3).filter(|axis| body.free_translations[*axis] && is_along_all_faces(problem, number, *axis));
        let free: Vec<&str> = free.map(|axis| ["x1", "x2", "x3"][axis]).collect();
        if !free.is_empty() {
            let (name, axes) = (scene_words::body(&body.name), free.join(", "));
            found.push(match problem.boundary.has_friction() {
                true => {
                    format!("friction alone holds the {name} along {axes}: add supports if the part has some there")
                }
                false => format!("nothing holds the {name} along {axes}: add supports or friction"),
            });
        }
    }
    found
}

/// Whether an axis runs along all faces of a body that touch, rather than into what they touch.
fn is_along_all_faces(problem: &ContactProblem, body: usize, axis: usize) -> bool {
    let sides =
        problem.scene.contacts.iter().flat_map(|contact| std::iter::once(&contact.slave).chain(contact.master_face()));
    sides.filter(|side| side.body == body).all(|side| {
        let normal = mean_normal(problem, body, &side.face);
        normal[axis].abs() < INTO * normal.iter().map(|part| part * part).sum::<f64>().sqrt()
    })
}

/// Whether a support moves its face.
fn prescribes_motion(support: &Support) -> bool {
    match support.held {
        Held::Components(values) => values.iter().flatten().any(|value| *value != 0.0),
        Held::Normal(value) => value != 0.0,
    }
}

/// What the gaps say; those up to a length are closed.
fn of_gaps(preview: &Preview, closed: f64) -> Option<String> {
    let [least, largest] = preview.gaps;
    match preview.overlapping {
        _ if least.abs() <= closed => None,
        0 => Some(format!(
            "the sides of contact begin {} mm apart: a load or a prescribed displacement must close them",
            number(least)
        )),
        count => Some(format!(
            "{count} of {} contact nodes overlap what they touch, by up to {} mm (gaps up to {} mm): move a body or the obstacle, unless it is \
             a press fit",
            preview.contact_nodes,
            number(-least),
            number(largest)
        )),
    }
}

/// The mean outward normal of a face, times its area.
fn mean_normal(problem: &ContactProblem, body: usize, face: &str) -> [f64; 3] {
    let (mesh, places) = (&problem.bodies[body].mesh, &problem.start_positions()[body]);
    let mut sum = [0.0; 3];
    for face in mesh.faces().get(face).into_iter().flatten() {
        let (nodes, count) = mesh.face_with_corners(*face);
        let x: Vec<[f64; 3]> = nodes[..count].iter().map(|&node| places[node as usize]).collect();
        for index in 0..count {
            let (a, b) = (x[index], x[(index + 1) % count]);
            (0..3).for_each(|i| sum[i] += 0.5 * (a[(i + 1) % 3] * b[(i + 2) % 3] - a[(i + 2) % 3] * b[(i + 1) % 3]));
        }
    }
    sum
}
