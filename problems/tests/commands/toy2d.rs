//! The binary `toy2d`: its page, its JSON, its landscape, its exit statuses.

use serde_json::Value;
use std::process::{Command, Output};

fn toy2d(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_toy2d")).args(arguments).output().expect("the binary runs")
}

#[test]
fn twenty_random_starts_find_the_minimiser() {
    let output = toy2d(&["--json"]);
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    let study: Value = serde_json::from_slice(&output.stdout).expect("one JSON object");
    let runs = study["runs"].as_array().expect("runs");
    assert_eq!(runs.len(), 20);
    for run in runs {
        assert!(run["error"].as_f64().is_some_and(|error| error <= 1e-8), "{run}");
    }
    assert!((study["best"]["value"].as_f64().expect("number") - 1.5390625).abs() < 1e-9);
}

#[test]
fn page_names_the_minimiser_and_its_kinks() {
    let output = toy2d(&["--start", "-3,5"]);
    let page = String::from_utf8_lossy(&output.stdout);
    assert_eq!(output.status.code(), Some(0), "{page}");
    assert!(page.contains("exact (0.25, 1.25)"), "{page}");
    assert!(page.contains("from the kink slip forward | stick at height 0.5"), "{page}");
    assert!(page.contains("found by:    1 of 1 runs"), "{page}");
}

#[test]
fn landscape_is_written() {
    let file = std::env::temp_dir().join(format!("toy2d-landscape-{}.csv", std::process::id()));
    let output = toy2d(&["--start", "0,0", "--cells", "10", "--landscape", file.to_str().expect("text")]);
    assert_eq!(output.status.code(), Some(0));
    let text = std::fs::read_to_string(&file).expect("the landscape");
    std::fs::remove_file(&file).expect("removable");
    assert_eq!(text.lines().count(), 1 + 11 * 11);
}

#[test]
fn pictures_show_every_evaluation_of_the_first_run() {
    let folder = std::env::temp_dir().join(format!("toy2d-pictures-{}", std::process::id()));
    let output = toy2d(&["--start", "-3,5", "--cells", "40", "--json", "--out", folder.to_str().expect("text")]);
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    let study: Value = serde_json::from_slice(&output.stdout).expect("one JSON object");
    let evaluations = study["runs"][0]["evaluations"].as_u64().expect("a number") as usize;
    let svg = std::fs::read_to_string(folder.join("landscape.svg")).expect("the landscape");
    let marks = ["start", "serious", "null", "refined"].map(|kind| svg.matches(&format!("class=\"{kind}\"")).count());
    assert_eq!(marks.iter().sum::<usize>(), evaluations, "{marks:?}");
    assert!(folder.join("convergence.svg").exists());
    std::fs::remove_dir_all(&folder).expect("removable");
}

#[test]
fn bad_input_ends_with_status_2_and_a_reason() {
    for (arguments, reason) in [
        (vec!["--start", "1"], "--start"),
        (vec!["--start", "1,NaN"], "--start"),
        (vec!["--start", "1,7"], "between -4 and 6"),
        (vec!["--starts", "0"], "--starts"),
        (vec!["--landscape", "/nonexistent/folder/file.csv"], "--landscape"),
        (vec!["--cells", "0"], "--cells"),
    ] {
        let output = toy2d(&arguments);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}");
        let message = String::from_utf8_lossy(&output.stderr);
        assert!(message.contains(reason), "{arguments:?}: {message}");
    }
}
