//! A contact scene whose optimum lies on kinks of the state: the composite model must not cost more than the cuts alone.

use crate::binary;
use serde_json::Value;
use testset::kit::{self, json, text};

const SCENE: &str = include_str!("../../scenes/just_touching.toml");

/// Evaluations to the best value of the cuts alone, up to 1e-6, and to the end, with the second look at the proof.
const COMPOSITE: [u64; 2] = [25, 63];
/// The same with the cuts alone.
const BUNDLE: [u64; 2] = [29, 50];
/// Amplitudes of the obstacle, in mm; that of the scene is the seventh.
const AMPLITUDES: [&str; 9] = ["0.100", "0.105", "0.110", "0.115", "0.120", "0.125", "0.13", "0.135", "0.140"];

/// The reports with the composite model and with the cuts alone.
fn run(amplitude: &str) -> [Value; 2] {
    let scratch = kit::scratch();
    let file = scratch.path().join("scene.toml");
    assert!(SCENE.contains("second = -0.13"));
    std::fs::write(&file, SCENE.replace("second = -0.13", &format!("second = -{amplitude}"))).unwrap();
    ["composite", "bundle"]
        .map(|name| json(binary("contact3d").unwrap(), &[text(&file), "optimize", "--optimizer", name, "--json"]))
}

/// Evaluations to the best value of the cuts alone and to the end, of both.
fn counts(reports: &[Value; 2]) -> [[u64; 2]; 2] {
    let level = reports[1]["objective"].as_f64().unwrap() * (1.0 + 1e-6);
    reports.each_ref().map(|report| {
        let course = report["course"].as_array().unwrap();
        let hit = course.iter().find(|entry| entry["objective"].as_f64().is_some_and(|value| value <= level)).unwrap();
        [hit["evaluation"].as_u64().unwrap(), report["evaluations"].as_u64().unwrap()]
    })
}

#[test]
fn at_the_optimum_two_nodes_just_touch() {
    let reports = run("0.13");
    for report in &reports {
        assert!(report["termination"]["reason"]["stationary"].is_object(), "{}", report["termination"]);
        // Without friction the touching of the normal direction is the only kink.
        assert_eq!(report["kinks"][0]["weakly_active"], 0);
        assert_eq!(report["kinks"][1]["weakly_active"], 2, "{}", report["kinks"]);
    }
    assert_eq!(counts(&reports), [COMPOSITE, BUNDLE]);
}

/// Single courses scatter: to the best value the ratios lie between 0.81 and 1.33, to the end between 0.80 and 1.46.
#[test]
fn on_such_kinks_the_composite_model_costs_at_most_a_tenth() {
    let found = AMPLITUDES.map(|amplitude| counts(&run(amplitude)));
    for (to, measured) in [(0, 1.027), (1, 1.088)] {
        let logs = found.map(|[with, without]| (with[to] as f64 / without[to] as f64).ln());
        let mean = (logs.iter().sum::<f64>() / logs.len() as f64).exp();
        assert!(mean <= 1.1 && (mean - measured).abs() < 1e-3, "{mean}, measured {measured}: {found:?}");
    }
}
