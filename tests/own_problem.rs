//! The example `own_problem` finds its minimiser.

#[path = "../examples/own_problem.rs"]
mod own_problem;

#[test]
fn string_just_touches_the_table() {
    let report = own_problem::minimize().expect("a report");
    assert!(report.termination.is_stationary(), "{report}");
    assert!((report.value - 0.5).abs() < 1e-7, "{report}");
    // smooth growth along the kink: the square root of the error of the value
    assert!((report.solution[0] + 0.125_f64.sqrt()).abs() < 1e-3, "{report}");
    assert!((report.solution[1] - 0.5_f64.sqrt()).abs() < 1e-3, "{report}");
}
