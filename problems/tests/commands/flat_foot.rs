//! Flat bodies on a rigid plane: no length of a run comes from the gap, and rounding places no peak.

use serde_json::Value;
use std::path::Path;
use testset::kit::{self, json};

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

/// A scene of the folder with some of its text replaced, run.
fn changed(name: &str, changes: &[(&str, &str)], options: &[&str]) -> Value {
    let folder = kit::scratch();
    let mut scene = std::fs::read_to_string(file(name)).unwrap();
    for (right, other) in changes {
        assert!(scene.contains(right), "{right}");
        scene = scene.replace(right, other);
    }
    let path = folder.path().join("scene.toml");
    std::fs::write(&path, scene).unwrap();
    let (path, json_option) = (kit::text(&path), ["--json"]);
    json(CONTACT, &[&[path], options, &json_option].concat())
}

fn codes(result: &Value) -> Vec<&str> {
    result["warnings"].as_array().unwrap().iter().map(|warning| warning["code"].as_str().unwrap()).collect()
}

/// Loaded evenly, the flat foot has its peak in the corners. In sums over nodes, those on edges count twice their area.
#[test]
fn an_even_load_is_spread_by_the_integral_and_not_by_the_sum_over_nodes() {
    let load = "[[body.loads]]\nface = \"x1-max\"\ntraction = [0, 0, 5]\n";
    let peaks = |weight: &str| {
        let result = changed("foot", &[(load, ""), ("\"nodes\"", weight)], &[]);
        [0, 1].map(|index| result["peak_pressure"][index].as_f64().unwrap())
    };
    let ([start, integral], [_, sum]) = (peaks("\"area\""), peaks("\"nodes\""));
    assert!((start - 5.5055).abs() < 1e-3 && (integral - 5.191).abs() < 1e-2, "{start} {integral}");
    assert!(sum > start, "{sum} {start}");
}

/// The gap depends on the rounding of heights such as 30.1, and may be large.
#[test]
fn heights_and_offsets_do_not_matter_to_a_foot() {
    let raised = [("height = 20\n", "height = 30.1\n"), ("19.5", "29.6"), ("[90000, 96000]", "[135000, 147000]")];
    let far = [("form = \"plane\"\nheight = 20\n\n[objective", "form = \"plane\"\nheight = 1000\n\n[objective")];
    for (changes, warnings) in [(&raised[..], vec![]), (&far[..], vec!["large-displacement"])] {
        let result = changed("foot", changes, &["--mesh", "6"]);
        let [start, end] = ["objective_start", "objective"].map(|key| result[key].as_f64().unwrap());
        assert!(
            end < 0.3 * start && result["termination"]["confirmed"] == true,
            "{start} {end} {}",
            result["termination"]
        );
        assert_eq!(codes(&result), warnings, "{}", result["warnings"]);
    }
}

#[test]
fn bodies_without_loads_have_no_peak() {
    let result = changed("foot", &[("traction = [0, 0, 5]", "traction = [0, 0, 0]")], &[]);
    assert_eq!(codes(&result), ["plateau", "no-contact", "flat-objective"], "{}", result["warnings"]);
}

/// The integral of the uniform pressure of 100 MPa over 400 mm², on every mesh, is the least value there is.
#[test]
fn a_uniform_pressure_has_the_least_integral_on_every_mesh() {
    for mesh in ["2", "5"] {
        let result = json(CONTACT, &[&file("uniform"), "--json", "--mesh", mesh]);
        for key in ["objective_start", "objective"] {
            assert!((result[key].as_f64().unwrap() / 4e10 - 1.0).abs() < 1e-9, "{key}: {}", result[key]);
        }
        let peak = result["peak_pressure"][1].as_f64().unwrap();
        assert!((peak / 100.0 - 1.0).abs() < 1e-9 && codes(&result).contains(&"least-objective"), "{result}");
    }
}

/// All nodes of one brick lie on an edge.
#[test]
fn a_uniform_pressure_on_one_brick_has_no_peak_at_an_edge() {
    let held = "face = \"x1-min\"\nheld = [\"u1\"]\n\n[[body.supports]]\nface = \"x2-min\"\nheld = [\"u2\"]";
    let changes =
        [(held, "face = \"bottom\"\nheld = [\"u1\", \"u2\"]"), ("poisson_ratio = 0.3", "poisson_ratio = 0.0")];
    let result = changed("uniform", &changes, &["evaluate", "--mesh", "1"]);
    assert!((result["peak_pressure"].as_f64().unwrap() / 100.0 - 1.0).abs() <= 1e-9, "{}", result["peak_pressure"]);
    assert_eq!(codes(&result), ["few-closed-nodes"], "{}", result["warnings"]);
}

#[test]
fn a_uniform_pressure_has_no_peak_at_an_edge() {
    let result = json(CONTACT, &[&file("uniform"), "evaluate", "--json"]);
    assert!((result["peak_pressure"].as_f64().unwrap() / 100.0 - 1.0).abs() <= 1e-9, "{}", result["peak_pressure"]);
    assert_eq!(result["warnings"].as_array().map(Vec::len), Some(0), "{}", result["warnings"]);
}
