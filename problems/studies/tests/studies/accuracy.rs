//! The accuracy binary's contract: tables, JSON, CSV, pictures, exit statuses; and that what it reports is sound.

use serde_json::Value;
use std::process::{Command, Output};

fn run(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_accuracy")).args(arguments).output().unwrap()
}

#[test]
fn the_smallest_study_holds_what_it_promises() {
    let folder = std::env::temp_dir().join(format!("nonsmooth-accuracy-{}", std::process::id()));
    let output = run(&["--smoke", "--json", "--out", folder.to_str().unwrap()]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let report: Value = serde_json::from_slice(&output.stdout).unwrap();
    let rows = |value: &Value| value.as_array().unwrap().clone();
    for study in rows(&report["algebra"]) {
        assert_eq!(study["violations"], 0, "a bound below the true error: {study}");
        // Six solvers, three tolerances; the tightest of each is accurate.
        assert_eq!(rows(&study["rows"]).len(), 18);
        for row in rows(&study["rows"]).iter().filter(|row| row["tolerance"].as_f64().unwrap() < 1e-9) {
            assert!(row["value"].as_f64().unwrap() < 1e-10 && row["subgradient"].as_f64().unwrap() < 1e-8, "{row}");
        }
    }
    for taylor in rows(&report["subgradient"]["taylor"]) {
        assert!((taylor["test"]["fitted_slope"].as_f64().unwrap() - 2.0).abs() < 0.1, "{taylor}");
    }
    let kinks = rows(&report["subgradient"]["kinks"]);
    assert_eq!(kinks.len(), 5);
    for kink in kinks {
        assert_eq!(kink["bracketed"], true, "{kink}");
        assert!(kink["weakly_active"].as_u64().unwrap() >= 1, "{kink}");
    }
    for course in rows(&report["optimization"][0]["courses"]) {
        assert!(course["value"].as_f64().unwrap() < report["optimization"][0]["start"].as_f64().unwrap());
    }
    for name in ["report.json", "report.md", "report.csv", "accuracy_mesh_hertz.svg", "accuracy_taylor.svg"] {
        let text = std::fs::read_to_string(folder.join(name)).unwrap();
        assert!(text.len() > 500 && !text.contains("NaN"), "{name}");
    }
    std::fs::remove_dir_all(folder).unwrap();
}

#[test]
fn one_part_as_csv() {
    let output = run(&["--smoke", "--part", "subgradient", "--csv"]);
    let text = String::from_utf8(output.stdout).unwrap();
    assert!(output.status.success() && text.starts_with("part,scene,series,parameter,quantity,value\n"));
    assert!(text.lines().all(|line| line.split(',').count() == 6) && !text.contains("algebra"), "{text}");
}

#[test]
fn contradictory_options_are_refused() {
    for arguments in [["--quick", "--full"], ["--json", "--csv"], ["--part", "nothing"]] {
        let output = run(&arguments);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}");
        assert!(output.stdout.is_empty() && !output.stderr.is_empty());
    }
}
