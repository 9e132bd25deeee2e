//! The worked examples of the tutorials at their starts; their optima are in the second tier (studies, `long`).

use serde_json::Value;
use testset::kit::json;

const CONTACT: &str = env!("CARGO_BIN_EXE_contact3d");

/// Relative difference that rounding and other processors may make.
const ROUNDING: f64 = 1e-6;

fn evaluated(scene: &str) -> Value {
    let scene = format!("{}/scenes/{scene}.toml", env!("CARGO_MANIFEST_DIR"));
    json(CONTACT, &[&scene, "evaluate", "--no-checks", "--json"])
}

fn close(what: &str, found: &Value, expected: f64) {
    let found = found.as_f64().unwrap_or(f64::NAN);
    assert!((found / expected - 1.0).abs() < ROUNDING, "{what}: {found} instead of {expected}");
}

/// docs/tutorial_bracket.md: three load cases, of which one exceeds the stress limit at the start.
#[test]
fn the_bracket_has_the_start_of_its_page() {
    let state = evaluated("bracket");
    close("objective", &state["objective"], 91_785_376_668.998_8);
    let expected = [(136.269_351, 99.916_232), (206.060_951, 181.020_734), (146.722_179, 105.587_412)];
    for (case, (peak, stress)) in state["cases"].as_array().unwrap().iter().zip(expected) {
        close("peak", &case["peak_pressure"], peak);
        let limit = state["limits"].as_array().unwrap().iter().find(|limit| limit["case"] == case["name"]).unwrap();
        close("stress", &limit["end"], stress);
        assert_eq!(limit["violation"].as_f64() > Some(0.0), case["name"] == "forward", "{limit}");
    }
}

/// docs/tutorial_roller.md: two meshes that do not match, two loads and a tilt.
#[test]
fn the_roller_has_the_peaks_of_its_page() {
    let state = evaluated("roller");
    close("objective", &state["objective"], 2_846.174_007_000_656);
    for (case, peak) in state["cases"].as_array().unwrap().iter().zip([2100.74, 2334.71, 1145.15, 1423.09]) {
        let found = case["peak_pressure"].as_f64().unwrap();
        assert!((found - peak).abs() < 0.0051, "{}: {found} instead of {peak}", case["name"]);
        assert!(case["residual"].as_f64() < Some(1e-9), "{}", case["residual"]);
    }
}

/// docs/tutorial_taper.md: equilibrium along the axis of a cone that slides, F = ∫ p (sin θ + μ cos θ) dA.
#[test]
fn the_taper_balances_the_force_that_presses_it() {
    let state = evaluated("taper");
    close("objective", &state["objective"], 1_929.111_796_5);
    close("peak", &state["peak_pressure"], 258.638_005_7);
    // Half the angle of the bore: half of 5°40′, and 2′ more.
    let half = (2.0_f64 + 52.0 / 60.0).to_radians();
    let force = 333.333_333_33 / (half.sin() + 0.15 * half.cos());
    let found = state["total_normal_force"].as_f64().unwrap();
    assert!((found / force - 1.0).abs() < 5e-3, "{found} instead of {force}");
    close("normal force", &state["total_normal_force"], 1_673.107_956_6);
}

/// Tetrahedra of both bodies do not match, and their middle nodes lie on the spheres.
#[test]
fn the_ball_in_its_socket_has_the_peak_of_its_scene() {
    let state = evaluated("ball_socket");
    close("objective", &state["objective"], 1.311_387_327_09e10);
    close("peak", &state["peak_pressure"], 165.856_456_7);
}
