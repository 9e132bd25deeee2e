//! Quantities of a scene file: the same words in objective, limits and reports, and the same numbers everywhere.

use crate::binary;
use serde_json::Value;
use testset::kit::{json, refused, scratch, text};

fn contact3d() -> &'static str {
    binary("contact3d").unwrap()
}

fn hertz() -> String {
    format!("{}/scenes/hertz.toml", env!("CARGO_MANIFEST_DIR"))
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or(f64::NAN)
}

/// Every quantity with what it needs, as entries of a list in TOML.
const ALL: [&str; 20] = [
    "quantity=\"pressure-norm\"",
    "quantity=\"peak-pressure\"",
    "quantity=\"pressure-deviation\", wanted={form=\"formula\", pressure=\"900 + 3*x1\"}",
    "quantity=\"open-area\", pressure=500",
    "quantity=\"loaded-area\", pressure=500",
    "quantity=\"mean-pressure\"",
    "quantity=\"contact-force\", axis=\"x1\"",
    "quantity=\"contact-moment\", axis=\"x2\", about=[25, 50, 100]",
    "quantity=\"friction-work\"",
    "quantity=\"slip\"",
    "quantity=\"reaction\", region={face=\"x1-min\", body=\"lower\"}",
    "quantity=\"stress\", without_held=true",
    "quantity=\"stress-norm\"",
    "quantity=\"displacement\", region={face=\"top\", body=\"upper\"}, axis=\"x3\"",
    "quantity=\"displacement\", region={face=\"x1-max\", body=\"lower\"}, relative_to={face=\"bottom\", body=\"lower\"}",
    "quantity=\"compliance\"",
    "quantity=\"volume\"",
    "quantity=\"relative-volume\"",
    "quantity=\"mass\"",
    "quantity=\"closed-area\"",
];

/// The options that set lists of the scene, with a density of the lower body.
fn with(settings: &[String], words: &[&str]) -> Value {
    let (scene, mut arguments) = (hertz(), Vec::new());
    for setting in settings {
        arguments.extend(["--set", setting]);
    }
    let density = ["--set", "body[0].material.density=7850", "--mesh", "4", "--json"];
    json(contact3d(), &[&[scene.as_str()], words, &density, &arguments].concat())
}

fn list(name: &str, entries: impl Iterator<Item = String>) -> String {
    format!("{name}=[{}]", entries.map(|entry| format!("{{{entry}}}")).collect::<Vec<_>>().join(", "))
}

#[test]
fn a_quantity_is_minimised_limited_and_reported_with_one_value() {
    let labelled = ALL.iter().enumerate().map(|(index, own)| format!("{own}, label=\"q{index}\""));
    let limited = ALL.iter().take(19).map(|own| format!("{own}, at_most=1e17"));
    let found = with(&[list("report", labelled), list("limit", limited)], &["evaluate"]);
    let (reports, limits) = (found["reports"].as_array().unwrap(), found["limits"].as_array().unwrap());
    assert_eq!((reports.len(), limits.len()), (20, 19));
    for (report, own) in reports.iter().zip(ALL) {
        let name = report["quantity"].as_str().unwrap();
        assert!(own.contains(&format!("\"{name}\"")) && number(&report["end"]).is_finite(), "{report}");
        if name == "closed-area" {
            continue;
        }
        let same = |limit: &&Value| limit["quantity"] == name && limit["end"] == report["end"];
        assert!(limits.iter().any(|limit| same(&limit)), "{report}");
        let minimised = with(&[format!("objective={{{own}}}")], &["evaluate"]);
        let (value, expected) = (number(&minimised["objective"]), number(&report["end"]));
        assert!((value - expected).abs() <= 1e-12 * expected.abs(), "{own}: {value} {expected}");
    }
}

#[test]
fn resultants_and_reports_of_forces_agree() {
    let reports = [
        "quantity=\"contact-force\", axis=\"x1\"",
        "quantity=\"contact-force\", axis=\"x3\", label=\"up\"",
        "quantity=\"reaction\", region={face=\"x2-min\", body=\"upper\"}, axis=\"x2\"",
        "quantity=\"closed-area\"",
        "quantity=\"mass\"",
    ];
    let found = with(&[list("report", reports.iter().map(|own| (*own).to_owned()))], &["evaluate"]);
    let value = |index: usize| number(&found["reports"][index]["end"]);
    let bodies = &found["cases"][0]["resultants"]["bodies"];
    let slave = &bodies[0]["contact"];
    let scale = number(&found["total_normal_force"]);
    assert!((value(0) - number(&slave[0])).abs() < 1e-8 * scale && (value(1) - number(&slave[2])).abs() < 1e-8 * scale);
    let supports = bodies[1]["supports"].as_array().unwrap();
    let held = supports.iter().find(|support| support["face"] == "x2-min").unwrap();
    assert!((value(2) - number(&held["force"][1])).abs() < 1e-8 * scale);
    // The lower block: a cube of 10 mm of steel.
    assert!(value(3) > 0.0 && (value(4) / 7.85e-3 - 1.0).abs() < 1e-12, "{}", value(4));
}

#[test]
fn reports_stand_at_both_ends_of_a_run_and_in_columns_of_a_study() {
    let folder = scratch();
    let reports = list(
        "report",
        ["quantity=\"friction-work\"".to_owned(), "quantity=\"slip\", label=\"largest slip\"".to_owned()].into_iter(),
    );
    let out = folder.path().join("run");
    let words = ["optimize", "--single", "--max-evaluations", "2", "--out", text(&out)];
    let found = with(std::slice::from_ref(&reports), &words);
    let slip = &found["reports"][1];
    assert!(number(&slip["start"]) > 0.0 && number(&slip["end"]) > 0.0 && slip["unit"] == "mm", "{slip}");
    assert!(std::fs::read_to_string(out.join("report.html")).unwrap().contains("largest slip"));
    let out = folder.path().join("study");
    let limit = "limit=[{quantity=\"stress\", at_most=1e5}]".to_owned();
    let words = ["study", "--vary", "friction=0,0.1,0.3", "--out", text(&out)];
    let study = with(&[reports, limit], &words);
    let rows = study["rows"].as_array().unwrap();
    let work = |row: &Value| number(&row["solved"]["quantities"][1]["value"]);
    assert_eq!(work(&rows[0]), 0.0);
    assert!(work(&rows[1]) > 0.0 && work(&rows[2]) > 0.0);
    let table = std::fs::read_to_string(out.join("study.csv")).unwrap();
    let head = table.lines().next().unwrap();
    assert!(head.contains("stress_MPa,friction_work_Nmm,largest_slip_mm"), "{head}");
    assert!(out.join("figures/quantity_3.svg").exists());
}

#[test]
fn reports_that_mean_nothing_are_refused_by_their_field() {
    let scene = hertz();
    for (setting, words) in [
        ("report=[{quantity=\"weight\"}]", "report[0].quantity"),
        ("report=[{quantity=\"slip\", contact=3}]", "report[0].contact = 3"),
        ("report=[{quantity=\"slip\", exponent=3}]", "report[0].exponent"),
        ("report=[{quantity=\"reaction\"}]", "report[0].region.face = missing"),
        ("report=[{quantity=\"reaction\", region={face=\"top\", body=\"lower\"}}]", "report[0].region.face"),
        ("report=[{quantity=\"reaction\", region={face=\"x1-min\"}}]", "report[0].region.body = missing"),
        ("report=[{quantity=\"mass\"}]", "material.density"),
        ("report=[{quantity=\"slip\"}, {quantity=\"slip\"}]", "report[1].label"),
        ("report=[{quantity=\"slip\", case=\"left\"}]", "report[0].case"),
        ("report=[{quantity=\"reaction\", region={face=\"x1-min\", x3=[0.0, 1.0]}}]", "report[0].region"),
        ("limit=[{quantity=\"closed-area\", at_least=3}]", "limit[0].quantity"),
        ("report=[{quantity=\"displacement\", relative_to={face=\"nose\"}}]", "relative_to.face"),
    ] {
        refused(contact3d(), &[&scene, "evaluate", "--set", setting], &[words]);
    }
}

/// Glued faces have forces, but neither pressures nor slips.
#[test]
fn glued_contacts_have_forces_alone() {
    let scene = format!("{}/scenes/stack.toml", env!("CARGO_MANIFEST_DIR"));
    let evaluated = |quantity: &str| {
        let report = format!("report=[{{quantity=\"{quantity}\", contact=1}}]");
        ["evaluate", "--json", "--set", "contact[1].tied=true", "--set", &report].map(str::to_owned)
    };
    for quantity in ["mean-pressure", "closed-area", "slip", "friction-work"] {
        let words = evaluated(quantity);
        let words: Vec<&str> = std::iter::once(scene.as_str()).chain(words.iter().map(String::as_str)).collect();
        refused(contact3d(), &words, &["report[0].contact = 1", "glued faces neither slide nor open"]);
    }
    let words = evaluated("contact-force");
    let words: Vec<&str> = std::iter::once(scene.as_str()).chain(words.iter().map(String::as_str)).collect();
    let found = json(contact3d(), &words);
    assert!(number(&found["reports"][0]["end"]) > 0.0, "{}", found["reports"]);
}
