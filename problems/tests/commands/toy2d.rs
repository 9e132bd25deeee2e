//! The binary `toy2d`: its page, its JSON, its pictures, its exit statuses.

use testset::kit;

const TOY2D: &str = env!("CARGO_BIN_EXE_toy2d");

#[test]
fn twenty_random_starts_find_the_minimiser() {
    let study = kit::json(TOY2D, &["--json"]);
    let runs = study["runs"].as_array().expect("runs");
    assert_eq!(runs.len(), 20);
    for run in runs {
        assert!(run["error"].as_f64().is_some_and(|error| error <= 1e-8), "{run}");
    }
    assert!((study["best"]["value"].as_f64().expect("number") - 1.5390625).abs() < 1e-9);
}

#[test]
fn page_names_the_minimiser_and_its_kinks() {
    let output = kit::run(TOY2D, &["--start", "-3,5"]);
    let page = String::from_utf8_lossy(&output.stdout);
    assert_eq!(output.status.code(), Some(0), "{page}");
    assert!(page.contains("exact (0.25, 1.25)"), "{page}");
    assert!(page.contains("from the kink slip forward | stick at height 0.5"), "{page}");
    assert!(page.contains("found by:    1 of 1 runs"), "{page}");
}

#[test]
fn bad_input_ends_with_status_2_and_a_reason() {
    for (arguments, reason) in [
        (vec!["--start", "1"], "--start"),
        (vec!["--start", "1,NaN"], "--start"),
        (vec!["--start", "1,7"], "between -4 and 6"),
        (vec!["--starts", "0"], "--starts"),
        (vec!["--cells", "0"], "--cells"),
    ] {
        kit::refused(TOY2D, &arguments, &[reason]);
    }
}
