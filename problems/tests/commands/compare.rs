//! `compare`: Example 5.3 as one command, its numbers checked by commands of their own.

use serde_json::Value;
use std::path::Path;
use testset::kit;

const SIGNORINI: &str = env!("CARGO_BIN_EXE_signorini3d");
const SMALL: [&str; 7] = ["compare", "--mesh", "4", "--optimizer", "bundle", "--max-evaluations", "12"];

fn json(arguments: &[&str]) -> Value {
    kit::json(SIGNORINI, arguments)
}

fn refused(arguments: &[&str], words: &[&str]) {
    kit::refused(SIGNORINI, arguments, words);
}

/// `evaluate` at the optimum that a run left in a folder.
fn evaluated(folder: &Path, friction: &str) -> f64 {
    let controls = folder.join("controls.json");
    let arguments = ["evaluate", "--mesh", "4", "--friction", friction, "--json", "--controls", kit::text(&controls)];
    json(&arguments)["objective"].as_f64().unwrap()
}

#[test]
fn the_table_is_what_separate_commands_find() {
    let scratch = kit::scratch();
    let folder = scratch.path();
    let mut arguments = SMALL.to_vec();
    arguments.extend(["--json", "--out", kit::text(folder)]);
    let compared = json(&arguments);
    let value = |row: usize, key: &str| compared["shapes"][row][key].as_f64().unwrap();
    for (row, part) in [(1, "with_friction"), (2, "without_friction")] {
        for (friction, key) in [("0.3", "objective_with_friction"), ("0", "objective_without_friction")] {
            let expected = evaluated(&folder.join(part), friction);
            assert!((value(row, key) / expected - 1.0).abs() < 1e-9, "{part}, friction {friction}");
        }
        let own = kit::read_json(&folder.join(part).join("report.json"));
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
    let arguments = ["compare", "--resume", kit::text(folder), "--max-evaluations", "15", "--json"];
    let continued = json(&arguments);
    let at_once = json(&["compare", "--mesh", "4", "--optimizer", "bundle", "--max-evaluations", "15", "--json"]);
    assert_eq!(continued["shapes"], at_once["shapes"]);
    // Fewer evaluations than it has are refused, and nothing is touched.
    let kept = std::fs::read(folder.join("report.json")).unwrap();
    refused(&["compare", "--resume", kit::text(folder), "--max-evaluations", "3"], &["at least the 15"]);
    assert_eq!(std::fs::read(folder.join("report.json")).unwrap(), kept);
    // Neither kind of run is taken for the other.
    refused(&["--resume", kit::text(folder)], &["comparison", "compare --resume"]);
    let part = folder.join("with_friction");
    refused(&["compare", "--resume", kit::text(&part)], &["optimization", "--resume"]);
}

#[test]
fn a_scene_without_friction_has_nothing_to_compare() {
    refused(&["compare", "--mesh", "4", "--friction", "0"], &["friction = 0", "> 0"]);
}

#[test]
fn a_comparison_that_is_cut_short_says_so_and_is_no_success() {
    let mut arguments = SMALL.to_vec();
    arguments.extend(["--time-limit", "1e-9"]);
    let output = kit::run(SIGNORINI, &arguments);
    let (text, message) = (String::from_utf8_lossy(&output.stdout), kit::errors(&output));
    assert_eq!(output.status.code(), Some(1), "{message}");
    assert!(text.contains("the comparison is not complete") && message.contains("time limit"), "{text}{message}");
}

#[test]
fn a_used_folder_is_renamed_and_never_answers_for_another_scene() {
    let scratch = kit::scratch();
    let folder = scratch.path().join("run");
    let path = kit::text(&folder);
    let small = ["compare", "--mesh", "3", "--max-evaluations", "4", "--json"];
    let compare = |more: &[&str]| kit::run(SIGNORINI, &[&small[..], &["--out", path], more].concat());
    let first = kit::parsed(&compare(&[]));
    // Another load in the same folder, cut short at once, then continued: what is continued is that load.
    let half = ["--load-factor", "0.5"];
    assert_eq!(compare(&half).status.code(), Some(2));
    assert_eq!(compare(&[&half[..], &["--time-limit", "1e-9", "--overwrite"]].concat()).status.code(), Some(1));
    let renamed = kit::read_json(&scratch.path().join("run.1/report.json"));
    assert_eq!(renamed, first);
    // A comparison that has not ended is not replaced.
    refused(&[&small[..], &["--out", path]].concat(), &["has not ended", "compare --resume", path]);
    let continued = json(&["compare", "--resume", path, "--time-limit", "1000", "--json"]);
    let fresh = json(&[&small[..], &half].concat());
    assert_eq!(continued["shapes"], fresh["shapes"]);
    // Of another kind of run nothing is left in the folder.
    let taken = ["--mesh", "3", "--max-evaluations", "2", "--json", "--overwrite", "--out", path];
    json(&taken);
    assert!(scratch.path().join("run.2/with_friction").exists() && !folder.join("with_friction").exists());
    json(&["--resume", path, "--max-evaluations", "3", "--json"]);
}

#[test]
fn a_state_without_contact_says_so() {
    let scratch = kit::scratch();
    let file = scratch.path().join("nocontact.toml");
    std::fs::write(&file, NEVER_TOUCHES).unwrap();
    let state = kit::json(env!("CARGO_BIN_EXE_contact3d"), &[kit::text(&file), "evaluate", "--json"]);
    assert!(state["warnings"].as_array().unwrap().iter().any(|warning| warning["code"] == "no-contact"), "{state}");
}

#[test]
fn objectives_that_reach_zero_are_compared_in_words() {
    let scratch = kit::scratch();
    let file = scratch.path().join("nocontact.toml");
    std::fs::write(&file, NEVER_TOUCHES).unwrap();
    let contact = env!("CARGO_BIN_EXE_contact3d");
    let compared = kit::json(contact, &[kit::text(&file), "compare", "--max-evaluations", "5", "--json"]);
    assert!(compared["loss_without_friction_in_the_model"].is_null());
    let first = compared["conclusion"][0].as_str().unwrap();
    assert!(first.contains("zero up to rounding") && !first.contains("times"), "{first}");
}

/// A body that does not reach its counterpart: both objectives are zero from the start on.
pub const NEVER_TOUCHES: &str = r#"
name = "never touches"
friction = 0.3

[[body]]
name = "lower"
material = { young_modulus = 2.1e5, poisson_ratio = 0.3 }

[body.block]
size = [20.0, 20.0]
bricks = [4, 4, 4]

[[body.supports]]
face = "bottom"
held = ["u1", "u2", "u3"]

[[body.loads]]
face = "x1-max"
traction = [0.0, 0.0, -1.0]

[body.lattice]
heights = "top"
start = { form = "plane", height = 20.0 }
thickness = 15.0
slope = 1.0
volume = [1000.0, 9000.0]

[[contact]]
slave = { face = "top" }

[contact.obstacle]
form = "plane"
height = 21.0
"#;
