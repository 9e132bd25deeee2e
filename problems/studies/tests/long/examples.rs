//! The worked examples of the tutorials are optimized to the numbers of their pages.

use problems::commands::{Arguments, execute};
use scene_file::SceneFile;
use serde_json::Value;
use std::path::Path;
use testset::kit::facts::fact;

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

/// The page states a tolerance of a hundredth, and its numbers are shared ones.
#[test]
fn the_seat_of_the_bracket_is_confirmed() {
    let run = optimized("bracket");
    let found = run["objective"].as_f64().unwrap();
    // Another path may end a little lower or higher.
    assert!(found < 4.5e8 && run["objective_start"].as_f64() > Some(9.1e10), "{found}");
    assert!(run["evaluations"].as_f64() <= Some(2.0 * fact("bracket: evaluations")), "{}", run["evaluations"]);
    let peaks = [
        fact("bracket: peak pressure of the start, MPa, four digits"),
        fact("bracket: peak pressure of the optimum, MPa"),
    ];
    let found = [0, 1].map(|end| run["peak_pressure"][end].as_f64().unwrap());
    assert!((found[0] / peaks[0] - 1.0).abs() < 1e-3 && (found[1] / peaks[1] - 1.0).abs() < 0.08, "{found:?}");
}

#[test]
fn the_crown_of_the_roller_is_confirmed() {
    reaches("roller", 2593.454, 36);
}

/// The objective of the taper is a squared deviation near 0, of which few digits are of use.
#[test]
fn the_profile_of_the_taper_is_confirmed() {
    let run = optimized("taper");
    let found = ["objective", "peak_pressure"].map(|key| match &run[key] {
        Value::Array(ends) => ends.last().and_then(Value::as_f64).unwrap(),
        value => value.as_f64().unwrap(),
    });
    assert!((found[0] - 0.2038).abs() < 0.01 && (found[1] - 41.15).abs() < 0.1, "{found:?}");
    assert!(run["evaluations"].as_u64() <= Some(40), "{}", run["evaluations"]);
}

/// The optimum of one pair of meshes is evaluated on a finer pair: peak 3.5 %, Θ 5.1 %, its fourth root, which is a
/// pressure, 1.2 %.
#[test]
fn the_seat_of_the_ball_is_confirmed_and_holds_on_finer_meshes() {
    let run = optimized("ball_socket");
    assert!(run["evaluations"].as_u64() <= Some(20), "{}", run["evaluations"]);
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let scratch = testset::kit::scratch();
    let controls = scratch.path().join("controls.json");
    std::fs::write(&controls, run["controls"].to_string()).unwrap();
    let mesh = |body: usize, name: &str| {
        let file = root.join(format!("tests/data/curved/fine_{name}.msh")).canonicalize().unwrap();
        format!("body[{body}].mesh=\"{}\"", file.display())
    };
    let path = root.join("scenes/ball_socket.toml");
    let controls = controls.display().to_string();
    let (ball, socket) = (mesh(0, "ball"), mesh(1, "socket"));
    let words = ["contact3d", "evaluate", "--json", "--controls", &controls, "--set", &ball, "--set", &socket];
    let arguments = Arguments::try_parse_from(words).unwrap();
    let open = || Ok((SceneFile::read(&path)?, Some(path.clone())));
    let fine: Value = serde_json::from_str(&execute(open, &arguments).unwrap()).unwrap();
    for (name, root) in [("objective", 0.25), ("peak_pressure", 1.0)] {
        let last = |value: &Value| value.as_array().map_or_else(|| value.as_f64(), |ends| ends.last()?.as_f64());
        let [coarse, fine] = [&run[name], &fine[name]].map(|value| last(value).unwrap());
        assert!(((fine / coarse).powf(root) - 1.0).abs() < 0.05, "{name}: {coarse} {fine}");
    }
}
