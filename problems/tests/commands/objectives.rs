//! Objectives beside pressure norm and peak, from the command line to the report: the example scenes with their
//! numbers, refusals, resumption.

use crate::binary;
use serde_json::Value;
use std::path::Path;
use testset::kit::{self, json, text};

fn contact3d() -> &'static str {
    binary("contact3d").unwrap()
}

fn scene(name: &str) -> String {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes").join(name).display().to_string()
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or(f64::NAN)
}

fn near(found: &Value, expected: f64, tolerance: f64) {
    assert!((number(found) / expected - 1.0).abs() < tolerance, "{found} {expected}");
}

/// The wanted pressure of `seal.toml` is approached by the composite method, and the end is confirmed.
#[test]
fn a_seal_comes_near_its_wanted_pressure() {
    let report = json(contact3d(), &[&scene("seal.toml"), "--single", "--json"]);
    near(&report["objective_start"], 2.0433999589e-2, 1e-8);
    near(&report["objective"], 3.4670119981e-3, 1e-6);
    assert_eq!((report["evaluations"].as_u64(), report["jacobians"].as_u64()), (Some(5), Some(5)));
    assert_eq!(report["termination"]["confirmed"], true);
}

/// The bundle method with one subgradient per shape is the one for functions of the displacements.
#[test]
fn a_support_loses_three_quarters_of_its_stress_norm() {
    let report = json(contact3d(), &[&scene("support.toml"), "--mesh", "4", "--json"]);
    near(&report["objective_start"], 1.7783697120e2, 1e-8);
    // A run that its limit ends depends on the rounding of every step before: 41 to 44 MPa.
    assert!(number(&report["objective"]) < 0.25 * number(&report["objective_start"]), "{}", report["objective"]);
    assert_eq!((report["evaluations"].as_u64(), report["jacobians"].as_u64()), (Some(150), Some(0)));
    assert_eq!(report["termination"]["reason"], "evaluation_limit");
}

#[test]
fn every_objective_is_evaluated_verified_optimized_and_rechecked() {
    let folder = kit::scratch();
    let base = std::fs::read_to_string(scene("tangential.toml")).unwrap();
    let base = base.split("[objective]").next().unwrap();
    std::fs::write(folder.path().join("wanted.csv"), "# MPa\n30, 40\n50, 60\n").unwrap();
    for (index, section) in [
        "quantity = \"pressure-deviation\"\nwanted = { form = \"grid\", file = \"wanted.csv\" }",
        "quantity = \"open-area\"\npressure = 60.0",
        "quantity = \"stress-norm\"\nregion = { body = \"lower\", x1 = [0.0, 1e3] }",
        "quantity = \"compliance\"",
        "weight = \"area\"\nexponent = 6.0",
    ]
    .iter()
    .enumerate()
    {
        let file = folder.path().join(format!("{index}.toml"));
        std::fs::write(&file, format!("{base}\n[objective]\n{section}\n")).unwrap();
        let of_scene = |words: &[&str]| json(contact3d(), &[&[text(&file)], words, &["--mesh", "4"]].concat());
        let at_start = of_scene(&["evaluate", "--json"]);
        assert!(number(&at_start["objective"]).is_finite(), "{at_start}");
        let verified = of_scene(&["verify", "--json"]);
        assert!(number(&verified["best_derivative_error"]) < 1e-5, "{section}: {verified}");
        let out = folder.path().join(format!("run_{index}"));
        let run = of_scene(&["--max-evaluations", "3", "--json", "--out", text(&out)]);
        near(&run["objective_start"], number(&at_start["objective"]), 1e-9);
        assert!(number(&run["objective"]) <= number(&run["objective_start"]));
        assert!(out.join("report.html").exists() && out.join("vtk/fields.pvd").exists());
        let cuts = std::fs::read_to_string(out.join("figures/pressure_cuts.svg")).unwrap();
        assert_eq!(cuts.contains(">wanted<"), index == 0, "{section}");
        let recheck = of_scene(&["recheck", text(&out), "--json"]);
        assert_eq!(recheck["agrees"], true, "{recheck}");
        let resumed = json(contact3d(), &["--resume", text(&out), "--max-evaluations", "5", "--json"]);
        assert!(number(&resumed["resumed_evaluations"]) == number(&run["evaluations"]), "{resumed}");
        let at_once = of_scene(&["--max-evaluations", "5", "--json"]);
        assert!(resumed["objective"] == at_once["objective"] && resumed["controls"] == at_once["controls"]);
    }
}

/// `compare` solves without friction too, so that the scene must hold without it.
#[test]
fn a_function_of_the_displacements_is_compared_with_and_without_friction() {
    let limits = ["compare", "--mesh", "4", "--objective", "stress-norm", "--max-evaluations", "3", "--json"];
    let compared = json(contact3d(), &[&[scene("flat_punch.toml").as_str()], &limits[..]].concat());
    for shape in compared["shapes"].as_array().unwrap() {
        for key in ["objective_with_friction", "objective_without_friction"] {
            assert!(number(&shape[key]) > 0.0, "{shape}");
        }
    }
}

#[test]
fn options_and_fields_that_do_not_fit_the_objective_are_refused() {
    let refused = |options: &[&str], words: &[&str]| kit::refused(contact3d(), options, words);
    let (punch, support) = (scene("flat_punch.toml"), scene("support.toml"));
    refused(&[&punch, "--objective", "open-area"], &["objective.pressure = missing"]);
    refused(&[&punch, "--objective", "pressure-deviation"], &["objective.wanted = missing"]);
    refused(&[&punch, "--objective", "stress", "--optimizer", "composite"], &["--optimizer", "which has kinks"]);
    refused(&[&support, "--objective", "compliance", "--exponent", "3"], &["--exponent", "stress-norm"]);
    let printed = kit::run(contact3d(), &[&support, "--objective", "compliance", "--print-scene"]);
    let printed = String::from_utf8_lossy(&printed.stdout).into_owned();
    assert!(printed.contains("quantity = \"compliance\"") && !printed.contains("\nexponent ="), "{printed}");
    // A scene of the same measure keeps its weight; for another measure, the default holds.
    for (scene, weight) in [(&punch, "\nweight = \"nodes\""), (&support, "\n# weight is not set")] {
        let printed = kit::run(contact3d(), &[scene, "--objective", "pressure-norm", "--print-scene"]);
        let printed = String::from_utf8_lossy(&printed.stdout).into_owned();
        assert!(printed.contains("quantity = \"pressure-norm\"") && printed.contains(weight), "{printed}");
    }
}
