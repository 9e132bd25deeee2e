//! Every reason to end, reached on purpose.
use crate::common::{cb3, crescent, distance_1, minimize, v};
use nonsmooth::{
    Answer, BundleTrust, BundleTrustConfig, Evaluation, FnObjective, IterationRecord, NonsmoothObjective,
    OptimizeError, OracleError, Request, StepKind, StopRule, TablePrinter, Termination, Vector,
};
use std::cell::Cell;
use std::ops::ControlFlow;

fn method(config: BundleTrustConfig) -> BundleTrust<'static> {
    BundleTrust::new(config).unwrap()
}

#[test]
fn stationary_and_confirmed() {
    let report = minimize(&distance_1(v(&[1.0, -2.0, 3.0])), None, &[0.5; 3]);
    assert!(report.termination.is_confirmed(), "{report}");
    assert!(report.value < 1e-9);
    assert!(report.to_string().contains("confirmed stationary"), "{report}");
}

#[test]
fn evaluation_limit() {
    let report = method(BundleTrustConfig { max_evaluations: 3, ..Default::default() })
        .minimize(&crescent(), v(&[-1.0, 2.0]))
        .unwrap();
    assert_eq!(report.termination, Termination::EvaluationLimit);
    assert_eq!(report.history.len(), 3);
    assert!(report.certificate.is_some());
}

/// From 20, exp(5|x|) promises so much that a step to its minimum is a null step.
#[test]
fn a_limit_ends_at_the_lowest_point_evaluated() {
    let steep = FnObjective::new(1, |x: &Vector| {
        let value = (5.0 * x[0].abs()).exp();
        (value, v(&[5.0 * value * x[0].signum()]))
    });
    let mut lower_null_steps = 0;
    for max_evaluations in 2..60 {
        let report =
            method(BundleTrustConfig { max_evaluations, ..Default::default() }).minimize(&steep, v(&[20.0])).unwrap();
        let lowest = report.history.iter().filter_map(|record| record.value).fold(f64::INFINITY, f64::min);
        let last_center = report.history.last().unwrap().center_value;
        if report.termination == Termination::EvaluationLimit {
            assert_eq!(report.value, lowest, "{report}");
            assert_eq!(report.value, steep.evaluate(&Request::tight(&report.solution)).unwrap().evaluation().value);
            assert_eq!(report.certificate.unwrap().point, report.solution);
            lower_null_steps += usize::from(lowest < last_center);
        }
    }
    assert!(lower_null_steps > 0);
}

#[test]
fn iteration_limit() {
    let report = method(BundleTrustConfig { max_iterations: 2, ..Default::default() })
        .minimize(&crescent(), v(&[-1.0, 2.0]))
        .unwrap();
    assert_eq!(report.termination, Termination::IterationLimit);
}

#[test]
fn time_limit() {
    let slow = FnObjective::new(1, |x: &Vector| {
        std::thread::sleep(std::time::Duration::from_millis(5));
        (x[0].abs().sqrt(), v(&[0.5 * x[0].signum() / x[0].abs().sqrt()]))
    });
    let report =
        method(BundleTrustConfig { max_seconds: Some(0.01), ..Default::default() }).minimize(&slow, v(&[3.0])).unwrap();
    assert_eq!(report.termination, Termination::TimeLimit);
}

#[test]
fn observer_and_table() {
    let mut table = Vec::new();
    let report = method(BundleTrustConfig::default())
        .observer(TablePrinter::new(&mut table))
        .observer(
            |record: &IterationRecord| {
                if record.kind == StepKind::Serious { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
            },
        )
        .minimize(&cb3(), v(&[2.0, 2.0]))
        .unwrap();
    assert_eq!(report.termination, Termination::StoppedByObserver);
    assert_eq!(report.counts.serious, 1);
    let table = String::from_utf8(table).unwrap();
    assert_eq!(table.lines().count(), 1 + report.history.len());
}

#[test]
fn stop_rules_combine() {
    let rule = StopRule::ValueBelow(3.0) & StopRule::Evaluations(4);
    let report = method(BundleTrustConfig::default()).stop_when(rule).minimize(&cb3(), v(&[2.0, 2.0])).unwrap();
    assert!(matches!(report.termination, Termination::StopRule { .. }), "{report}");
    assert!(report.counts.evaluations >= 4 && report.value <= 3.0);
    let rule = StopRule::ValueBelow(-1.0) | StopRule::Stalled { evaluations: 3, relative: 1e-3 };
    let report = method(BundleTrustConfig::default()).stop_when(rule).minimize(&cb3(), v(&[2.0, 2.0])).unwrap();
    assert!(report.termination.to_string().contains("relative decrease"), "{report}");
}

/// |x − 3| that fails for x < 1 after the first evaluation, in a chosen way.
struct Fragile {
    how: fn() -> OracleError,
    calls: Cell<usize>,
    always: bool,
}

impl NonsmoothObjective for Fragile {
    type WarmStart = ();

    fn dimension(&self) -> usize {
        1
    }

    fn evaluate(&self, request: &Request<'_, ()>) -> Result<Answer<()>, OracleError> {
        self.calls.set(self.calls.get() + 1);
        let x = request.point[0];
        if x < 1.0 || (self.always && self.calls.get() > 1) {
            return Err((self.how)());
        }
        let subgradient = v(&[(x - 1.5).signum()]);
        Ok(Answer::Accurate(Evaluation::exact((x - 1.5).abs(), subgradient, ())))
    }
}

fn outside() -> OracleError {
    OracleError::OutsideDomain { reason: "x < 1".to_owned() }
}

fn panicking() -> OracleError {
    panic!("element 7 is inverted")
}

#[test]
fn failures_shorten_the_step() {
    for how in [outside as fn() -> OracleError, panicking] {
        let theta = Fragile { how, calls: Cell::new(0), always: false };
        let config = BundleTrustConfig { first_step: Some(4.0), ..Default::default() };
        let report = method(config).minimize(&theta, v(&[4.0])).unwrap();
        assert!(report.value < 1e-6, "{report}");
        assert!(report.counts.failed >= 1);
        assert!(report.history.iter().any(|record| record.failure.is_some()));
    }
}

#[test]
fn repeated_failure_keeps_best_point_and_history() {
    for how in [outside as fn() -> OracleError, panicking] {
        let theta = Fragile { how, calls: Cell::new(0), always: true };
        let report = method(BundleTrustConfig::default()).minimize(&theta, v(&[4.0])).unwrap();
        assert!(matches!(report.termination, Termination::OracleFailing { failures: 10, .. }), "{report}");
        assert_eq!((report.solution[0], report.value), (4.0, 2.5));
        assert_eq!(report.history.len(), 11);
    }
    let theta = Fragile { how: panicking, calls: Cell::new(0), always: true };
    let report = method(BundleTrustConfig::default()).minimize(&theta, v(&[4.0])).unwrap();
    assert!(report.termination.to_string().contains("element 7 is inverted"));
}

#[test]
fn first_evaluation_failing_is_an_error() {
    let theta = Fragile { how: outside, calls: Cell::new(0), always: false };
    let error = method(BundleTrustConfig::default()).minimize(&theta, v(&[0.0])).unwrap_err();
    assert!(matches!(error, OptimizeError::Oracle(OracleError::OutsideDomain { .. })));
}

#[test]
fn nan_is_a_failure_not_convergence() {
    let theta = FnObjective::new(1, |x: &Vector| {
        let value = if x[0] < 0.9 { f64::NAN } else { x[0] };
        (value, v(&[1.0]))
    });
    let report = method(BundleTrustConfig::default()).minimize(&theta, v(&[3.0])).unwrap();
    assert!(matches!(report.termination, Termination::OracleFailing { .. }), "{report}");
    assert!(report.value >= 0.9 && report.value < 1.0, "{report}");
}

#[test]
fn minus_infinity_is_unbounded_below() {
    let theta = FnObjective::new(1, |x: &Vector| (if x[0] < 0.0 { f64::NEG_INFINITY } else { x[0] }, v(&[1.0])));
    let report = minimize(&theta, None, &[1.0]);
    assert_eq!(report.termination, Termination::UnboundedBelow);
    assert!(report.value.is_finite());
}

#[test]
fn wrong_subgradient_never_ends_as_confirmed() {
    let theta = FnObjective::new(2, |x: &Vector| (x.norm(), x / -x.norm().max(1e-300)));
    let report = minimize(&theta, None, &[1.0, 2.0]);
    assert!(!report.termination.is_confirmed(), "{report}");
}

/// |x| with an error bound that is none.
struct Overconfident;

impl NonsmoothObjective for Overconfident {
    type WarmStart = ();

    fn dimension(&self) -> usize {
        1
    }

    fn evaluate(&self, request: &Request<'_, ()>) -> Result<Answer<()>, OracleError> {
        let x = request.point[0];
        let mut evaluation = Evaluation::exact(x.abs(), v(&[x.signum()]), ());
        evaluation.error_bound = -1.0;
        Ok(Answer::Accurate(evaluation))
    }
}

#[test]
fn a_negative_error_bound_is_a_typed_error() {
    let error = method(BundleTrustConfig::default()).minimize(&Overconfident, v(&[1.0])).unwrap_err();
    assert_eq!(error.to_string(), "the first evaluation failed: error bound = -1 is not allowed; allowed: ≥ 0");
}
