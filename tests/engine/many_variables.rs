//! Many variables: the work per evaluation grows in proportion to cuts × variables, and the evaluations stay few.

use crate::common::is_study;
use nonsmooth::{BundleTrust, BundleTrustConfig, FnObjective, Report, Vector};
use std::cell::Cell;
use testset::Scalable;

/// A run until f − f* ≤ 1e-6 (1 + |f*|), and the evaluations that took.
fn run(problem: &Scalable, config: BundleTrustConfig) -> (Option<usize>, Report) {
    let (count, hit) = (Cell::new(0), Cell::new(None));
    let level = 1e-6 * (1.0 + problem.optimal_value.abs());
    let theta = FnObjective::new(problem.start.len(), |x: &Vector| {
        let (value, gradient) = problem.evaluate(x.as_slice());
        count.set(count.get() + 1);
        if hit.get().is_none() && value - problem.optimal_value <= level {
            hit.set(Some(count.get()));
        }
        (value, Vector::from_vec(gradient))
    });
    let mut method = BundleTrust::new(config).unwrap();
    let mut run = method.start(&theta, Vector::from_vec(problem.start.clone())).unwrap();
    while hit.get().is_none() && run.step().is_continue() {}
    (hit.get(), run.finish())
}

fn check(problem: &Scalable, config: BundleTrustConfig, (pinned, allowed): (usize, usize)) {
    let begun = std::time::Instant::now();
    let (count, report) = run(problem, config);
    if is_study() {
        let per_evaluation = 1e3 * begun.elapsed().as_secs_f64() / report.counts.evaluations as f64;
        let n = problem.start.len();
        println!("{} n = {n}: {} evaluations, {per_evaluation:.2} ms each", problem.name, report.counts.evaluations);
    }
    let count = count.unwrap_or_else(|| panic!("{}: not solved, {report}", problem.name));
    assert!(count <= allowed, "{}: {count} evaluations", problem.name);
    // The last bit of long sums, which the registers of the processor decide, leads two courses apart.
    assert!(count.abs_diff(pinned) <= pinned / 4, "{}: {count} evaluations, pinned {pinned}", problem.name);
    assert_eq!(report.counts.qp_fallbacks, 0, "{report}");
}

#[test]
fn a_chain_of_a_thousand_kinks_is_solved() {
    check(&Scalable::chained_lq(1000), BundleTrustConfig::default(), (135, 600));
    if is_study() {
        check(&Scalable::chained_lq(200), BundleTrustConfig::default(), (197, 600));
        check(&Scalable::chained_lq(3000), BundleTrustConfig::default(), (138, 600));
    }
}

#[test]
fn the_largest_of_three_chains_of_a_thousand_variables_is_solved() {
    check(&Scalable::chained_cb3_ii(1000), BundleTrustConfig::default(), (22, 600));
    if is_study() {
        check(&Scalable::chained_cb3_ii(200), BundleTrustConfig::default(), (33, 600));
        check(&Scalable::chained_cb3_ii(3000), BundleTrustConfig::default(), (35, 600));
    }
}

#[test]
fn the_largest_of_two_hundred_squares_is_solved() {
    // Beyond a hundred variables, runs do without the dense matrices of the curved model.
    check(&Scalable::maxq(201), BundleTrustConfig::default(), (1677, 2000));
}

#[test]
fn a_bundle_of_a_thousand_variables_does_not_leave_the_convex_hull_of_its_cuts() {
    let (_, report) = run(&Scalable::chained_lq(1000), BundleTrustConfig::default());
    let certificate = report.certificate.unwrap();
    let check = certificate.recheck(&nonsmooth::Polyhedron::unbounded(1000)).unwrap();
    assert!(check.multiplier_defect <= 1e-12, "{check:?}");
    assert!(
        (check.aggregate_norm - certificate.aggregate_norm).abs() <= 1e-9 * certificate.aggregate_norm,
        "{check:?}"
    );
}
