//! The scenes of the lug: its nose is shaped with the volume kept, on both kinds of cells.

use serde_json::Value;
use testset::kit::json;

/// Evaluations that a run may take.
const MOST_EVALUATIONS: u64 = 60;

fn shaped(kind: &str, gain: f64) {
    let scene = format!("{}/scenes/lug_{kind}.toml", env!("CARGO_MANIFEST_DIR"));
    let result = json(env!("CARGO_BIN_EXE_contact3d"), &[&scene, "--json"]);
    let number = |value: &Value| value.as_f64().unwrap_or(f64::NAN);
    assert_eq!(result["termination"]["confirmed"], true, "{kind}: {}", result["termination"]);
    assert!(result["evaluations"].as_u64() <= Some(MOST_EVALUATIONS), "{kind}: {}", result["evaluations"]);
    let volume = &result["limits"][0];
    // A limit is kept to 1e-6 of its bound.
    assert!((number(&volume["end"]) - 1.0).abs() < 1.001e-6 && volume["active"] == true, "{kind}: {volume}");
    let found = number(&result["objective_start"]) / number(&result["objective"]);
    assert!((found / gain - 1.0).abs() < 0.01, "{kind}: {found}");
}

#[test]
fn the_nose_of_hexahedra_is_shaped() {
    shaped("hex8", 29.09);
}

#[test]
fn the_nose_of_tetrahedra_is_shaped() {
    shaped("tet10", 30.83);
}
