//! Jacobians and outer functions that fail: typed errors, notes, and the run that goes on with cuts.

use crate::common::{cb3, v};
use nonsmooth::composite::{
    FnOuter, InactiveConstraints, Linearization, Linearized, Maximum, OuterFunction, weighted_gram,
};
use nonsmooth::{
    AccuracyPolicy, Answer, BundleTrust, BundleTrustConfig, CompositeFunction, Evaluation, FnObjective, InputError,
    Matrix, NonsmoothObjective, OptimizeError, OracleError, Polyhedron, Report, Request, StepKind, Termination, Vector,
};
use std::cell::{Cell, RefCell};

/// What becomes of a Jacobian.
#[derive(Clone, Copy, PartialEq)]
enum Fault {
    None,
    Fails,
    NotANumber,
    Column,
    Row,
}

/// CB3 with its three pieces as outputs; the fault may depend on the number of the evaluation, from 1.
struct Faulty<F> {
    calls: Cell<usize>,
    fault: F,
}

impl<F: Fn(usize) -> Fault> Faulty<F> {
    fn new(fault: F) -> Self {
        Self { calls: Cell::new(0), fault }
    }
}

fn linearize(x: &Vector) -> (Vector, Matrix) {
    let (a, b) = (x[0], x[1]);
    let e = 2.0 * (b - a).exp();
    let rows = [4.0 * a.powi(3), 2.0 * b, 2.0 * a - 4.0, 2.0 * b - 4.0, -e, e];
    (v(&[a.powi(4) + b * b, (2.0 - a).powi(2) + (2.0 - b).powi(2), e]), Matrix::from_row_slice(3, 2, &rows))
}

impl<F: Fn(usize) -> Fault> NonsmoothObjective for Faulty<F> {
    type WarmStart = ();

    fn dimension(&self) -> usize {
        2
    }

    fn outer(&self) -> Option<&dyn OuterFunction> {
        Some(&Maximum)
    }

    fn evaluate(&self, request: &Request<'_, ()>) -> Result<Answer<()>, OracleError> {
        self.calls.set(self.calls.get() + 1);
        let (outputs, mut jacobian) = linearize(request.point);
        let subgradient = jacobian.tr_mul(&Maximum.subgradient(&outputs));
        let mut evaluation = Evaluation::exact(outputs.max(), subgradient, ());
        let fault = (self.fault)(self.calls.get());
        match fault {
            Fault::NotANumber => jacobian[(2, 1)] = f64::NAN,
            Fault::Column => jacobian = jacobian.insert_column(2, 0.0),
            Fault::Row => jacobian = jacobian.insert_row(3, 0.0),
            Fault::None | Fault::Fails => {}
        }
        let linearization = Linearization { outputs, jacobian, accuracy: 0.0, inactive: None };
        evaluation.linearization = match fault {
            Fault::Fails => Linearized::Unavailable("the factor is singular".to_owned()),
            _ => Linearized::if_asked(request.linearization, linearization),
        };
        Ok(Answer::Accurate(evaluation))
    }
}

fn method() -> BundleTrust<'static> {
    BundleTrust::new(BundleTrustConfig::default()).unwrap()
}

fn run(fault: impl Fn(usize) -> Fault) -> Result<Report, OptimizeError> {
    method().minimize(&Faulty::new(fault), v(&[2.0, 2.0]))
}

#[test]
fn without_any_jacobian_the_run_is_that_of_the_cuts() {
    let report = run(|_| Fault::Fails).unwrap();
    let cuts = method().minimize(&cb3(), v(&[2.0, 2.0])).unwrap();
    assert_eq!((report.value, &report.solution, &report.termination), (cuts.value, &cuts.solution, &cuts.termination));
    assert_eq!(report.counts, cuts.counts);
    assert_eq!((report.counts.jacobians, report.counts.trials.composite_model), (0, 0));
    for record in report.history.iter().filter(|record| matches!(record.kind, StepKind::Start | StepKind::Null)) {
        assert_eq!(record.note.as_deref(), Some("no Jacobian: the factor is singular"), "{record:?}");
        assert!(!record.jacobian && record.failure.is_none());
    }
}

#[test]
fn where_some_jacobians_fail_the_run_notes_it_and_ends_at_the_optimum() {
    for rest in 0..3 {
        let fault = |call: usize| if call % 3 == rest { Fault::Fails } else { Fault::None };
        let report = run(fault).unwrap();
        assert!(report.termination.is_stationary() && (report.value - 2.0).abs() < 1e-6, "{report}");
        for record in &report.history {
            let failed = fault(record.evaluation) == Fault::Fails;
            assert_eq!(record.note.is_some(), failed, "{record:?}");
            assert_eq!(record.jacobian, !failed, "{record:?}");
        }
        assert!(report.counts.trials.composite_model > 0 && report.counts.failed == 0, "{report}");
    }
}

#[test]
fn a_jacobian_that_is_no_matrix_of_numbers_is_a_typed_error() {
    let first = |fault: Fault| match run(|_| fault).unwrap_err() {
        OptimizeError::Oracle(OracleError::Input(error)) => error,
        other => panic!("{other}"),
    };
    // Entries are counted by columns.
    assert!(matches!(first(Fault::NotANumber), InputError::NotFinite { what: "Jacobian", index: 5, .. }));
    let size = |what, expected, found| InputError::Dimension { what, expected, found };
    assert_eq!(first(Fault::Column), size("columns of the Jacobian", 2, 3));
    assert_eq!(first(Fault::Row), size("rows of the Jacobian", 3, 4));
}

#[test]
fn a_later_jacobian_that_is_no_matrix_of_numbers_fails_its_evaluation_alone() {
    for (fault, text) in [
        (Fault::NotANumber, "Jacobian: entry 5 is NaN, expected a finite number"),
        (Fault::Column, "columns of the Jacobian has 3 entries, expected 2"),
        (Fault::Row, "rows of the Jacobian has 4 entries, expected 3"),
    ] {
        let report = run(|call| if call == 3 { fault } else { Fault::None }).unwrap();
        assert_eq!(report.history[2].failure.as_deref(), Some(text));
        assert_eq!((report.history[2].kind, report.counts.failed), (StepKind::Failed, 1));
        assert!(report.termination.is_stationary() && (report.value - 2.0).abs() < 1e-6, "{report}");
        let report = run(|call| if call > 1 { fault } else { Fault::None }).unwrap();
        assert!(matches!(report.termination, Termination::OracleFailing { .. }), "{report}");
        assert_eq!((report.value, report.solution), (20.0, v(&[2.0, 2.0])));
    }
}

#[test]
fn a_closure_that_returns_no_matrix_of_numbers_is_a_typed_error() {
    let theta = CompositeFunction::new(2, Maximum, |x: &Vector| {
        let (outputs, jacobian) = linearize(x);
        (outputs, jacobian * if x[0] == 2.0 { f64::NAN } else { 1.0 })
    });
    let error = method().minimize(&theta, v(&[2.0, 2.0])).unwrap_err();
    let wanted =
        |error: &OracleError| matches!(error, OracleError::Input(InputError::NotFinite { what: "Jacobian", .. }));
    assert!(matches!(&error, OptimizeError::Oracle(inner) if wanted(inner)), "{error}");
}

/// The reason why the subproblem ended a run from (3, 1); the best point must be the start or a better one.
fn reason(outer: impl OuterFunction) -> String {
    let theta = CompositeFunction::new(2, &outer, |x: &Vector| (x.clone(), Matrix::identity(2, 2)));
    let set = Polyhedron::boxed(v(&[-5.0, -5.0]), v(&[5.0, 5.0])).unwrap();
    let report = method().constraints(set).minimize(&theta, v(&[3.0, 1.0])).unwrap();
    assert_eq!(outer.value(&report.solution), report.value);
    assert!(report.value <= report.start_value && report.history.len() == report.counts.evaluations);
    match &report.termination {
        Termination::SubproblemFailed { reason } => reason.clone(),
        _ => panic!("{report}"),
    }
}

/// h with its subgradient and the diagonal of its second derivative.
struct Smooth(fn(f64) -> [f64; 3]);

impl OuterFunction for Smooth {
    fn value(&self, outputs: &Vector) -> f64 {
        outputs.iter().map(|c| (self.0)(*c)[0]).sum()
    }

    fn subgradient(&self, outputs: &Vector) -> Vector {
        outputs.map(|c| (self.0)(c)[1])
    }

    fn curvature(&self, outputs: &Vector, jacobian: &Matrix) -> Option<Matrix> {
        Some(weighted_gram(jacobian, &outputs.map(|c| (self.0)(c)[2])))
    }
}

#[test]
fn an_outer_function_that_is_not_convex_is_named() {
    let hollow = FnOuter::new(|c: &Vector| (-c.norm(), -c / c.norm().max(1e-300)));
    let concave = Smooth(|c| [-c * c, -2.0 * c, -2.0]);
    for reason in [reason(hollow), reason(concave)] {
        assert!(reason.starts_with("the outer function is not convex: "), "{reason}");
    }
}

#[test]
fn an_outer_function_that_panics_or_misses_entries_is_named() {
    let bowl = |c: &Vector| (c.norm_squared(), c * 2.0);
    let panicking = FnOuter::new(move |c: &Vector| if c[0] < 2.5 { panic!("no table below 2.5") } else { bowl(c) });
    assert_eq!(reason(panicking), "the outer function panicked: no table below 2.5");
    let short = FnOuter::new(move |c: &Vector| if c[0] < 2.5 { (c.norm_squared(), v(&[1.0])) } else { bowl(c) });
    assert_eq!(reason(short), "the subgradient of the outer function has 1 entries, expected 2");
}

#[test]
fn steps_along_which_the_outer_function_overflows_are_shortened() {
    let cosine = FnOuter::new(|c: &Vector| (2.0 * c[0].cosh(), v(&[2.0 * c[0].sinh()])));
    let theta = CompositeFunction::new(1, cosine, |x: &Vector| (x.clone(), Matrix::identity(1, 1)));
    // The first linearization leads from 10 to −10⁴.
    let report = method().minimize(&theta, v(&[10.0])).unwrap();
    let ended = matches!(report.termination, Termination::Stationary { .. } | Termination::NoiseLimit { .. });
    assert!(ended && (report.value - 2.0).abs() < 1e-9, "{report}");
}

/// c(x) = x with an h of which only the objective knows the subgradient.
struct Secret;

impl NonsmoothObjective for Secret {
    type WarmStart = ();

    fn dimension(&self) -> usize {
        1
    }

    fn outer(&self) -> Option<&dyn OuterFunction> {
        Some(&NoSubgradient)
    }

    fn evaluate(&self, request: &Request<'_, ()>) -> Result<Answer<()>, OracleError> {
        let x = request.point[0];
        let mut evaluation = Evaluation::exact(x.abs(), v(&[x.signum()]), ());
        let (outputs, jacobian) = (v(&[x]), Matrix::identity(1, 1));
        let linearization = Linearization { outputs, jacobian, accuracy: 0.0, inactive: None };
        evaluation.linearization = Linearized::if_asked(request.linearization, linearization);
        Ok(Answer::Accurate(evaluation))
    }
}

/// |c| without a subgradient.
struct NoSubgradient;

impl OuterFunction for NoSubgradient {
    fn value(&self, outputs: &Vector) -> f64 {
        outputs[0].abs()
    }

    fn subgradient(&self, outputs: &Vector) -> Vector {
        outputs * f64::NAN
    }
}

#[test]
fn a_subgradient_that_is_no_number_is_named() {
    let report = method().minimize(&Secret, v(&[3.0])).unwrap();
    let reason = "value or subgradient of the outer function is not finite".to_owned();
    assert_eq!(report.termination, Termination::SubproblemFailed { reason });
    let blind = FnOuter::new(|c: &Vector| (c.norm_squared(), c * f64::NAN));
    let theta = CompositeFunction::new(2, blind, |x: &Vector| (x.clone(), Matrix::identity(2, 2)));
    let error = method().minimize(&theta, v(&[3.0, 1.0])).unwrap_err();
    assert_eq!(error.to_string(), "the first evaluation failed: subgradient is not finite");
}

#[test]
fn a_number_of_outputs_that_changes_ends_the_run() {
    let calls = Cell::new(0);
    let theta = CompositeFunction::new(2, Maximum, |x: &Vector| {
        calls.set(calls.get() + 1);
        let (outputs, jacobian) = linearize(x);
        if calls.get() < 3 { (outputs, jacobian) } else { (outputs.remove_row(2), jacobian.remove_row(2)) }
    });
    let report = method().minimize(&theta, v(&[2.0, 2.0])).unwrap();
    let reason = "the vector of outputs has 2 entries, expected 3".to_owned();
    assert_eq!(report.termination, Termination::OracleContradiction { reason: reason.clone() });
    assert_eq!((report.counts.evaluations, report.counts.failed, report.history.len()), (3, 1, 3));
    let failure = format!("the oracle contradicts its earlier answers: {reason}");
    assert_eq!((report.history[2].kind, report.history[2].failure.as_ref()), (StepKind::Failed, Some(&failure)));
    assert!(report.value <= report.start_value && report.to_string().contains(&failure), "{report}");
}

/// x² + 1 in one output, with a value as coarse as it is asked for; a second output where a point is evaluated again.
struct Growing {
    last: RefCell<Vec<f64>>,
}

impl NonsmoothObjective for Growing {
    type WarmStart = ();

    fn dimension(&self) -> usize {
        1
    }

    fn outer(&self) -> Option<&dyn OuterFunction> {
        Some(&Maximum)
    }

    fn evaluate(&self, request: &Request<'_, ()>) -> Result<Answer<()>, OracleError> {
        let x = request.point[0];
        let count = if self.last.borrow().contains(&x) { 2 } else { 1 };
        self.last.borrow_mut().push(x);
        let (value, slope) = (x * x + 1.0, 2.0 * x);
        let (outputs, jacobian) = (Vector::from_element(count, value), Matrix::from_element(count, 1, slope));
        let linearization = Linearization { outputs, jacobian, accuracy: 0.0, inactive: None };
        Ok(Answer::Accurate(Evaluation {
            error_bound: request.accuracy.tolerance() * value,
            linearization: Linearized::if_asked(request.linearization, linearization),
            ..Evaluation::exact(value, v(&[slope]), ())
        }))
    }
}

#[test]
fn a_number_of_outputs_that_changes_at_the_center_ends_the_run() {
    let config = BundleTrustConfig { accuracy: AccuracyPolicy::ON_DEMAND, ..BundleTrustConfig::default() };
    let theta = Growing { last: RefCell::default() };
    let report = BundleTrust::new(config).unwrap().minimize(&theta, v(&[3.0])).unwrap();
    let reason = "the vector of outputs has 2 entries, expected 1".to_owned();
    assert_eq!(report.termination, Termination::OracleContradiction { reason });
    assert_eq!(report.history.last().map(|record| record.kind), Some(StepKind::Refinement), "{report}");
}

#[test]
fn outputs_that_are_no_numbers_shorten_the_step() {
    // −x up to 1, and beyond it NaN in all outputs, in the first or in the last one.
    for no_numbers in [[true, true], [true, false], [false, true]] {
        let theta = CompositeFunction::new(1, Maximum, |x: &Vector| {
            let outputs = [-x[0], -x[0] - 1.0];
            let output = |i: usize| if x[0] > 1.0 && no_numbers[i] { f64::NAN } else { outputs[i] };
            (v(&[output(0), output(1)]), Matrix::from_element(2, 1, -1.0))
        });
        let set = Polyhedron::boxed(v(&[0.0]), v(&[5.0])).unwrap();
        let report = method().constraints(set).minimize(&theta, v(&[0.0])).unwrap();
        let entry = usize::from(!no_numbers[0]);
        let text = format!("outputs: entry {entry} is NaN, expected a finite number");
        let failures: Vec<_> = report.history.iter().filter_map(|record| record.failure.as_ref()).collect();
        assert!(!failures.is_empty() && failures.iter().all(|failure| **failure == text), "{failures:?}");
        // The failures end the run next to the edge.
        assert!((report.solution[0] - 1.0).abs() < 1e-6 && report.value == -report.solution[0], "{report}");
        assert!(matches!(report.termination, Termination::OracleFailing { .. }), "{report}");
    }
}

/// c(x) = x with the constraint x ≤ 0.05 inside, next to the minimum 0 of c².
struct Threshold;

impl NonsmoothObjective for Threshold {
    type WarmStart = ();

    fn dimension(&self) -> usize {
        1
    }

    fn outer(&self) -> Option<&dyn OuterFunction> {
        Some(&Smooth(|c| if c > 0.06 { panic!("no table above 0.06") } else { [c * c, 2.0 * c, 2.0] }))
    }

    fn evaluate(&self, request: &Request<'_, ()>) -> Result<Answer<()>, OracleError> {
        let x = request.point[0];
        let mut evaluation = Evaluation::exact(x * x, v(&[2.0 * x]), ());
        let inactive = InactiveConstraints { slacks: v(&[0.05 - x]), jacobian: Matrix::from_element(1, 1, -1.0) };
        let (outputs, jacobian) = (v(&[x]), Matrix::identity(1, 1));
        let linearization =
            Linearization { outputs, jacobian, accuracy: 0.0, inactive: (x < 0.05).then_some(inactive) };
        evaluation.linearization = Linearized::if_asked(request.linearization, linearization);
        Ok(Answer::Accurate(evaluation))
    }
}

#[test]
fn a_proof_outlives_an_outer_function_that_fails_beyond_it() {
    let report = method().minimize(&Threshold, v(&[-1.0])).unwrap();
    assert!(matches!(report.termination, Termination::Stationary { .. }) && report.value < 1e-12, "{report}");
    assert!(report.certificate.is_some_and(|certificate| certificate.composite.is_some()));
}

#[test]
fn the_outer_function_of_a_plain_objective_is_not_asked_for() {
    let report =
        method().minimize(&FnObjective::new(1, |x: &Vector| (x[0].abs(), v(&[x[0].signum()]))), v(&[2.0])).unwrap();
    assert!(report.history.iter().all(|record| !record.jacobian && record.note.is_none()));
}
