//! Attempts, fairness and `--single`.

use serde_json::Value;
use testset::kit::{self, text};

const CONTACT: &str = env!("CARGO_BIN_EXE_contact3d");
const SEAT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/scenes/jack_seat.toml");

fn seat(arguments: &[&str]) -> Value {
    kit::json(CONTACT, &[&[SEAT, "--no-checks", "--json"], arguments].concat())
}

/// What a run found, to the bit.
fn found(report: &Value) -> String {
    ["objective", "controls", "evaluations", "termination", "certificate"].map(|key| report[key].to_string()).join(" ")
}

/// The direct way alone ends at 9.61e8, going on from a smoother shape at 7.58e8, and the default at 4.99e8, the lowest
/// value known on this mesh; the best of many starts has not been computed here.
#[test]
fn the_seat_ends_lower_and_smoother_for_few_evaluations() {
    let (single, default) = (seat(&["--single"]), seat(&[]));
    let objective = |report: &Value| report["objective"].as_f64().unwrap();
    assert!((objective(&single) / 9.614941e8 - 1.0).abs() < 1e-5 && single.get("stages").is_none(), "{single}");
    assert!(objective(&default) < 1.03 * 4.987436e8, "{}", default["objective"]);
    assert_eq!(default["termination"]["confirmed"], true);
    let all = default["all_evaluations"].as_f64().unwrap();
    assert!(all <= 2.5 * single["evaluations"].as_f64().unwrap(), "{all}");
    let bending = default["bending"].as_str().unwrap();
    let [before, after] = [0, 1].map(|place| bending.split(" -> ").nth(place).unwrap().parse::<f64>().unwrap());
    assert!(after < 0.8 * before, "{bending}");
    // The whole run, which began at the fairer shape, ends no higher than the attempt that it went on from.
    let ends: Vec<f64> = default["stages"].as_array().unwrap().iter().map(objective).collect();
    assert!(ends.iter().all(|end| objective(&default) <= *end * (1.0 + 1e-4)), "{ends:?}");
}

#[test]
fn a_run_of_several_parts_resumes_to_the_same_bits() {
    let mesh = ["--mesh", "6", "--starts", "2"];
    let whole = seat(&mesh);
    let scratch = kit::scratch();
    let folder = scratch.path().join("run");
    let begun = seat(&[&mesh[..], &["--max-evaluations", "4", "--out", text(&folder)]].concat());
    assert_eq!(begun["termination"]["reason"], "evaluation_limit");
    assert!(folder.join("try_coarse/journal.jsonl").exists() && folder.join("try_start_2").exists());
    let resume = ["--resume", text(&folder), "--max-evaluations", "150", "--json"];
    assert_eq!(found(&kit::json(CONTACT, &resume)), found(&whole));
    // A run that has ended is repeated from its journals.
    assert_eq!(found(&kit::json(CONTACT, &["--resume", text(&folder), "--json"])), found(&whole));
    kit::refused(CONTACT, &["--resume", text(&folder), "--single"], &["--resume is allowed"]);
    kit::refused(CONTACT, &[SEAT, "--set", "optimizer.single=3"], &["optimizer.single"]);
}
