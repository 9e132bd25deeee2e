//! A contact scene whose optimum lies on kinks of the state: the composite model must cost no more than cuts alone.

use crate::binary;
use serde_json::Value;
use testset::kit::{self, json, text};

const SCENE: &str = include_str!("../../scenes/just_touching.toml");

/// Evaluations with the composite model: to the best value of the cuts alone, up to 1e-6, and to the end.
const COMPOSITE: [u64; 2] = [32, 66];
/// Evaluations with the cuts alone: to their best value, up to 1e-6, and to the end.
const BUNDLE: [u64; 2] = [28, 48];
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
        let reason = &report["termination"]["reason"];
        let stationary = reason["stationary"].is_object() || reason["stationary_unconfirmed"].is_object();
        assert!(stationary, "{}", report["termination"]);
        // Without friction the touching of the normal direction is the only kink.
        assert_eq!(report["kinks"][0]["weakly_active"], 0);
        assert_eq!(report["kinks"][1]["weakly_active"], 2, "{}", report["kinks"]);
    }
    assert!(reports[0]["termination"]["confirmed"] == true, "{}", reports[0]["termination"]);
    let found = counts(&reports);
    let about = |found: u64, measured: u64| found as f64 <= 1.15 * measured as f64 + 2.0;
    let pairs = found.iter().flatten().zip(COMPOSITE.iter().chain(&BUNDLE));
    assert!(pairs.into_iter().all(|(found, measured)| about(*found, *measured)), "{found:?}");
}

/// Single courses scatter: to the best value the ratios lie between 0.77 and 2.05, to the end between 0.85 and 1.54.
#[test]
fn on_such_kinks_the_composite_model_costs_at_most_a_quarter() {
    let found = AMPLITUDES.map(|amplitude| counts(&run(amplitude)));
    for (to, measured) in [(0, 1.195), (1, 1.138)] {
        let logs = found.map(|[with, without]| (with[to] as f64 / without[to] as f64).ln());
        let mean = (logs.iter().sum::<f64>() / logs.len() as f64).exp();
        assert!(mean <= 1.25, "{mean}, measured {measured}: {found:?}");
    }
}
