//! Flat bodies on a rigid plane: no length of a run comes from the gap, and rounding places no peak.

use std::path::Path;
use testset::kit::json;

const CONTACT: &str = env!("CARGO_BIN_EXE_contact3d");

/// Started with a first step of 0.05 mm, the run reaches the same value by cuts alone.
const LEAST: f64 = 4.083286e5;

fn file(name: &str) -> String {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("tests/data/flat_foot/{name}.toml")).display().to_string()
}

#[test]
fn a_foot_that_just_touches_a_plane_is_optimized() {
    let result = json(CONTACT, &[&file("foot"), "--json"]);
    let objective = result["objective"].as_f64().unwrap();
    assert!((objective / LEAST - 1.0).abs() <= 1e-5, "{objective:e}");
    assert_eq!(result["termination"]["confirmed"], true, "{}", result["termination"]);
    assert!(result["evaluations"].as_u64().unwrap() <= 25, "{}", result["evaluations"]);
    assert_eq!(result["warnings"].as_array().map(Vec::len), Some(0), "{}", result["warnings"]);
}

#[test]
fn a_uniform_pressure_has_no_peak_at_an_edge() {
    let result = json(CONTACT, &[&file("uniform"), "evaluate", "--json"]);
    assert!((result["peak_pressure"].as_f64().unwrap() / 100.0 - 1.0).abs() <= 1e-9, "{}", result["peak_pressure"]);
    assert_eq!(result["warnings"].as_array().map(Vec::len), Some(0), "{}", result["warnings"]);
}
