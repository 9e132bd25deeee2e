//! Random changes of meshes: what each of them does to the meaning, to the state and to what is told.

mod changes;
mod model;
mod refusals;
mod writer;

use self::model::Model;
use self::writer::{Form, write};
use contact::contact_objective::ContactObjective;
use contact::scene::Geometry;
use contact::solvers::{Processes, Wanted};
use nonsmooth::{Accuracy, NonsmoothObjective, StateSolver, Vector};
use scene_file::{Case, SceneFile};
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;
use std::sync::atomic::{AtomicUsize, Ordering};
use testset::kit::Random;

/// Loads of all kinds of places, supports, a volume of other material, a lattice that holds nodes.
const SCENE: &str = r#"
name = "changes"
solver = { kind = "direct" }
friction = 0.0

[[body]]
mesh = "changed.msh"
material = { young_modulus = 2e5, poisson_ratio = 0.3 }
materials = [{ volume = "upper", young_modulus = 7e4, poisson_ratio = 0.25 }]
supports = [{ face = "left", held = ["u1"] }, { face = "front", held = ["u2"] }]
loads = [
  { face = "top", pressure = 100.0 },
  { face = "right", traction = [3.0, 2.0, -5.0] },
  { volume = "upper", body_force = [0.0, 0.0, -1.0] },
]

[body.lattice]
control_points = [2, 2, 2]
directions = [3]
fixed = ["rim", "between"]
displacement = [-0.1, 0.1]

[[contact]]
slave = { face = "bottom" }

[contact.obstacle]
form = "tilted-plane"
point = [0.0, 0.0, 0.0]
normal = [0.1, 0.05, -1.0]
"#;

/// A place by the bits of its coordinates.
type Spot = [u64; 3];

/// What a mesh means: cells and whether they are of the upper volume, faces and sets of nodes that the scene names, by
/// the places of their nodes.
#[derive(Debug, PartialEq)]
struct Meaning {
    cells: BTreeSet<(Vec<Spot>, bool)>,
    named: Vec<BTreeSet<Vec<Spot>>>,
    count: usize,
}

fn meaning(case: &Case) -> Meaning {
    let Geometry::Mesh(geometry) = &case.scene.bodies[0].geometry else { panic!("a mesh") };
    let mesh = &*geometry.mesh;
    let spots = |nodes: &mut dyn Iterator<Item = u32>| {
        // −0 and 0 are one place.
        let mut spots: Vec<Spot> = nodes.map(|node| mesh.nodes()[node as usize].map(|x| (x + 0.0).to_bits())).collect();
        spots.sort_unstable();
        spots
    };
    let upper = |cell: usize| mesh.volumes()[mesh.volume_of(cell)] == "upper";
    let cells = mesh.cells().enumerate().map(|(cell, of)| (spots(&mut of.nodes.iter().copied()), upper(cell)));
    let mut count = mesh.node_count() + mesh.cell_count();
    let named = refusals::USED.iter().map(|(_, name)| {
        let faces = mesh.faces().get(*name).into_iter().flatten();
        let nodes = mesh.node_sets().get(*name).into_iter().flatten();
        count += faces.clone().count() + nodes.clone().count();
        let faces = faces.map(|face| spots(&mut mesh.face_nodes(*face)));
        faces.chain(nodes.map(|node| spots(&mut std::iter::once(*node)))).collect()
    });
    Meaning { named: named.collect(), cells: cells.collect(), count }
}

fn solvable(model: &Model, form: Form) -> Result<(Case, ContactObjective), String> {
    let scene = SceneFile::parse(SCENE, "changes").unwrap();
    let mesh = exchange::gmsh::read(&write(model, form)).map_err(|error| error.to_string())?;
    let case = Case::with_mesh(&scene, Path::new(""), &mesh).map_err(|error| error.to_string())?;
    // What a scene names is looked up where its problem is made.
    let objective = case.prepared(Wanted::States, &Processes::alone()).map_err(|error| error.to_string())?;
    Ok((case, objective))
}

/// Θ, its gradient and the contact forces at a shape, as numbers of size one.
fn state(objective: &ContactObjective) -> Vec<f64> {
    let controls = Vector::from_fn(objective.dimension(), |index, _| 0.01 * (index as f64).sin());
    let states = objective.cases().solve(&controls, None, Accuracy::TIGHTEST).unwrap();
    let found = objective.differentiate(&controls, &states).unwrap();
    let mut forces = states[0].forces.normal.clone();
    forces.sort_by(f64::total_cmp);
    let (slope, total) = (found.subgradient.norm(), forces.iter().sum::<f64>());
    let scaled = found.subgradient.iter().map(|entry| entry / slope);
    let logs = [found.value.ln(), slope.ln(), total.ln()];
    logs.into_iter().chain(scaled).chain(forces.iter().map(|force| force / total)).collect()
}

/// Meshes as they are, with what they mean and their states.
struct Base {
    model: Model,
    meaning: Meaning,
    state: Vec<f64>,
}

fn bases() -> Vec<Base> {
    let form = Form { is_version_2: false, is_binary: false };
    [("two_blocks.msh", false), ("box.msh", false), ("box.msh", true)]
        .map(|(file, second_order)| {
            let model = model::base(file, second_order);
            let (case, objective) = solvable(&model, form).unwrap();
            let state = state(&objective);
            assert!(state.iter().all(|number| number.is_finite()) && state[0] > 0.0, "{state:?}");
            Base { meaning: meaning(&case), state, model }
        })
        .into()
}

/// The note that a case must have of facets and cells that are listed more than once.
fn note([facets, cells]: [usize; 2]) -> Option<String> {
    let words = |count: usize, what: &str| format!("{count} {what}{}", if count == 1 { "" } else { "s" });
    let words = match (facets, cells) {
        (0, 0) => return None,
        (0, _) => words(cells, "cell"),
        (_, 0) => words(facets, "facet"),
        _ => format!("{} and {}", words(facets, "facet"), words(cells, "cell")),
    };
    let verb = if facets + cells == 1 { "is" } else { "are" };
    Some(format!("changed.msh: {words} {verb} listed more than once; each counts once, in all its groups"))
}

/// One change, and what is wrong with what came of it.
fn tried(bases: &[Base], index: usize) -> Result<&'static str, String> {
    let mut random = Random(index as u64);
    let base = &bases[index % bases.len()];
    let form = Form { is_version_2: random.below(2) == 0, is_binary: random.below(2) == 0 };
    let mut model = base.model.clone();
    let mut done: Vec<&str> = (0..1 + random.below(3)).map(|_| changes::equal(&mut model, &mut random)).collect();
    let refusal = (random.below(3) == 0).then(|| refusals::refused(&mut model, &mut random));
    done.extend(refusal.as_ref().map(|(what, _)| *what));
    let wrong = |words: String| Err(format!("change {index}, {form:?}, {done:?}: {words}"));
    match (solvable(&model, form), refusal) {
        (Err(error), Some((what, words))) if words.iter().any(|word| error.contains(word)) => Ok(what),
        (Err(error), _) => wrong(error),
        (Ok(_), Some(_)) => wrong("not refused".into()),
        (Ok((case, objective)), None) => {
            if meaning(&case) != base.meaning {
                return wrong("another meaning".into());
            }
            let note = note(model.repeated(form.is_version_2));
            let told = case.notes.iter().find(|note| note.contains("listed more than once"));
            if told != note.as_ref() {
                return wrong(format!("told {told:?}, expected {note:?}"));
            }
            let state = state(&objective);
            let apart = state.iter().zip(&base.state).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            if state.len() != base.state.len() || apart.is_nan() || apart > 1e-10 {
                return wrong(format!("a state apart by {apart:e}"));
            }
            Ok("equal")
        }
    }
}

/// Tries the first changes of meshes; every one must leave the state or be refused with a reason that names it.
pub fn check(count: usize) {
    let (bases, next) = (bases(), AtomicUsize::new(0));
    let work = || {
        let indices = std::iter::from_fn(|| Some(next.fetch_add(1, Ordering::Relaxed)).filter(|index| *index < count));
        indices.map(|index| tried(&bases, index)).collect::<Vec<_>>()
    };
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    let results: Vec<_> = std::thread::scope(|scope| {
        let workers: Vec<_> = (0..threads).map(|_| scope.spawn(work)).collect();
        workers.into_iter().flat_map(|worker| worker.join().unwrap()).collect()
    });
    let mut kinds = BTreeMap::<&str, usize>::new();
    results.iter().flatten().for_each(|kind| *kinds.entry(kind).or_default() += 1);
    let mut wrong: Vec<&String> = results.iter().filter_map(|result| result.as_ref().err()).collect();
    wrong.sort();
    assert!(wrong.is_empty(), "{} of {count}: {:#?}", wrong.len(), &wrong[..wrong.len().min(20)]);
    // Every kind occurs.
    assert!(kinds.len() == 13 && kinds.values().all(|found| *found > count / 200), "{kinds:?}");
    println!("{kinds:?}");
}
