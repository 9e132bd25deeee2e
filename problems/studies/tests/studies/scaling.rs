//! The scaling binary's contract: JSON keys, counts, exit statuses.

use serde_json::Value;
use testset::kit;

/// Products with the dual operator of the cold states to 1e-6, 1e-8, 1e-10 (measured: 15, 19, 22).
const COLD_BOUNDS: [u64; 3] = [19, 24, 28];
/// Products with the dual operator of a warm state to 1e-8 (measured: 13).
const WARM_BOUND: u64 = 17;
/// Products with the dual operator of an adjoint to 1e-8 (measured: 12).
const ADJOINT_BOUND: u64 = 16;

const SCALING: &str = env!("CARGO_BIN_EXE_scaling");

/// Products with the dual operator of the cold states to 1e-6, 1e-8, 1e-10.
fn cold_counts(row: &Value) -> Vec<u64> {
    let mut solves: Vec<&Value> = row["solves"].as_array().unwrap().iter().collect();
    solves.retain(|solve| solve["start"] == "cold");
    solves.sort_by(|a, b| b["tolerance"].as_f64().unwrap().total_cmp(&a["tolerance"].as_f64().unwrap()));
    solves.iter().map(|solve| solve["work"]["dual_operator_applications"].as_u64().unwrap()).collect()
}

#[test]
fn a_tiny_case_prints_its_keys_and_counts() {
    let report = kit::json(SCALING, &["--case", "6/2", "--json"]);
    let rows = report["rows"].as_array().unwrap();
    let variants: Vec<&str> = rows.iter().map(|row| row["variant"].as_str().unwrap()).collect();
    assert_eq!(variants, ["dirichlet", "lumped", "none", "augmented-lagrangian", "direct"]);
    assert!(report["failures"].as_array().unwrap().is_empty());
    let row = &rows[0];
    for key in ["mesh", "subdomains", "setup_seconds", "solves"] {
        assert!(!row[key].is_null(), "{key}");
    }
    for key in ["equilibrium", "factorization", "coarse_space", "newton", "recovery"] {
        assert!(row["solves"][0]["stages"][key].is_f64(), "{key}");
    }
    assert_eq!((row["dofs"].as_u64(), row["contact_nodes"].as_u64()), (Some(8 * 3 * 64), Some(49)));
    if cfg!(target_os = "linux") {
        assert!(row["peak_memory"].as_f64().unwrap() > 0.0);
    }
    // Counts are the price of a state: a change is to be noticed.
    let counts = cold_counts(row);
    assert!(counts.is_sorted() && counts[0] > 0, "{counts:?}");
    for (count, bound) in counts.iter().zip(COLD_BOUNDS) {
        assert!(*count <= bound, "{counts:?}");
    }
    assert!(
        row["solves"][1]["work"]["dual_operator_applications"].as_u64().unwrap() <= WARM_BOUND,
        "{}",
        row["solves"][1]
    );
    assert!(row["solves"][0]["adjoint"]["applications"].as_u64().unwrap() <= ADJOINT_BOUND, "{row}");
    // All paths find the same pressures.
    let [torn, paper, direct] = [0, 3, 4].map(|index: usize| rows[index]["solves"][0]["objective"].as_f64().unwrap());
    assert!((torn / direct - 1.0).abs() < 1e-5 && (paper / direct - 1.0).abs() < 1e-5, "{torn} {paper} {direct}");
    let work = &rows[3]["solves"][0]["work"];
    assert!(work["fixed_point_steps"].as_u64().unwrap() > 1 && work["cg_steps"].as_u64().unwrap() > 0, "{work}");
}

#[test]
fn unknown_cases_are_refused_with_what_is_allowed() {
    for bad in ["7/2", "6", "0/1", "six/2", "6/0", "401/1", "6/2/1"] {
        kit::refused(SCALING, &["--case", bad], &[bad, "divisor"]);
    }
    kit::refused(SCALING, &["--case", "6/2", "--full"], &["--full"]);
}
