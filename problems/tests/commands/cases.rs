//! Load cases of scene files, from the file to the report, on a small mesh of Example 5.2.

use crate::binary;
use serde_json::Value;
use std::path::Path;
use testset::kit::{json, scratch, text};

fn contact3d() -> &'static str {
    binary("contact3d").unwrap()
}

/// Example 5.2 pulled to either side and not at all, with its sphere moved along.
fn scene(folder: &Path, more: &str) -> String {
    let base = include_str!("../../scenes/hertz.toml");
    let case = |(name, pull): (&str, f64)| {
        let loads = format!(
            "[{{ face = \"top\", traction = [0.0, 0.0, -2000.0] }}, \
             {{ face = \"x1-max\", traction = [{pull:?}, 0.0, -2000.0] }}]"
        );
        let offset = pull / 1000.0;
        format!(
            "[[case]]\nname = \"{name}\"\nbody = [{{ name = \"upper\", offset = [{offset:?}, 0.0, 0.0], loads = {loads} }}]\n"
        )
    };
    let cases: Vec<String> = [("left", -500.0), ("still", 0.0), ("right", 500.0)].into_iter().map(case).collect();
    let path = folder.join("cases.toml");
    std::fs::write(&path, format!("{base}\n{}\n{more}", cases.join("\n"))).unwrap();
    text(&path).to_owned()
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or(f64::NAN)
}

#[test]
fn the_worst_of_three_cases_is_optimized_with_two_of_them_active() {
    let folder = scratch();
    let scene = scene(folder.path(), "");
    let found = json(contact3d(), &[&scene, "--single", "--mesh", "6", "--subdomains", "2", "--json"]);
    assert_eq!(found["termination"]["confirmed"], true, "{}", found["termination"]);
    // 13 were measured on 12³ bricks.
    assert!(found["evaluations"].as_u64() <= Some(25), "{}", found["evaluations"]);
    let cases = found["cases"].as_array().unwrap();
    let names: Vec<&str> = cases.iter().map(|case| case["name"].as_str().unwrap()).collect();
    assert_eq!(names, ["left", "still", "right"]);
    let multipliers: Vec<f64> = cases.iter().map(|case| number(&case["multiplier"])).collect();
    assert!((multipliers.iter().sum::<f64>() - 1.0).abs() < 1e-9, "{multipliers:?}");
    assert!(multipliers.iter().filter(|multiplier| **multiplier > 1e-3).count() >= 2, "{multipliers:?}");
    let worst = cases.iter().map(|case| number(&case["weighted_measure"])).fold(0.0, f64::max);
    assert!((worst / number(&found["objective"]) - 1.0).abs() < 1e-9, "{worst}");
    for case in cases {
        // Loads, contact and supports of each body are in balance.
        for body in case["resultants"]["bodies"].as_array().unwrap() {
            let mut sum = [0.0; 3];
            let supports = body["supports"].as_array().unwrap().iter().map(|support| &support["force"]);
            for force in [&body["loads"], &body["contact"]].into_iter().chain(supports) {
                (0..3).for_each(|axis| sum[axis] += number(&force[axis]));
            }
            let load = number(&case["total_normal_force"]);
            assert!(sum.iter().all(|entry| entry.abs() < 1e-8 * load), "{sum:?}");
        }
        assert!(number(&case["resultants"]["largest_stress"]["value"]) > 1000.0, "{case}");
    }
}

#[test]
fn equal_cases_are_solved_once_and_worth_a_single_one() {
    let folder = scratch();
    let loads = "load_factor = 1.5";
    let path = folder.path().join("equal.toml");
    let base = include_str!("../../scenes/hertz.toml");
    let value = |cases: &str| {
        std::fs::write(&path, format!("{base}\n{cases}")).unwrap();
        json(contact3d(), &[text(&path), "evaluate", "--mesh", "4", "--json"])
    };
    let single = value(&format!("[[case]]\nname = \"a\"\n{loads}\n"));
    let three = value(&["a", "b", "c"].map(|name| format!("[[case]]\nname = \"{name}\"\n{loads}\n")).join("\n"));
    assert_eq!(single["objective"], three["objective"]);
    assert_eq!(three["cases"].as_array().map(Vec::len), Some(1));
    assert_eq!(three["cases"][0]["equal"], serde_json::json!(["b", "c"]));
}

#[test]
fn limits_hold_in_all_cases_or_in_one_and_say_so() {
    let folder = scratch();
    let limits = "[[limit]]\nquantity = \"stress\"\nat_most = 5000.0\n\n\
                  [[limit]]\nquantity = \"displacement\"\naxis = \"x3\"\nat_least = -0.2\ncase = \"left\"\n";
    let scene = scene(folder.path(), limits);
    let found = json(contact3d(), &[&scene, "evaluate", "--mesh", "4", "--json"]);
    let limits = found["limits"].as_array().unwrap();
    let words: Vec<(&str, &str)> =
        limits.iter().map(|limit| (limit["quantity"].as_str().unwrap(), limit["case"].as_str().unwrap())).collect();
    assert_eq!(words, [("stress", "left"), ("stress", "still"), ("stress", "right"), ("displacement", "left")]);
    for (limit, case) in limits.iter().zip(found["cases"].as_array().unwrap()) {
        assert_eq!(limit["end"], case["resultants"]["largest_stress"]["value"]);
    }
}

#[test]
fn a_certificate_over_cases_is_computed_again_and_a_run_goes_on() {
    let folder = scratch();
    let scene = scene(folder.path(), "[[limit]]\nquantity = \"peak-pressure\"\nat_most = 9000.0\ncase = \"still\"\n");
    let out = folder.path().join("out");
    let options = ["--single", "--mesh", "4", "--out", text(&out), "--json"];
    let found = json(contact3d(), &[&[scene.as_str(), "--max-evaluations", "3"], &options[..]].concat());
    // A column of the table of the result is a shape in a case.
    let table: Value = serde_json::from_str(&std::fs::read_to_string(out.join("key_numbers.json")).unwrap()).unwrap();
    for (row, key) in [(0, "peak_pressure"), (1, "weighted_measure")] {
        for case in 0..3 {
            assert_eq!(table["rows"][row]["values"][3 + case], found["cases"][case][key], "{key} of case {case}");
        }
    }
    for file in ["pressure_optimal_case_1.csv", "pressure_optimal_case_3.csv", "report.html"] {
        assert!(out.join(file).exists(), "{file}");
    }
    let resumed = json(contact3d(), &["--resume", text(&out), "--max-evaluations", "60", "--json"]);
    assert_eq!(resumed["resumed_evaluations"], 3);
    assert_eq!(resumed["termination"]["confirmed"], true, "{}", resumed["termination"]);
    let again = json(contact3d(), &[&scene, "recheck", text(&out), "--mesh", "4", "--json"]);
    assert_eq!(again["agrees"], true, "{again}");
}

#[test]
fn the_lug_states_its_stresses_in_every_case() {
    let scene = format!("{}/scenes/lug_cases.toml", env!("CARGO_MANIFEST_DIR"));
    let found = json(contact3d(), &[&scene, "evaluate", "--json"]);
    let stresses: Vec<f64> =
        found["limits"].as_array().unwrap()[1..].iter().map(|limit| number(&limit["end"])).collect();
    assert!((stresses[0] / 3221.02 - 1.0).abs() < 1e-5, "{stresses:?}");
    assert_eq!(stresses.len(), 3);
}

/// A surface that may bend at a price bends less, and its objective says so.
#[test]
fn fairness_is_a_part_of_the_objective() {
    let fairness = |weight: &str| format!("body[0].lattice.fairness={weight}");
    let hertz = format!("{}/scenes/hertz.toml", env!("CARGO_MANIFEST_DIR"));
    let run = |options: &[&str]| {
        let fixed = [hertz.as_str(), "--single", "--mesh", "4", "--subdomains", "2", "--json"];
        json(contact3d(), &[&fixed[..], options].concat())
    };
    let bends = |found: &Value| {
        let heights: Vec<f64> = found["controls"].as_array().unwrap().iter().map(number).collect();
        let second = |i: usize, step: usize| (heights[i] - 2.0 * heights[i + step] + heights[i + 2 * step]).powi(2);
        let along = (0..6).flat_map(|row| (0..4).map(move |i| (6 * row + i, 1)));
        let across = (0..24).map(|i| (i, 6));
        along.chain(across).map(|(i, step)| second(i, step)).sum::<f64>()
    };
    let (free, fair) = (run(&[]), run(&["--set", &fairness("1e15")]));
    assert_eq!(fair["termination"]["confirmed"], true, "{}", fair["termination"]);
    assert!(bends(&fair) < 0.9 * bends(&free), "{} {}", bends(&fair), bends(&free));
    let refused = std::process::Command::new(contact3d()).args([&hertz, "--set", &fairness("-1")]).output().unwrap();
    assert!(String::from_utf8_lossy(&refused.stderr).contains("lattice.fairness"));
}

#[test]
fn a_case_is_exported_by_its_name() {
    let folder = scratch();
    let scene = scene(folder.path(), "");
    let out = folder.path().join("out");
    let export =
        [scene.as_str(), "export", "--friction-problem", "--mesh", "2", "--subdomains", "1", "--out", text(&out)];
    let run = |options: &[&str]| {
        let output = std::process::Command::new(contact3d()).args([&export[..], options].concat()).output().unwrap();
        (output.status.code(), String::from_utf8(output.stderr).unwrap())
    };
    for (options, words) in [(&[][..], "left, still, right"), (&["--case", "rigt"], "right")] {
        let (status, message) = run(options);
        assert!(status == Some(2) && message.contains("--case") && message.contains(words), "{message}");
    }
    let loads = |name: &str| {
        assert_eq!(run(&["--case", name, "--overwrite"]).0, Some(0));
        let lists = std::fs::read_to_string(out.join("friction/problem.json")).unwrap();
        serde_json::from_str::<Value>(&lists).unwrap()["load"].clone()
    };
    assert_ne!(loads("left"), loads("right"));
}

#[test]
fn a_comparison_takes_friction_from_every_case() {
    let folder = scratch();
    let path = folder.path().join("cases.toml");
    let base = include_str!("../../scenes/hertz.toml");
    let cases = "[[case]]\nname = \"a\"\nfriction = 0.2\n\n[[case]]\nname = \"b\"\nload_factor = 0.9\n";
    std::fs::write(&path, format!("{base}\n{cases}")).unwrap();
    let out = folder.path().join("out");
    let options = ["compare", "--mesh", "4", "--max-evaluations", "2", "--out", text(&out), "--json"];
    json(contact3d(), &[&[text(&path)], &options[..]].concat());
    let without = out.join("without_friction/scene.toml");
    let read = std::fs::read_to_string(&without);
    let names: Vec<_> = std::fs::read_dir(&out).unwrap().map(|entry| entry.unwrap().file_name()).collect();
    let text = read.unwrap_or_else(|_| panic!("{names:?}"));
    assert!(!text.contains("friction = 0.2"), "{text}");
}

/// A factor on all loads acts on those that a case states in place of the scene's.
#[test]
fn the_factor_on_loads_acts_on_those_of_cases() {
    let scene = format!("{}/scenes/bracket.toml", env!("CARGO_MANIFEST_DIR"));
    let loads = |options: &[&str]| -> Vec<f64> {
        let seen = json(contact3d(), &[&[scene.as_str(), "look", "--json"], options].concat());
        let cases = seen["cases"].as_array().unwrap();
        cases.iter().map(|case| case["before"]["bodies"][0]["load"][2].as_f64().unwrap()).collect()
    };
    let (once, twice) = (loads(&[]), loads(&["--load-factor", "2"]));
    assert!(once.len() == 3 && once.iter().all(|force| *force < -3e4), "{once:?}");
    for (once, twice) in once.iter().zip(&twice) {
        assert!((twice / once - 2.0).abs() < 1e-12, "{once} {twice}");
    }
}
