//! The binaries' contract: JSON keys, numbers, exit statuses, messages.

use crate::binary;
use serde_json::{Value, json};
use testset::kit;

fn run(name: &str, arguments: &[&str]) -> Value {
    kit::json(binary(name).unwrap(), arguments)
}

fn refused(name: &str, arguments: &[&str], words: &[&str]) {
    kit::refused(binary(name).unwrap(), arguments, words);
}

fn close(value: &Value, expected: f64, tolerance: f64) {
    let value = value.as_f64().unwrap();
    assert!((value - expected).abs() <= tolerance * expected.abs(), "{value} instead of {expected}");
}

#[test]
fn signorini_evaluates_the_published_case() {
    let result = run("signorini3d", &["evaluate", "--mesh", "12", "--subdomains", "2", "--json"]);
    close(&result["objective"], 4.4456794708e17, 1e-9);
    close(&result["total_normal_force"], 3e7, 1e-10);
    assert_eq!(result["status"], json!({"open": 96, "stick": 32, "slip": 41}));
    assert_eq!(result["subgradient"].as_array().unwrap().len(), 36);
    for key in ["peak_pressure", "kink", "residuals", "work", "seconds", "left_out"] {
        assert!(!result[key].is_null(), "{key}");
    }
    // The count of products with the dual operator is the price of a state; a change is to be noticed.
    let work = &result["work"];
    let state = work["dual_operator_applications"].as_u64().unwrap() - work["adjoint_applications"].as_u64().unwrap();
    assert!(state <= 36 && work["adjoint_applications"].as_u64().unwrap() <= 30, "{work}");
}

#[test]
fn diagnosis_is_given_when_asked_for() {
    let plain = run("signorini3d", &["evaluate", "--mesh", "4", "--json"]);
    assert!(plain["diagnosis"].is_null());
    let asked = run("signorini3d", &["evaluate", "--mesh", "4", "--diagnose", "--solver", "direct", "--json"]);
    let contraction = asked["diagnosis"]["contraction"].as_f64().unwrap();
    assert!((0.05..0.2).contains(&contraction), "{contraction}");
    assert!(asked["diagnosis"]["condition"].as_f64().unwrap() >= 1.0);
    refused("signorini3d", &["verify", "--diagnose"], &["--diagnose"]);
}

#[test]
fn mean_dilatation_is_selected_by_an_option() {
    let options = ["evaluate", "--mesh", "4", "--poisson-ratio", "0.4999", "--json"];
    let standard = run("hertz3d", &options);
    let mean = run("hertz3d", &[&options[..], &["--formulation", "mean-dilatation"]].concat());
    let [standard, mean] = [standard, mean].map(|result| result["objective"].as_f64().unwrap());
    assert!(standard > 1.5 * mean, "locked {standard:.3e}, mean dilatation {mean:.3e}");
    let result = run("hertz3d", &["verify", "--mesh", "4", "--formulation", "mean-dilatation", "--json"]);
    assert!((result["fitted_slope"].as_f64().unwrap() - 2.0).abs() < 0.1, "{result}");
    refused("hertz3d", &["evaluate", "--formulation", "locked"], &["mean-dilatation"]);
}

#[test]
fn signorini_without_friction_has_no_tangential_multiplier() {
    let result = run("signorini3d", &["evaluate", "--friction", "0", "--json"]);
    close(&result["objective"], 4.2337567508e17, 1e-9);
    let left_out = result["left_out"].to_string();
    assert!(left_out.contains("tangential multipliers"), "{left_out}");
}

#[test]
fn hertz_evaluates_with_both_solvers() {
    for solver in ["newton", "direct"] {
        let result = run("hertz3d", &["evaluate", "--solver", solver, "--json"]);
        close(&result["objective"], 6.6407428904e17, 1e-9);
        assert_eq!(result["status"], json!({"open": 104, "stick": 58, "slip": 7}));
    }
}

#[test]
fn subgradients_pass_the_taylor_test() {
    for (binary, mesh) in [("signorini3d", "12"), ("hertz3d", "6")] {
        let result = run(binary, &["verify", "--mesh", mesh, "--json"]);
        let slope = result["fitted_slope"].as_f64().unwrap();
        assert!((slope - 2.0).abs() < 0.1, "{binary}: slope {slope}");
        assert!(result["best_derivative_error"].as_f64().unwrap() < 1e-7, "{binary}: {result}");
    }
}

#[test]
fn a_short_optimization_descends_and_stays_admissible() {
    let result = run("hertz3d", &["--mesh", "6", "--max-evaluations", "8", "--solver", "newton", "--json"]);
    let (start, end) = (result["objective_start"].as_f64().unwrap(), result["objective"].as_f64().unwrap());
    assert!(start / end > 5.0, "{start} {end}");
    assert!(result["largest_constraint_violation"].as_f64().unwrap() <= 1e-9);
    assert_eq!([&result["evaluations"], &result["states"], &result["jacobians"]], [8, 8, 8]);
    let course = result["course"].as_array().unwrap();
    assert_eq!(course.len(), 8);
    assert!(course.iter().all(|evaluation| evaluation["products"].as_u64() > Some(0)), "{result}");
    assert_eq!(result["controls"].as_array().unwrap().len(), 36);
    let termination = result["termination"]["text"].as_str().unwrap();
    assert!(termination.contains("limit"), "{termination}");
    assert!(result["certificate"]["aggregate_norm"].is_f64());
}

#[test]
fn an_optimization_ends_by_itself_confirmed() {
    let result = run("hertz3d", &["--mesh", "6", "--json"]);
    assert_eq!(result["termination"]["confirmed"], true, "{result}");
    assert!(result["states"].as_u64() <= Some(25), "{result}");
    // Direct condensation has no products.
    let course = result["course"].as_array().unwrap();
    assert!(course.iter().all(|evaluation| evaluation["products"] == 0), "{result}");
}

#[test]
fn controls_travel_through_files() {
    let scratch = kit::scratch();
    let folder = scratch.path();
    let out = kit::text(folder);
    let optimized = run(
        "signorini3d",
        &["--mesh", "4", "--max-evaluations", "8", "--objective", "peak-pressure", "--out", out, "--json"],
    );
    let controls = folder.join("controls.json");
    let path = kit::text(&controls);
    let evaluated =
        run("signorini3d", &["evaluate", "--mesh", "4", "--objective", "peak-pressure", "--controls", path, "--json"]);
    assert_eq!(evaluated["objective"], evaluated["peak_pressure"]);
    close(&evaluated["objective"], optimized["objective"].as_f64().unwrap(), 1e-9);
    for file in ["report.txt", "report.json", "certificate.json", "history.csv", "pressure_optimal.csv"] {
        assert!(folder.join(file).exists(), "{file}");
    }
}

#[test]
fn other_surfaces_and_control_points() {
    for options in [["--degrees", "5", "--control-points", "6x6"], ["--degrees", "2", "--control-points", "5x7"]] {
        let mut arguments = vec!["evaluate", "--mesh", "4", "--json"];
        arguments.extend(options);
        let result = run("signorini3d", &arguments);
        close(&result["total_normal_force"], 3e7, 1e-10);
    }
}

#[test]
fn bad_options_are_refused_with_status_two() {
    for (arguments, words) in [
        (vec!["evaluate", "--mesh", "0"], vec!["mesh", "0"]),
        (vec!["evaluate", "--mesh", "12", "--subdomains", "5"], vec!["subdomains", "5", "12"]),
        (vec!["evaluate", "--friction", "-0.1"], vec!["friction", "-0.1"]),
        (vec!["evaluate", "--friction", "NaN"], vec!["friction", "NaN"]),
        (vec!["evaluate", "--poisson-ratio", "0.5"], vec!["--poisson-ratio", "0.5", "< 0.5"]),
        (vec!["evaluate", "--degrees", "6"], vec!["degree", "6"]),
        (vec!["evaluate", "--controls", "no-such-file.json"], vec!["no-such-file.json"]),
        (vec!["evaluate", "--degrees", "nurbs"], vec!["degrees", "integer"]),
        (vec!["evaluate", "--start-controls", "x.json"], vec!["--start-controls"]),
        (vec!["--threads", "0"], vec!["--threads"]),
        (vec!["--max-evaluations", "0"], vec!["--max-evaluations"]),
        (vec!["minimise"], vec!["minimise", "optimize"]),
    ] {
        refused("signorini3d", &arguments, &words);
    }
}

#[test]
fn bad_control_files_are_refused_with_status_two() {
    let outside = format!("[{}]", vec!["150.0"; 36].join(","));
    // As many numbers as the scene has, in another grid.
    let grid = format!("{:?}", [[100.0; 9]; 4]);
    for (name, text, words) in [
        ("count.json", "[1.0, 2.0]", vec!["2", "36"]),
        ("syntax.json", "[1.0, nonsense", vec!["syntax.json"]),
        ("nan.json", "[NaN]", vec!["nan.json"]),
        ("object.json", "{\"a\": 1}", vec!["object.json", "array"]),
        ("uneven.json", "[[1.0, 2.0], [3.0]]", vec!["uneven.json", "different lengths", "6 arrays of 6 numbers"]),
        ("mixed.json", "[[1.0, 2.0], 3.0]", vec!["mixed.json", "6 arrays of 6 numbers"]),
        ("grid.json", grid.as_str(), vec!["grid.json", "4x9", "6x6"]),
        ("outside.json", outside.as_str(), vec!["admissible", "150"]),
    ] {
        let folder = kit::scratch();
        let file = folder.path().join(name);
        std::fs::write(&file, text).unwrap();
        refused("signorini3d", &["evaluate", "--mesh", "4", "--controls", kit::text(&file)], &words);
    }
}

#[test]
fn a_scene_without_equilibrium_names_the_direction_and_the_resultant() {
    for command in ["evaluate", "optimize"] {
        refused(
            "signorini3d",
            &[command, "--mesh", "4", "--load-factor", "-1"],
            &["no equilibrium", "translation along x3", "3.000000e7"],
        );
    }
}
