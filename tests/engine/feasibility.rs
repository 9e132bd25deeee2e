//! Every point that is evaluated is admissible, over random sets and objectives.
use crate::common::v;
use nonsmooth::{BundleTrust, BundleTrustConfig, FnObjective, Matrix, Polyhedron, Vector};
use proptest::prelude::*;
use std::cell::Cell;

const N: usize = 4;

prop_compose! {
    /// Rows through a random interior point, every third one an equality, and a box around it.
    fn polyhedron()(
        entries in prop::collection::vec(-1.0..1.0f64, 3 * N),
        inside in prop::collection::vec(-1.0..1.0f64, N),
        slack in prop::collection::vec(0.0..0.5f64, 3),
        width in prop::collection::vec(0.0..2.0f64, N),
        scale in -4..5i32,
    ) -> (Polyhedron, f64) {
        let size = 10f64.powi(scale);
        let rows = Matrix::from_row_slice(3, N, &entries);
        let inside = v(&inside) * size;
        let at = &rows * &inside;
        let upper = Vector::from_fn(3, |i, _| at[i] + if i == 0 { 0.0 } else { slack[i] * size });
        let lower = Vector::from_fn(3, |i, _| if i == 0 { at[i] } else { f64::NEG_INFINITY });
        let half = v(&width) * size;
        let set = Polyhedron::boxed(&inside - &half, &inside + &half).unwrap();
        (set.with_rows(&rows, &lower, &upper).unwrap(), size)
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 256, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn every_evaluation_is_admissible(
        (set, size) in polyhedron(),
        slopes in prop::collection::vec(-2.0..2.0f64, 5 * N),
        curvature in -0.5..1.0f64,
        start in prop::collection::vec(-3.0..3.0f64, N),
    ) {
        let worst = Cell::new(0.0_f64);
        let slopes = Matrix::from_row_slice(5, N, &slopes);
        let theta = FnObjective::new(N, |x: &Vector| {
            worst.set(worst.get().max(set.violation(x)));
            let y = x / size;
            let values = &slopes * &y;
            let active = values.imax();
            let gradient = slopes.row(active).transpose() + &y * (2.0 * curvature);
            (values[active] + curvature * y.norm_squared(), gradient / size)
        });
        let config = BundleTrustConfig { max_evaluations: 120, ..Default::default() };
        let mut method = BundleTrust::new(config).unwrap().constraints(set.clone());
        let report = method.minimize(&theta, v(&start) * size).unwrap();
        prop_assert!(worst.get() <= 1e-9, "violation {} {report}", worst.get());
        let failed = matches!(report.termination, nonsmooth::Termination::SubproblemFailed { .. });
        prop_assert!(!failed, "{report}");
    }
}
