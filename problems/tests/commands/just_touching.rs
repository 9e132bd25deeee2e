//! A contact scene whose optimum lies on kinks of the state: the composite model must not cost more than the cuts alone.

use crate::binary;
use serde_json::Value;
use testset::kit::json;

/// Evaluations to the best value of the cuts alone, up to 1e-6, and to the end. The last two are the second look at the proof.
const COMPOSITE: [u64; 2] = [24, 42];
/// The same with the cuts alone.
const BUNDLE: [u64; 2] = [28, 41];

fn run(optimizer: &str) -> Value {
    let scene = concat!(env!("CARGO_MANIFEST_DIR"), "/scenes/just_touching.toml");
    json(binary("contact3d").unwrap(), &[scene, "optimize", "--optimizer", optimizer, "--json"])
}

#[test]
fn at_the_optimum_two_nodes_just_touch_and_the_composite_model_costs_at_most_a_tenth() {
    let (composite, bundle) = (run("composite"), run("bundle"));
    let level = bundle["objective"].as_f64().unwrap() * (1.0 + 1e-6);
    let counts = |report: &Value| {
        let course = report["course"].as_array().unwrap();
        let hit = course.iter().find(|entry| entry["objective"].as_f64().is_some_and(|value| value <= level)).unwrap();
        [hit["evaluation"].as_u64().unwrap(), report["evaluations"].as_u64().unwrap()]
    };
    let found = [counts(&composite), counts(&bundle)];
    for (report, touching) in [(&composite, 1), (&bundle, 2)] {
        assert!(report["termination"]["reason"]["stationary"].is_object(), "{}", report["termination"]);
        // Without friction the touching of the normal direction is the only kink.
        assert_eq!(report["kinks"][0]["weakly_active"], 0);
        // Both nodes touch at the optimum. The composite run ends 3e-9 above it, where one of them is still open by a hair.
        assert_eq!(report["kinks"][1]["weakly_active"], touching, "{}", report["kinks"]);
    }
    for (with, without) in found[0].iter().zip(found[1]) {
        assert!(*with as f64 <= 1.1 * without as f64, "{found:?}");
    }
    assert_eq!(found, [COMPOSITE, BUNDLE]);
}
