//! Several runs in turn, and objectives on subspaces.

use nonsmooth::composite::Maximum;
use nonsmooth::runs::{Ended, Stage, Subspace, moved_start, run_in_turn};
use nonsmooth::{BundleTrust, BundleTrustConfig, CompositeFunction, Matrix, Polyhedron, Termination, Vector};
use std::ops::ControlFlow;
use std::sync::Arc;

/// max(x², 2 y + 3 z) on the line (1, 1, 0) + β (1, −1, 0), with its minimum where x² = 2 y.
#[test]
fn a_line_through_a_kink() {
    let theta = CompositeFunction::new(3, Maximum, |p: &Vector| {
        let rows = [2.0 * p[0], 0.0, 0.0, 0.0, 2.0, 3.0];
        (Vector::from_vec(vec![p[0] * p[0], 2.0 * p[1] + 3.0 * p[2]]), Matrix::from_row_slice(2, 3, &rows))
    });
    let origin = Vector::from_vec(vec![1.0, 1.0, 0.0]);
    let line = Subspace::new(theta, origin, Matrix::from_vec(3, 1, vec![1.0, -1.0, 0.0]));
    let lower = Vector::from_vec(vec![-9.0, -9.0, -1.0]);
    let whole = Polyhedron::boxed(lower, Vector::from_element(3, 9.0)).unwrap();
    let set = line.set(&whole).unwrap();
    let mut method = BundleTrust::new(BundleTrustConfig::default()).unwrap().constraints(set);
    let report = line.reported(method.minimize(&line, Vector::zeros(1)).unwrap());
    // x² = 2 (2 − x).
    let x = 5.0_f64.sqrt() - 1.0;
    assert!((report.solution[0] - x).abs() < 1e-6 && (report.solution[1] - 2.0 + x).abs() < 1e-6, "{report}");
    assert!(report.solution.len() == 3 && report.certificate.is_none());
}
/// Whoever watches a run in a subspace sees points of the whole space; a run that is stopped is the last one, and all
/// that has ended stays.
#[test]
fn runs_in_a_subspace_are_watched_in_the_whole_space() {
    let theta = Arc::new(CompositeFunction::new(2, Maximum, |p: &Vector| {
        (Vector::from_vec(vec![p[0] - p[1], p[1] - p[0]]), Matrix::from_row_slice(2, 2, &[1.0, -1.0, -1.0, 1.0]))
    }));
    let set = Polyhedron::boxed(Vector::from_element(2, -9.0), Vector::from_element(2, 9.0)).unwrap();
    let start = moved_start(&set, &Vector::zeros(2), &Vector::from_vec(vec![4.0, 0.5]), 40.0).unwrap();
    assert_eq!(start, Vector::from_vec(vec![9.0, 5.0]));
    let (mut ended, mut seen) = (Vec::new(), 0);
    let next = |ended: &[Ended<_, usize>]| {
        let directions = Some(Matrix::from_vec(2, 1, vec![0.0, 1.0]));
        let (objective, config) = (Arc::clone(&theta), BundleTrustConfig::default());
        let stage = Stage { label: ended.len(), objective, set: set.clone(), start: start.clone(), directions, config };
        Ok::<_, nonsmooth::OptimizeError>(Some(stage))
    };
    let perform = |stage: Stage<_, usize>| {
        let is_stopped = stage.label == 1;
        let report = stage.run(&*stage.objective, &mut |center, new| {
            assert!(center.len() == 2 && center[0] == 9.0);
            seen += new.len();
            if is_stopped { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        })?;
        Ok(Ended { is_last: is_stopped, stage, report, replayed: 0, is_kept: true })
    };
    run_in_turn(&mut ended, next, perform).unwrap();
    let [whole, stopped] = &ended[..] else { panic!("{} runs", ended.len()) };
    assert!((whole.report.solution[1] - 9.0).abs() < 1e-6 && whole.report.termination.is_stationary());
    assert_eq!((&stopped.report.termination, &stopped.report.solution), (&Termination::StoppedByObserver, &start));
    assert_eq!(seen, whole.report.history.len() + 1);
}
