//! Who proposes trial points is named in every record and counted.

use crate::common::{crescent, v};
use nonsmooth::{
    BundleTrust, BundleTrustConfig, FnObjective, IterationRecord, Matrix, Origin, Polyhedron, Report, StepKind,
    Termination, Vector,
};

fn run(config: BundleTrustConfig) -> Report {
    // The valley of a steep quadratic with a kink beside it: the curved model earns its trust here.
    let theta = nonsmooth::FnObjective::new(3, |x: &Vector| {
        let residual = x[1] - x[0] * x[0];
        let value = 50.0 * residual * residual + (1.0 - x[0]).powi(2) + x[2].abs();
        let gradient = vec![-200.0 * residual * x[0] - 2.0 * (1.0 - x[0]), 100.0 * residual, x[2].signum()];
        (value, Vector::from_vec(gradient))
    });
    BundleTrust::new(config).unwrap().minimize(&theta, v(&[-1.2, 1.0, 0.7])).unwrap()
}

fn named(report: &Report, origin: Origin) -> usize {
    report.history.iter().filter(|record| record.origin == origin).count()
}

#[test]
fn every_record_names_its_origin_and_the_counts_agree() {
    let report = run(BundleTrustConfig::default());
    let trials = report.counts.trials;
    assert_eq!(trials.cuts, named(&report, Origin::Cuts));
    assert_eq!(trials.curved_model, named(&report, Origin::CurvedModel));
    assert_eq!(trials.confirmation, named(&report, Origin::Confirmation));
    assert!(trials.curved_model > 0, "{report}");
    assert!(report.history.iter().all(|record| (record.kind == StepKind::Start) == (record.origin == Origin::Given)));
    assert_eq!(trials.cuts + trials.curved_model + trials.confirmation, report.counts.evaluations - 1);
}

#[test]
fn a_report_of_a_run_that_has_not_ended_says_so() {
    let theta = crescent();
    let mut method = BundleTrust::new(BundleTrustConfig::default()).unwrap();
    let mut run = method.start(&theta, v(&[-1.2, 1.0])).unwrap();
    assert!(run.step().is_continue());
    assert_eq!(run.finish().termination, Termination::Unfinished);
}

/// The report of a run of a problem of the collection, and its evaluations to 1e-6.
fn solve(name: &str, config: BundleTrustConfig) -> (Report, usize) {
    let problem = testset::find(name).unwrap();
    let theta = FnObjective::new(problem.dimension, |x: &Vector| {
        let (value, subgradient) = problem.evaluate(x.as_slice());
        (value, v(&subgradient))
    });
    let rows = Matrix::from_fn(problem.rows.len(), problem.dimension, |i, j| problem.rows[i][j]);
    let set = Polyhedron::unbounded(problem.dimension).with_rows(&rows, &v(&problem.row_lower), &v(&problem.row_upper));
    let mut method = BundleTrust::new(config).unwrap().constraints(set.unwrap());
    let report = method.minimize(&theta, v(&problem.start)).unwrap();
    let reached = |step: &&IterationRecord| step.center_value - problem.optimal_value <= 1e-6;
    let evaluations = report.history.iter().find(reached).unwrap().evaluation;
    (report, evaluations)
}

/// |x₂ − 2x₁² + 1| is a curved valley with one concave piece: a model that allows concave pieces follows it.
#[test]
fn a_curved_valley_is_followed() {
    let (report, evaluations) = solve("ChebRosenN1_2", BundleTrustConfig::default());
    // 16 where this was written; 102 with convex pieces alone.
    assert!(evaluations <= 30, "{evaluations}");
    // The minimum is zero, beside which no slope along the valley is small: the end need not be confirmed.
    assert!(report.termination.is_stationary(), "{}", report.termination);
}

#[test]
fn a_start_beside_a_pole_is_left() {
    let theta = FnObjective::new(1, |x: &Vector| {
        let slope = if x[0] > 2.0 { 1.0 } else { -1.0 };
        (1.0 / x[0].abs() + (x[0] - 2.0).abs(), v(&[-1.0 / (x[0] * x[0].abs()) + slope]))
    });
    let report = BundleTrust::new(BundleTrustConfig::default()).unwrap().minimize(&theta, v(&[1e-8])).unwrap();
    // 78 where this was written; 223 with a floor that stays.
    assert!(report.termination.is_stationary(), "{}", report.termination);
    assert!((report.solution[0] - 2.0).abs() <= 1e-6, "{}", report.solution[0]);
    assert!(report.counts.evaluations <= 150, "{}", report.counts.evaluations);
}
