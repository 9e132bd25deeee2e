//! Limits of scenes, from the scene file to the report, on a small mesh of Example 5.2, and on a block under a ball.

use crate::binary;
use serde_json::Value;
use testset::kit::{json, scratch, text};

fn hertz3d() -> &'static str {
    binary("hertz3d").unwrap()
}

/// Runs `hertz3d` on a small mesh with a limit of the peak pressure.
fn limited(limit: f64, options: &[&str]) -> Value {
    let setting = format!("limit=[{{quantity=\"peak-pressure\", at_most={limit}}}]");
    let fixed = ["--mesh", "6", "--subdomains", "2", "--set", &setting, "--json"];
    json(hertz3d(), &[options, &fixed].concat())
}

/// What is wrong with a limit, as `contact3d` says it.
fn refusal(arguments: &[&str]) -> String {
    let output = std::process::Command::new(hertz3d()).args(arguments).output().unwrap();
    assert_eq!(output.status.code(), Some(2), "{output:?}");
    String::from_utf8(output.stderr).unwrap()
}

#[test]
fn limits_that_mean_nothing_are_refused_by_their_field() {
    let one = "{quantity=\"peak-pressure\", at_most=3400}";
    for (arguments, words) in [
        (vec!["--set", "limit=[{quantity=\"peak-pressure\", at_most=0}]"], "limit[0].at_most"),
        (vec!["--set", "limit=[{quantity=\"peak-pressure\", at_most=nan}]"], "limit[0].at_most"),
        (vec!["--set", "limit=[{quantity=\"peak-pressure\"}]"], "limit[0].at_most"),
        (vec!["--set", "limit=[{quantity=\"volume\", at_most=-1}]"], "limit[0].at_most"),
        (vec!["--set", "limit=[{quantity=\"volume\", at_most=1, case=\"one\"}]"], "limit[0].case"),
        (vec!["--set", "limit=[{quantity=\"stress\", at_most=1, exponent=8}]"], "limit[0].exponent"),
        (vec!["--set", "limit=[{quantity=\"loaded-area\", at_least=1}]"], "limit[0].pressure"),
        (vec!["--set", "limit=[{quantity=\"stress\", at_most=1, region={body=\"lowr\"}}]"], "lower"),
        (vec!["--set", "limit=[{quantity=\"displacement\", at_most=1, region={face=\"nose\"}}]"], "region.face"),
        (vec!["--set", "limit=[{quantity=\"stress\", at_most=1, at_least=1}]"], "limit[0].at_least"),
        (vec!["--set", "case=[{name=\"\"}]"], "case[0].name"),
        (vec!["--set", "case=[{name=\"a\"}, {name=\"a\"}]"], "case[1].name"),
        (vec!["--set", "case=[{name=\"a\", body=[{}]}]"], "case[0].body[0]"),
        (vec!["--set", "case=[{name=\"a\", loads=[]}]"], "case[0].loads"),
        (vec!["--set", &format!("limit=[{one}, {one}]")], "limit[1].quantity"),
    ] {
        let refused = refusal(&[&["evaluate"], arguments.as_slice()].concat());
        assert!(refused.contains(words), "{arguments:?}: {refused}");
    }
}

#[test]
fn a_shape_says_by_how_much_it_exceeds_its_limit() {
    let found = limited(3400.0, &["evaluate"]);
    let limit = &found["limits"][0];
    let peak = limit["end"].as_f64().unwrap();
    assert!((peak - 13019.175283).abs() < 1e-5 && limit["violation"].as_f64() == Some(peak - 3400.0), "{limit}");
    assert_eq!(limited(14000.0, &["evaluate"])["limits"][0]["violation"], 0.0);
}

/// Peak limits that are active at the optimum, and one that only the start exceeds.
#[test]
fn shapes_within_peak_limits_are_confirmed() {
    for (limit, active) in [(3455.3, true), (3702.2, false)] {
        let result = limited(limit, &["optimize", "--single"]);
        let found = &result["limits"][0];
        assert_eq!(result["termination"]["confirmed"], true, "{}", result["termination"]);
        assert_eq!((&found["satisfied"], &found["active"]), (&true.into(), &active.into()), "{found}");
        assert!(result["evaluations"].as_u64().unwrap() <= 35, "{}", result["evaluations"]);
    }
}

/// A flat block on a rigid ball: the peak pressure of the start is far beyond the limit, and less volume does not
/// lower it.
const BLOCK_ON_BALL: &str = r#"
name = "block on a ball"
friction = 0.2

[[body]]
material = { young_modulus = 1e5, poisson_ratio = 0.3 }
supports = [{ face = "x1-min", held = ["u1"] }, { face = "x2-min", held = ["u2"] }]
loads = [{ face = "bottom", traction = [0.0, 0.0, 40.0] }]
block = { size = [20.0, 20.0], bricks = [6, 6, 3] }

[body.lattice]
heights = "top"
control_points = [4, 4]
start = { form = "plane", height = 10.0 }
thickness = 8.0
slope = 0.5
volume = [0.0, 1e27]

[[contact]]
slave = { face = "top" }
obstacle = { form = "sphere", apex = 10.0, radius = 400.0 }

[objective]
quantity = "volume"

[[limit]]
quantity = "peak-pressure"
at_most = 60.0
"#;

#[test]
fn the_least_volume_within_a_peak_limit_is_confirmed_from_far_outside() {
    let folder = scratch();
    let file = folder.path().join("ball.toml");
    std::fs::write(&file, BLOCK_ON_BALL).unwrap();
    let found = json(binary("contact3d").unwrap(), &[text(&file), "optimize", "--single", "--json"]);
    let limit = &found["limits"][0];
    assert_eq!(found["termination"]["confirmed"], true, "{}", found["termination"]);
    assert!(limit["start"].as_f64().unwrap() > 150.0 && limit["satisfied"] == true, "{limit}");
    let volume = found["objective"].as_f64().unwrap();
    // Rounding decides which of two optima near each other is met, 3310.6 or 3318.7 mm³.
    assert!((volume / 3310.6 - 1.0).abs() < 4e-3, "{volume}");
    assert!(found["evaluations"].as_u64().unwrap() <= 55, "{}", found["evaluations"]);
}
