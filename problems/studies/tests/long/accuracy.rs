//! The smallest accuracy study, whole.

use serde_json::Value;
use testset::kit;

fn rows(value: &Value) -> &[Value] {
    value.as_array().unwrap()
}

#[test]
fn the_smallest_study_holds_what_it_promises() {
    let report = kit::json(env!("CARGO_BIN_EXE_accuracy"), &["--smoke", "--json"]);
    for taylor in rows(&report["subgradient"]["taylor"]) {
        assert!((taylor["test"]["fitted_slope"].as_f64().unwrap() - 2.0).abs() < 0.1, "{taylor}");
    }
    let kinks = rows(&report["subgradient"]["kinks"]);
    assert_eq!(kinks.len(), 2);
    for kink in kinks {
        assert_eq!(kink["bracketed"], true, "{kink}");
        assert!(kink["weakly_active"].as_u64().unwrap() >= 1, "{kink}");
    }
    for course in rows(&report["optimization"]["courses"]) {
        assert!(course["value"].as_f64().unwrap() < report["optimization"]["start"].as_f64().unwrap());
    }
}

/// The quick study's kinks: four of each scene.
#[test]
fn one_sided_slopes_at_kinks_bracket_the_product_with_the_returned_element() {
    let report = kit::json(env!("CARGO_BIN_EXE_accuracy"), &["--part", "subgradient", "--json"]);
    let kinks = rows(&report["subgradient"]["kinks"]);
    assert_eq!(kinks.len(), 8);
    assert!(kinks.iter().all(|kink| kink["bracketed"] == true), "{kinks:?}");
}
