//! The accuracy binary's contract: tables, JSON, exit statuses; and that what it reports is sound.

use serde_json::Value;
use testset::kit;

const ACCURACY: &str = env!("CARGO_BIN_EXE_accuracy");

fn rows(value: &Value) -> &[Value] {
    value.as_array().unwrap()
}

#[test]
fn no_solver_reports_a_bound_below_its_error() {
    let report = kit::json(ACCURACY, &["--smoke", "--part", "algebra", "--json"]);
    assert!(report["optimization"].is_null(), "a part that was not asked for");
    for study in rows(&report["algebra"]) {
        assert_eq!(study["violations"], 0, "a bound below the true error: {study}");
        // Six solvers, three tolerances; the tightest of each is accurate.
        assert_eq!(rows(&study["rows"]).len(), 18);
        for row in rows(&study["rows"]).iter().filter(|row| row["tolerance"].as_f64().unwrap() < 1e-9) {
            assert!(row["value"].as_f64().unwrap() < 1e-10 && row["subgradient"].as_f64().unwrap() < 1e-8, "{row}");
        }
    }
}

#[test]
fn contradictory_options_are_refused() {
    for (arguments, word) in [(["--smoke", "--full"], "--full"), (["--part", "nothing"], "nothing")] {
        kit::refused(ACCURACY, &arguments, &[word]);
    }
}
