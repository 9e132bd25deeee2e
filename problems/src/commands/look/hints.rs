//! What is to be looked at before a solve, and what to do about it.

use crate::commands::look::case::LookedCase;
use crate::commands::numbers::number;
use crate::commands::scene_words;
use crate::commands::vectors::{dot, sum};
use contact::body::mesh::smallest_extent;
use contact::equilibrium::{ContactProblem, Positions, Preview, facet_pressures_before_loading};
use contact::scene::{BodyFace, ContactScene, Held, Support};

/// Part of a force along a direction, and of the size of a body, that is rounding.
const ROUNDING: f64 = 1e-9;
/// Part of the unit normal along an axis from which a face keeps a body from moving along it.
const INTO: f64 = 0.2;

/// What is to be looked at in a load case, in sentences.
pub fn hints(LookedCase { problem, positions, preview, .. }: &LookedCase<'_>) -> Vec<String> {
    let mut found = Vec::new();
    let size = positions.iter().map(|nodes| smallest_extent(nodes)).fold(f64::INFINITY, f64::min);
    found.extend(of_gaps(preview, ROUNDING * size));
    let noise = facet_pressures_before_loading(problem).into_iter().filter(|own| !own.is_curved && own.noise > 0.0);
    found.extend(noise.map(|own| {
        let (face, noise) = (&problem.scene.contacts[own.contact].slave.face, number(own.noise));
        format!(
            "flat facets make pressures on \"{face}\" uncertain by up to {noise} MPa: leave out geometry = \"facets\""
        )
    }));
    let loads = preview.bodies.iter().map(|body| body.load.iter().map(|part| part.abs()).sum::<f64>()).sum::<f64>();
    let has_loads = problem.scene.bodies.iter().any(|body| !body.loads.is_empty());
    let is_driven = problem.scene.bodies.iter().flat_map(|body| &body.supports).any(prescribes_motion);
    if !has_loads && !is_driven && preview.overlapping == 0 {
        found.push("no load acts and nothing overlaps, so that all pressures are 0: give a body loads".into());
    }
    for contact in problem.scene.contacts.iter().filter(|contact| contact.obstacle().is_some()) {
        let body = &preview.bodies[contact.slave.body];
        let normal = mean_normal(problem, positions, &contact.slave);
        if body.free_translations == [true; 3] && dot(body.load, normal) <= ROUNDING * loads && has_loads {
            let name = scene_words::body(&body.name);
            found.push(format!(
                "nothing holds the {name}, and its loads do not press {} on the obstacle: turn them, or add supports",
                contact.slave.face
            ));
        }
    }
    for (number, body) in preview.bodies.iter().enumerate() {
        if pulls_off(
            problem,
            positions,
            number,
            std::array::from_fn(|axis| if body.free_translations[axis] { body.load[axis] } else { 0.0 }),
        ) {
            let name = scene_words::body(&body.name);
            found.push(format!("the loads of the {name} pull it off what it touches: turn them if they are to press"));
        }
        let free = (0..3)
            .filter(|axis| body.free_translations[*axis] && is_along_all_faces(problem, positions, [number, *axis]));
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

/// Whether a force on a body, without what supports carry, points away from what it touches, on all faces that touch.
fn pulls_off(problem: &ContactProblem, positions: &Positions, body: usize, force: [f64; 3]) -> bool {
    let sides = problem.scene.contacts.iter().filter(|contact| !contact.is_tied()).flat_map(ContactScene::faces);
    let mut sides = sides.filter(|side| side.body == body).peekable();
    let size = dot(force, force).sqrt();
    let away = -INTO * size;
    // The resultant of a moment is rounding.
    size > ROUNDING * problem.load()
        && sides.peek().is_some()
        && sides.all(|side| dot(force, mean_normal(problem, positions, side)) < away)
}

/// Whether an axis runs along all faces of a body that touch, rather than into what they touch.
fn is_along_all_faces(problem: &ContactProblem, positions: &Positions, [body, axis]: [usize; 2]) -> bool {
    let sides = problem.scene.contacts.iter().flat_map(ContactScene::faces);
    let mut normals = sides.filter(|side| side.body == body).map(|side| mean_normal(problem, positions, side));
    normals.all(|normal| normal[axis].abs() < INTO)
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

/// The unit mean outward normal of a face; 0 where normals cancel.
fn mean_normal(problem: &ContactProblem, positions: &Positions, side: &BodyFace) -> [f64; 3] {
    let mesh = &problem.bodies[side.body].mesh;
    let faces = mesh.faces().get(&side.face).into_iter().flatten();
    let all = faces.map(|face| mesh.face_vector(*face, &positions[side.body])).fold([0.0; 3], sum);
    let length = dot(all, all).sqrt();
    all.map(|part| if length > 0.0 { part / length } else { 0.0 })
}
