//! The examples find the closed forms that their heads state.

#[path = "../../examples/checkpoint.rs"]
mod checkpoint;
#[path = "../../examples/closure.rs"]
mod closure;
#[path = "../../examples/constrained_minimax.rs"]
mod constrained_minimax;
#[path = "../../examples/inexact_oracle.rs"]
mod inexact_oracle;
#[path = "../../examples/observer.rs"]
mod observer;
#[path = "../../examples/own_problem.rs"]
mod own_problem;

use nonsmooth::{AccuracyPolicy, Termination};
use testset::kit::scratch;

#[test]
fn string_just_touches_the_table() {
    let report = own_problem::minimize().expect("a report");
    assert!(report.termination.is_stationary(), "{report}");
    assert!((report.value - 0.5).abs() < 1e-7, "{report}");
    // Smooth growth along the kink: the square root of the error of the value.
    assert!((report.solution[0] + 0.125_f64.sqrt()).abs() < 1e-3, "{report}");
    assert!((report.solution[1] - 0.5_f64.sqrt()).abs() < 1e-3, "{report}");
}

#[test]
fn closure_finds_the_fermat_point() {
    let report = closure::minimize().expect("a report");
    assert!(report.termination.is_stationary(), "{report}");
    assert!((report.value - 3.0_f64.sqrt()).abs() < 1e-7, "{report}");
    assert!((report.solution[1] - 3.0_f64.sqrt() / 6.0).abs() < 1e-3, "{report}");
}

#[test]
fn best_line_under_the_root() {
    let report = constrained_minimax::minimize().expect("a report");
    assert!(report.termination.is_stationary(), "{report}");
    let root = 2.0_f64.sqrt();
    assert!((report.value - (2.0 - root) / 4.0).abs() < 2e-6, "{report}");
    assert!((report.solution[1] - (2.0 + root) / 4.0).abs() < 1e-4, "{report}");
    assert!((report.solution.sum() - 1.0).abs() < 1e-12, "{report}");
}

#[test]
fn string_is_level_with_fewer_sweeps_on_demand() {
    let run = |policy| {
        let (report, sweeps) = inexact_oracle::minimize(policy).expect("a report");
        assert!((report.value - 1.0 / 64.0).abs() < 1e-7, "{report}");
        assert!((report.solution[0] - 0.5).abs() < 1e-4 && (report.solution[1] + 1.0 / 64.0).abs() < 1e-5, "{report}");
        sweeps
    };
    let (tight, demand) = (run(AccuracyPolicy::Tightest), run(AccuracyPolicy::ON_DEMAND));
    assert!(2 * demand < tight, "{demand} against {tight}");
}

#[test]
fn continued_run_equals_the_uninterrupted_one() {
    let folder = scratch();
    let [whole, resumed] = checkpoint::both_ways(folder.path()).expect("two reports");
    assert!(whole.value < 1e-6 && whole.termination.is_stationary(), "{whole}");
    assert_eq!(whole.solution, resumed.solution);
    assert_eq!(whole.counts, resumed.counts);
}

#[test]
fn observers_see_every_evaluation_and_rules_stop() {
    let mut table = Vec::new();
    let (report, serious) = observer::minimize(&mut table).expect("a report");
    assert!(matches!(report.termination, Termination::StopRule { .. }), "{report}");
    assert!(report.value <= 1e-3 && serious > 1, "{report}");
    assert!(String::from_utf8(table).expect("text").lines().count() > report.counts.evaluations);
}
