//! Scenes that few nodes hold, found wrong or refused by an independent check: the default finds their states.
//!
//! Θ comes from other programs, with residuals ≤ 5e-10: a convex program without friction, contact dynamics with it.

use std::path::Path;
use testset::kit::{errors, json, run};

const CONTACT: &str = env!("CARGO_BIN_EXE_contact3d");

/// Scene and its Θ; three equilibria for the last.
const SCENES: [(&str, &[f64]); 12] = [
    ("two_bodies_q028", &[20700.3749957751]),
    ("two_bodies_q035", &[2.134449071975984e-2]),
    ("two_bodies_r11", &[4232.943473874128]),
    ("sphere_r08", &[4.972685578e-13]),
    ("sphere_r38", &[123.78134710212245]),
    ("tilting_without_friction", &[2687.3856]),
    ("tilting_with_friction", &[1.679616e10]),
    ("few_nodes_000", &[1.4113142535859e-41]),
    ("few_nodes_023", &[7.132515028314e-33]),
    ("few_nodes_045", &[4.0498864713750e-4]),
    ("few_nodes_057", &[5.343651916988e-12]),
    ("few_nodes_143", &[1.4969438510865e11, 3.468210860384e6, 2.985668394055e6]),
];

fn scene_file(name: &str) -> String {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("tests/data/loosely_held/{name}.toml"));
    file.display().to_string()
}

#[test]
fn the_default_finds_the_states_of_loosely_held_bodies() {
    for (name, values) in SCENES {
        let result = json(CONTACT, &[&scene_file(name), "evaluate", "--json"]);
        let objective = result["objective"].as_f64().unwrap();
        let error = values.iter().map(|value| (objective / value - 1.0).abs()).fold(f64::INFINITY, f64::min);
        assert!(error <= 1e-7, "{name}: {objective:e}, relative error {error:.1e}");
        let residuals = result["residuals"].as_object().unwrap();
        assert!(residuals.values().all(|residual| residual.as_f64().unwrap() <= 1e-8), "{name}: {residuals:?}");
        let warned = result["warnings"].as_array().unwrap().iter().any(|warning| warning["code"] == "not-unique");
        assert_eq!(warned, values.len() > 1, "{name}: {}", result["warnings"]);
        assert_eq!(result["solver_reason"].is_null(), result["solver"] == "newton", "{name}");
    }
}

/// The coarse problem of total FETI is ill conditioned here: its forces used to be in equilibrium to 2e-11 where
/// ordinary ones are to 1e-15, the few nodes at a corner that hold the upper body enlarged that, and Θ was wrong by
/// 2e-7.
#[test]
fn every_solver_is_as_accurate_at_a_corner() {
    let file = scene_file("corner");
    let results = ["direct", "newton"].map(|solver| json(CONTACT, &[&file, "evaluate", "--solver", solver, "--json"]));
    let [direct, torn] = results.each_ref().map(|result| result["objective"].as_f64().unwrap());
    assert!((torn / direct - 1.0).abs() < 1e-9, "{direct:e} {torn:e}");
    for result in &results {
        let imbalance = result["residuals"]["equilibrium"].as_f64().unwrap();
        assert!(imbalance < 1e-13, "{imbalance:e} by {}", result["solver"]);
    }
}

/// Bending raises the mean compliance of these bodies far above that of single nodes. The continuation in the contact
/// compliance used to end at a millionth of that mean, and found no state. Θ by total FETI without a limit on products.
#[test]
fn the_default_finds_the_states_of_thin_bodies_that_bend() {
    for (name, value) in [("sheet", 1.2896164e-32), ("plate", 2.2287528e-25)] {
        let result = json(CONTACT, &[&scene_file(name), "evaluate", "--json"]);
        let objective = result["objective"].as_f64().unwrap();
        assert!((objective / value - 1.0).abs() < 1e-5, "{name}: {objective:e}");
    }
}

/// A column leans along an obstacle that it does not touch. Friction times its slip exceeds the opening, so that it may
/// be wedged in as well; 1 mm farther away it cannot be.
#[test]
fn a_state_without_contact_is_said_to_be_one_of_several_where_friction_could_wedge() {
    let near = std::fs::read_to_string(scene_file("wedged")).unwrap();
    let folder = testset::kit::scratch();
    let far = folder.path().join("far.toml");
    std::fs::write(&far, near.replace("apex = 60.01", "apex = 61.01")).unwrap();
    for (file, expected) in [(scene_file("wedged"), true), (far.display().to_string(), false)] {
        for solver in ["newton", "direct"] {
            let result = json(CONTACT, &[&file, "evaluate", "--solver", solver, "--json"]);
            assert_eq!(result["status"]["open"], 16, "{solver}");
            let warned = result["warnings"].as_array().unwrap().iter().any(|warning| warning["code"] == "not-unique");
            assert_eq!(warned, expected, "{solver}: {}", result["warnings"]);
        }
    }
}

/// Total FETI alone used to return states of such bodies with a resultant of 5e-3 of the load. Whether it finds the
/// state of this scene hangs on rounding; what it returns is the state, or a refusal.
#[test]
fn total_feti_alone_finds_the_state_of_two_loosely_held_bodies_or_refuses() {
    let (name, values) = SCENES[1];
    let output = run(CONTACT, &[&scene_file(name), "evaluate", "--solver", "newton", "--json"]);
    let message = errors(&output);
    if output.status.success() {
        let result: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
        let objective = result["objective"].as_f64().unwrap();
        assert!((objective / values[0] - 1.0).abs() <= 1e-7, "{objective:e}");
        return;
    }
    assert_eq!(output.status.code(), Some(1), "{message}");
    let refusals = ["are no state", "did not converge: residual"];
    assert!(refusals.iter().any(|words| message.contains(words)), "{message}");
}

/// The adjoint of a loosely held state takes total FETI hundreds of products: the default condenses these bodies.
#[test]
fn adjoints_of_loosely_held_states_agree() {
    for name in ["slow_adjoint", "slow_adjoint_without_friction"] {
        let evaluated = |solver| json(CONTACT, &[&scene_file(name), "evaluate", "--solver", solver, "--json"]);
        let (torn, default) = (evaluated("newton"), evaluated("auto"));
        assert_eq!((&torn["solver"], &default["solver"]), (&"newton".into(), &"direct".into()), "{name}");
        let subgradient = |result: &serde_json::Value| -> Vec<f64> {
            result["subgradient"].as_array().unwrap().iter().map(|entry| entry.as_f64().unwrap()).collect()
        };
        let (found, expected) = (subgradient(&torn), subgradient(&default));
        let size = expected.iter().fold(0.0_f64, |size, entry| size.max(entry.abs()));
        let error = found.iter().zip(&expected).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(error <= 1e-7 * size, "{name}: {error:e} of {size:e}");
    }
}
