//! The binary that takes any scene: files, overrides, printed scenes, refusals.

use std::path::Path;
use testset::kit::{self, json, text};

const CONTACT: &str = env!("CARGO_BIN_EXE_contact3d");
const HERTZ: &str = env!("CARGO_BIN_EXE_hertz3d");

fn scene(name: &str) -> String {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes").join(name).display().to_string()
}

fn refused(arguments: &[&str], words: &[&str]) {
    kit::refused(CONTACT, arguments, words);
}

/// Built in, read from its file, or printed with options and read back: the same numbers to the last bit.
#[test]
fn a_scene_is_the_same_from_wherever_it_comes() {
    let options = ["evaluate", "--mesh", "4", "--friction", "0.2", "--json"];
    let built_in = json(HERTZ, &options);
    let from_file = json(CONTACT, &[&[scene("hertz.toml").as_str()], &options[..]].concat());
    let printed = kit::run(HERTZ, &["--mesh", "4", "--friction", "0.2", "--print-scene"]);
    assert!(String::from_utf8_lossy(&printed.stdout).contains("\nfriction = 0.2\n"));
    let folder = kit::scratch();
    let file = folder.path().join("mine.toml");
    std::fs::write(&file, printed.stdout).unwrap();
    let from_print = json(CONTACT, &[text(&file), "evaluate", "--json"]);
    for key in ["objective", "subgradient", "status", "residuals"] {
        assert!(built_in[key] == from_file[key] && built_in[key] == from_print[key], "{key}");
    }
}

#[test]
fn grids_are_found_beside_the_scene_and_travel_with_a_run() {
    let folder = kit::scratch();
    let out = folder.path().join("run");
    let limits = ["--mesh", "4", "--optimizer", "bundle", "--max-evaluations", "2", "--json", "--out", text(&out)];
    json(CONTACT, &[&[scene("flat_punch.toml").as_str()], &limits[..]].concat());
    assert!(out.join("obstacle.csv").exists() && out.join("figures/pressure.svg").exists());
    let resumed = json(CONTACT, &["--resume", text(&out), "--max-evaluations", "4", "--json"]);
    assert_eq!(resumed["evaluations"], 4);
    assert_eq!(resumed["resumed_evaluations"], 2);
}

#[test]
fn the_schema_is_printed_with_and_without_a_scene() {
    let schema = json(CONTACT, &["--print-schema"]);
    assert_eq!(schema, json(env!("CARGO_BIN_EXE_signorini3d"), &["--print-schema"]));
    assert!(schema["properties"]["friction"]["description"].is_string());
    assert_eq!(schema["additionalProperties"], false);
}

#[test]
fn what_is_no_scene_is_refused_with_the_file_and_the_field() {
    refused(&[], &["SCENE.toml is missing", "problems/scenes"]);
    refused(&["none.toml"], &["none.toml"]);
    refused(&[&scene("hertz.toml"), "--resume", "somewhere"], &["--resume"]);
    let folder = kit::scratch();
    let file = folder.path().join("bad.toml");
    let hertz = std::fs::read_to_string(scene("hertz.toml")).unwrap();
    for (right, wrong, words) in [
        ("friction = 0.3", "frction = 0.3", ["bad.toml", "did you mean `friction`?"]),
        ("[2, 2, 2]", "[2, 2, 5]", ["bad.toml: body[0].block.subdomains[2] = 5", "divisor of the 12"]),
        (
            "radius = 20.0",
            "radius = 2.0",
            ["bad.toml: what lies opposite to top of lower at (0, 4) = NaN", "finite heights over the whole base"],
        ),
        ("height = 10.0", "height = 10.5", ["admissible", "10.5"]),
        ("volume = [800.0, 1200.0]", "volume = [1200.0, 800.0]", ["1200", "800"]),
    ] {
        assert!(hertz.contains(right), "{right}");
        std::fs::write(&file, hertz.replacen(right, wrong, 1)).unwrap();
        refused(&[text(&file), "evaluate"], &words);
    }
}
