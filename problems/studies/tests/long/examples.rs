//! The worked examples of the tutorials are optimized to the numbers of their pages.

use problems::commands::{Arguments, execute};
use scene_file::SceneFile;
use serde_json::Value;
use std::path::Path;

/// Relative difference allowed for the objective; the run may end elsewhere on other processors.
const OBJECTIVE: f64 = 1e-3;

fn optimized(scene: &str) -> Value {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("../scenes/{scene}.toml"));
    let arguments = Arguments::try_parse_from(["contact3d", "optimize", "--json"]).unwrap();
    let open = || Ok((SceneFile::read(&path)?, Some(path.clone())));
    let run: Value = serde_json::from_str(&execute(open, &arguments).unwrap()).unwrap();
    assert_eq!(run["termination"]["confirmed"], true, "{scene}: {}", run["termination"]);
    let mut limits = run["limits"].as_array().into_iter().flatten();
    // A limit is kept to 1e-6 of its bound.
    assert!(
        limits.all(|limit| limit["violation"].as_f64().is_none_or(|over| over < 1e-2)),
        "{scene}: {}",
        run["limits"]
    );
    run
}

fn reaches(scene: &str, objective: f64, most_evaluations: u64) {
    let run = optimized(scene);
    let found = run["objective"].as_f64().unwrap();
    assert!((found / objective - 1.0).abs() < OBJECTIVE, "{scene}: {found} instead of {objective}");
    assert!(run["evaluations"].as_u64() <= Some(most_evaluations), "{scene}: {}", run["evaluations"]);
}

/// The page states a tolerance of a thousandth, and 18.5 MPa for the fourth root of the mean.
#[test]
fn the_seat_of_the_bracket_is_proved() {
    let run = optimized("bracket");
    let found = run["objective"].as_f64().unwrap();
    // Another path may end a little lower or higher.
    assert!(found < 3.6e8 && run["objective_start"].as_f64() > Some(9.2e10), "{found}");
    assert!(run["evaluations"].as_u64() <= Some(150), "{}", run["evaluations"]);
}

#[test]
fn the_crown_of_the_roller_is_proved() {
    reaches("roller", 2597.905, 36);
}

/// The objective of the taper is a squared deviation near 0, of which few digits are of use.
#[test]
fn the_profile_of_the_taper_is_proved() {
    let run = optimized("taper");
    let found = ["objective", "peak_pressure"].map(|key| match &run[key] {
        Value::Array(ends) => ends.last().and_then(Value::as_f64).unwrap(),
        value => value.as_f64().unwrap(),
    });
    assert!((found[0] - 0.2147).abs() < 0.01 && (found[1] - 41.45).abs() < 0.1, "{found:?}");
    assert!(run["evaluations"].as_u64() <= Some(40), "{}", run["evaluations"]);
}
