//! The binary that takes any scene: files, overrides, printed scenes, refusals.

use serde_json::Value;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

fn run(binary: &str, arguments: &[&str]) -> Output {
    Command::new(binary).args(arguments).output().unwrap()
}

fn contact3d(arguments: &[&str]) -> Output {
    run(env!("CARGO_BIN_EXE_contact3d"), arguments)
}

fn scene(name: &str) -> String {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes").join(name).display().to_string()
}

fn json(output: &Output) -> Value {
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice(&output.stdout).unwrap()
}

fn refused(arguments: &[&str], words: &[&str]) {
    let output = contact3d(arguments);
    let message = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(2), "{arguments:?}: {message}");
    assert!(words.iter().all(|word| message.contains(word)), "{arguments:?}: {message}");
}

fn scratch(name: &str) -> PathBuf {
    let folder = std::env::temp_dir().join(format!("nonsmooth-contact3d-{}-{name}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    folder
}

/// Built in, read from its file, or printed with options and read back: the same numbers to the last bit.
#[test]
fn a_scene_is_the_same_from_wherever_it_comes() {
    let options = ["evaluate", "--mesh", "4", "--friction", "0.2", "--json"];
    let built_in = run(env!("CARGO_BIN_EXE_hertz3d"), &options);
    let from_file = contact3d(&[&[scene("hertz.toml").as_str()], &options[..]].concat());
    let printed = run(env!("CARGO_BIN_EXE_hertz3d"), &["--mesh", "4", "--friction", "0.2", "--print-scene"]);
    assert!(String::from_utf8_lossy(&printed.stdout).contains("\nfriction = 0.2\n"));
    let folder = scratch("printed");
    let file = folder.join("mine.toml");
    std::fs::write(&file, printed.stdout).unwrap();
    let from_print = contact3d(&[file.to_str().unwrap(), "evaluate", "--json"]);
    let [a, b, c] = [built_in, from_file, from_print].map(|output| json(&output));
    for key in ["objective", "subgradient", "status", "residuals"] {
        assert!(a[key] == b[key] && a[key] == c[key], "{key}");
    }
    std::fs::remove_dir_all(folder).unwrap();
}

#[test]
fn grids_are_found_beside_the_scene_and_travel_with_a_run() {
    let folder = scratch("grid");
    let out = folder.join("run");
    let limits = ["--mesh", "4", "--max-evaluations", "2", "--json", "--out", out.to_str().unwrap()];
    json(&contact3d(&[&[scene("flat_punch.toml").as_str()], &limits[..]].concat()));
    assert!(out.join("counter_surface.csv").exists() && out.join("figures/pressure.svg").exists());
    let resumed = json(&contact3d(&["--resume", out.to_str().unwrap(), "--max-evaluations", "4", "--json"]));
    assert_eq!(resumed["evaluations"], 4);
    assert_eq!(resumed["resumed_evaluations"], 2);
    std::fs::remove_dir_all(folder).unwrap();
}

#[test]
fn the_schema_is_printed_with_and_without_a_scene() {
    let schema = json(&contact3d(&["--print-schema"]));
    assert_eq!(schema, json(&run(env!("CARGO_BIN_EXE_signorini3d"), &["--print-schema"])));
    assert!(schema["properties"]["friction"]["description"].is_string());
    assert_eq!(schema["additionalProperties"], false);
}

#[test]
fn what_is_no_scene_is_refused_with_the_file_and_the_field() {
    refused(&[], &["SCENE.toml is missing", "problems/scenes"]);
    refused(&["none.toml"], &["none.toml"]);
    refused(&[&scene("hertz.toml"), "--resume", "somewhere"], &["--resume"]);
    let folder = scratch("bad");
    let file = folder.join("bad.toml");
    let text = std::fs::read_to_string(scene("hertz.toml")).unwrap();
    for (right, wrong, words) in [
        ("friction = 0.3", "frction = 0.3", ["bad.toml", "did you mean `friction`?"]),
        ("[2, 2, 2]", "[2, 2, 5]", ["bad.toml: subdomains (axis 3) = 5", "divisor of the 12"]),
        (
            "radius = 20.0",
            "radius = 2.0",
            ["bad.toml: counter surface at (10, 0) = NaN", "finite heights over the whole base"],
        ),
        ("height = 10.0", "height = 10.5", ["admissible", "10.5"]),
        ("volume = [800.0, 1200.0]", "volume = [1200.0, 800.0]", ["1200", "800"]),
    ] {
        assert!(text.contains(right), "{right}");
        std::fs::write(&file, text.replacen(right, wrong, 1)).unwrap();
        refused(&[file.to_str().unwrap(), "evaluate"], &words);
    }
    std::fs::remove_dir_all(folder).unwrap();
}
