//! `compare`: Example 5.3 as one command, its numbers checked by commands of their own.

use serde_json::Value;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

const SMALL: [&str; 5] = ["compare", "--mesh", "4", "--max-evaluations", "12"];

fn run(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_signorini3d")).args(arguments).env_remove("RUST_LOG").output().unwrap()
}

fn json(arguments: &[&str]) -> Value {
    let output = run(arguments);
    assert!(output.status.success(), "{arguments:?}: {}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice(&output.stdout).unwrap()
}

fn refused(arguments: &[&str], words: &[&str]) {
    let output = run(arguments);
    let message = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(2), "{arguments:?}: {message}");
    assert!(words.iter().all(|word| message.contains(word)), "{arguments:?}: {message}");
}

fn scratch(name: &str) -> PathBuf {
    let path = std::env::temp_dir().join(format!("nonsmooth-compare-{}-{name}", std::process::id()));
    let _absent = std::fs::remove_dir_all(&path);
    path
}

/// `evaluate` at the optimum that a run left in a folder.
fn evaluated(folder: &Path, friction: &str) -> f64 {
    let controls = folder.join("controls.json");
    let arguments =
        ["evaluate", "--mesh", "4", "--friction", friction, "--json", "--controls", controls.to_str().unwrap()];
    json(&arguments)["objective"].as_f64().unwrap()
}

#[test]
fn the_table_is_what_separate_commands_find() {
    let folder = scratch("table");
    let mut arguments = SMALL.to_vec();
    arguments.extend(["--json", "--out", folder.to_str().unwrap()]);
    let compared = json(&arguments);
    let value = |row: usize, key: &str| compared["shapes"][row][key].as_f64().unwrap();
    for (row, part) in [(1, "with_friction"), (2, "without_friction")] {
        for (friction, key) in [("0.3", "objective_with_friction"), ("0", "objective_without_friction")] {
            let expected = evaluated(&folder.join(part), friction);
            assert!((value(row, key) / expected - 1.0).abs() < 1e-9, "{part}, friction {friction}");
        }
        let own: Value =
            serde_json::from_slice(&std::fs::read(folder.join(part).join("report.json")).unwrap()).unwrap();
        assert_eq!(own["evaluations"], compared["evaluations"][row - 1]);
    }
    // Each shape is the better one in its own model, and both are better than the start.
    assert!(value(1, "objective_with_friction") < value(2, "objective_with_friction"));
    assert!(value(2, "objective_without_friction") < value(1, "objective_without_friction"));
    assert!(value(2, "objective_with_friction") < value(0, "objective_with_friction"));
    let loss = compared["loss_without_friction_in_the_model"].as_f64().unwrap();
    assert!((loss * value(1, "objective_with_friction") / value(2, "objective_with_friction") - 1.0).abs() < 1e-12);
    assert!(!compared["conclusion"].as_array().unwrap().is_empty());
    // Continued with more evaluations, it is the comparison that would have been made with them at once.
    let arguments = ["compare", "--resume", folder.to_str().unwrap(), "--max-evaluations", "15", "--json"];
    let continued = json(&arguments);
    let at_once = json(&["compare", "--mesh", "4", "--max-evaluations", "15", "--json"]);
    assert_eq!(continued["shapes"], at_once["shapes"]);
    // Fewer evaluations than it has are refused, and nothing is touched.
    let kept = std::fs::read(folder.join("report.json")).unwrap();
    refused(&["compare", "--resume", folder.to_str().unwrap(), "--max-evaluations", "3"], &["at least the 15"]);
    assert_eq!(std::fs::read(folder.join("report.json")).unwrap(), kept);
    // Neither kind of run is taken for the other.
    refused(&["--resume", folder.to_str().unwrap()], &["comparison", "compare --resume"]);
    let part = folder.join("with_friction");
    refused(&["compare", "--resume", part.to_str().unwrap()], &["optimization", "optimize --resume"]);
    std::fs::remove_dir_all(folder).unwrap();
}

#[test]
fn a_scene_without_friction_has_nothing_to_compare() {
    refused(&["compare", "--mesh", "4", "--friction", "0"], &["friction = 0", "> 0"]);
}

#[test]
fn a_comparison_that_is_cut_short_says_so_and_is_no_success() {
    let mut arguments = SMALL.to_vec();
    arguments.extend(["--time-limit", "1e-9"]);
    let output = run(&arguments);
    let (text, message) = (String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr));
    assert_eq!(output.status.code(), Some(1), "{message}");
    assert!(text.contains("the comparison is not complete") && message.contains("time limit"), "{text}{message}");
}

#[test]
fn a_used_folder_never_answers_for_another_scene() {
    let folder = scratch("used");
    let path = folder.to_str().unwrap();
    let compare = |more: &[&str]| {
        let mut arguments = vec!["compare", "--mesh", "3", "--max-evaluations", "4", "--json"];
        arguments.extend(["--out", path]);
        arguments.extend(more);
        run(&arguments)
    };
    assert!(compare(&[]).status.success());
    // Another load in the same folder, cut short at once, then continued: what is continued is that load.
    assert_eq!(compare(&["--load-factor", "0.5", "--time-limit", "1e-9"]).status.code(), Some(1));
    let continued = json(&["compare", "--resume", path, "--time-limit", "1000", "--json"]);
    let fresh = json(&["compare", "--mesh", "3", "--max-evaluations", "4", "--load-factor", "0.5", "--json"]);
    assert_eq!(continued["shapes"], fresh["shapes"]);
    // A comparison that has not ended is not replaced, nor is its scene.
    std::fs::remove_file(folder.join("report.json")).unwrap();
    let scene = std::fs::read(folder.join("scene.toml")).unwrap();
    let refused = compare(&["--load-factor", "2"]);
    let message = String::from_utf8_lossy(&refused.stderr).into_owned();
    assert!(refused.status.code() == Some(2) && message.contains("has not ended"), "{message}");
    assert_eq!(std::fs::read(folder.join("scene.toml")).unwrap(), scene);
    // An optimization takes over the folder of a comparison that has ended, and can be continued as one.
    json(&["compare", "--resume", path, "--json"]);
    let taken = run(&["--mesh", "3", "--max-evaluations", "2", "--json", "--out", path]);
    assert!(taken.status.success(), "{}", String::from_utf8_lossy(&taken.stderr));
    json(&["--resume", path, "--max-evaluations", "3", "--json"]);
    std::fs::remove_dir_all(folder).unwrap();
}
