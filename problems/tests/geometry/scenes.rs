//! Scenes of the published cases.

use contact::contact_objective::ContactObjective;
use contact::contact_shape::{ContactShape, ContactState};
use contact::solvers::{Processes, SolverKind, SolverPlan};
use nonsmooth::{Accuracy, StateSolver, Vector};
use scene_file::{Case, SceneFile};
use serde_json::Value;
use std::path::Path;

/// A block of 6³ bricks with a spline of 6 × 6 heights.
pub const BLOCK: &str = r#"
name = "block"
friction = 0.3

[[body]]
name = "lower"
material = { young_modulus = 1.1e5, poisson_ratio = 0.33 }
supports = [{ face = "x1-min", held = ["u1", "u2"] }]
loads = [{ face = "bottom", traction = [0.0, 0.0, 3000.0] }]

[body.block]
size = [100.0, 100.0]
bricks = [6, 6, 6]
subdomains = [2, 2, 2]

[body.lattice]
heights = "top"
control_points = [6, 6]
start = { form = "plane", height = 100.0 }
thickness = 50.0
slope = 5.0
volume = [5e5, 2e6]

[[contact]]
slave = { face = "top" }

[contact.obstacle]
form = "waves"
base = 103.0
first = 1.0
second = 2.0
period = 100.0

[objective]
weight = "nodes"
"#;

/// A lug with a Bernstein lattice of 3³ control points.
const LUG: &str = r#"
name = "lug"
friction = 0.3

[[body]]
mesh = "MESH"
pieces = 5
material = { young_modulus = 7e4, poisson_ratio = 0.35 }
supports = [{ face = "wall", held = ["u1", "u2"] }]
loads = [{ face = "top", traction = [0.0, 0.0, -800.0] }]

[body.lattice]
control_points = [3, 3, 3]
box = [[-20.0, 0.0, 0.0], [20.0, 30.0, 40.0]]
displacement = [-2.0, 2.0]
hold_supports = false

[[contact]]
slave = { face = "nose" }

[contact.obstacle]
form = "tilted-plane"
point = [0.0, 0.0, -0.05]
normal = [0.05, -0.01, -1.0]

[objective]
weight = "nodes"
"#;

/// The published cases.
pub fn published() -> Vec<Value> {
    serde_json::from_str(include_str!("../data/one_body.json")).expect("published cases")
}

/// The case of a scene file whose mesh lies beside the scenes.
pub fn case(text: &str) -> Case {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes");
    let file = SceneFile::parse(text, "scene").expect("a scene file");
    Case::new(&file, &folder).expect("a scene")
}

/// The text of a published case.
pub fn text_of(published: &Value) -> String {
    let base = match published["mesh"].as_str() {
        Some("block") => BLOCK.to_owned(),
        Some(mesh) => LUG.replace("MESH", mesh),
        None => unreachable!("a mesh has a name"),
    };
    let base =
        base.replace("friction = 0.3", &format!("friction = {:?}", published["friction"].as_f64().expect("a number")));
    let base =
        if published["projected"] == true { base.replace("[[contact]]", "[[contact]]\nnormal = \"x3\"") } else { base };
    let obstacle = &published["obstacle"];
    let vector = |key: &str| format!("{}", obstacle[key]);
    let counter = match obstacle["type"].as_str() {
        Some("sphere") => {
            let side = if obstacle["side"] == 1 { "outside" } else { "inside" };
            format!(
                "form = \"ball\"\ncentre = {}\nradius = {:?}\nside = \"{side}\"",
                vector("centre"),
                number(&obstacle["radius"])
            )
        }
        Some("plane") => format!("form = \"tilted-plane\"\npoint = {}\nnormal = {}", vector("point"), vector("normal")),
        _ => return base,
    };
    let (before, rest) = base.split_once("[contact.obstacle]").expect("a table");
    let (_, after) = rest.split_once("\n\n").expect("a table after it");
    // Integers are no numbers of TOML fields.
    format!("{before}[contact.obstacle]\n{counter}\n\n{after}")
}

/// Θ of a case by a solver.
pub fn objective(case: &Case, kind: SolverKind) -> ContactObjective {
    let plan = SolverPlan { kind, ..SolverPlan::new(case.scene.clone(), kind) };
    let shape = ContactShape::by(Processes::alone().solver(plan).expect("a solver"));
    ContactObjective::new(shape, case.objective.clone(), &[]).expect("an objective")
}

/// Value, gradient and state at some controls.
pub fn solved(objective: &ContactObjective, controls: &Vector) -> (f64, Vector, ContactState) {
    let state = objective.cases().solve(controls, None, Accuracy::TIGHTEST).expect("a state");
    let evaluation = objective.differentiate(controls, &state).expect("a gradient");
    (evaluation.value, evaluation.subgradient, state.into_states().remove(0))
}

pub fn number(value: &Value) -> f64 {
    value.as_f64().expect("a number")
}

pub fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().expect("a list").iter().map(number).collect()
}

pub fn vectors(value: &Value) -> Vec<[f64; 3]> {
    let vector = |value: &Value| <[f64; 3]>::try_from(numbers(value)).expect("three numbers");
    value.as_array().expect("a list").iter().map(vector).collect()
}
