//! The engine away from contact: sizes, starts, degenerate functions and sets.
use crate::common::{cb3, crescent, distance_1, minimize, plane, v};
use nonsmooth::{
    BundleTrust, BundleTrustConfig, FnObjective, InputError, Matrix, OptimizeError, Polyhedron, Termination,
    VariableScaling, Vector,
};

#[test]
fn one_variable() {
    let report = minimize(&distance_1(v(&[0.3])), None, &[17.0]);
    assert!(report.value < 1e-9, "{report}");
    assert!(report.termination.is_stationary());
}

#[test]
fn a_thousand_variables() {
    let n = 1000;
    let theta = FnObjective::new(n, |x: &Vector| {
        let worst = x.iamax();
        let mut gradient = x * 2.0;
        gradient[worst] += x[worst].signum();
        (x.norm_squared() + x[worst].abs(), gradient)
    });
    let start: Vec<f64> = (0..n).map(|i| ((i * 7919) % 1000) as f64 / 1000.0 - 0.4).collect();
    let config = BundleTrustConfig { max_evaluations: 150, ..Default::default() };
    let report = BundleTrust::new(config).unwrap().minimize(&theta, v(&start)).unwrap();
    assert!(report.value < 1e-4 * report.start_value, "{report}");
}

#[test]
fn start_at_a_smooth_minimiser_stops_at_once() {
    let theta = FnObjective::new(3, |x: &Vector| (x.norm_squared(), x * 2.0));
    let report = minimize(&theta, None, &[0.0; 3]);
    // One more evaluation tells the minimum from a plateau.
    assert_eq!((report.counts.evaluations, report.history.len()), (2, 1));
    assert!(report.warnings.is_empty());
    assert!(report.termination.is_confirmed());
}

#[test]
fn start_at_a_kink_that_is_the_minimiser() {
    let report = minimize(&cb3(), None, &[1.0, 1.0]);
    assert!((report.value - 2.0).abs() < 1e-6, "{report}");
    assert!(report.termination.is_stationary(), "{report}");
}

#[test]
fn start_on_a_kink_that_is_no_minimiser() {
    let report = minimize(&crescent(), None, &[-0.5, 0.25]);
    assert!(report.value < 1e-5, "{report}");
}

#[test]
fn constant_function_is_stationary_everywhere() {
    let report = minimize(&FnObjective::new(2, |_: &Vector| (5.0, Vector::zeros(2))), None, &[1.0, 2.0]);
    // Two more evaluations show that it is constant around the start.
    assert_eq!((report.counts.evaluations, report.history.len()), (3, 1));
    assert!(report.termination.is_confirmed());
}

#[test]
fn zero_function_is_stationary_everywhere() {
    let report = minimize(&FnObjective::new(2, |_: &Vector| (0.0, Vector::zeros(2))), None, &[1.0, 2.0]);
    assert!(report.termination.is_confirmed());
}

#[test]
fn fixed_variables_stay_fixed() {
    let set = Polyhedron::boxed(v(&[2.0, -5.0]), v(&[2.0, 5.0])).unwrap();
    let report = minimize(&distance_1(v(&[0.0, 1.0])), Some(set), &[0.0, -4.0]);
    assert_eq!(report.solution[0], 2.0);
    assert!((report.value - 2.0).abs() < 1e-6, "{report}");
}

#[test]
fn all_variables_fixed() {
    let set = Polyhedron::boxed(v(&[2.0, 3.0]), v(&[2.0, 3.0])).unwrap();
    let report = minimize(&distance_1(v(&[0.0, 1.0])), Some(set), &[0.0, 0.0]);
    assert_eq!(report.counts.evaluations, 1);
    assert!(report.termination.is_stationary(), "{report}");
}

#[test]
fn equality_has_no_interior() {
    let report = minimize(&distance_1(v(&[0.0; 4])), Some(plane(&[1.0, 2.0, 3.0, 4.0], 2.0, 10.0)), &[5.0; 4]);
    assert!((report.value - 0.5).abs() < 1e-6, "{report}");
    assert!(report.largest_violation <= 1e-12, "{report}");
}

#[test]
fn infeasible_set_is_an_error_with_the_violation() {
    let rows = Matrix::from_row_slice(2, 2, &[1.0, 1.0, 1.0, 1.0]);
    let (low, high) = (v(&[f64::NEG_INFINITY, 3.0]), v(&[1.0, f64::INFINITY]));
    let set = Polyhedron::unbounded(2).with_rows(&rows, &low, &high).unwrap();
    let error = BundleTrust::new(BundleTrustConfig::default())
        .unwrap()
        .constraints(set)
        .minimize(&distance_1(v(&[0.0, 0.0])), v(&[0.0, 0.0]))
        .unwrap_err();
    assert!(matches!(error, OptimizeError::Infeasible { violation } if violation > 0.0), "{error}");
}

#[test]
fn wrong_sizes_and_numbers_are_named() {
    let mut method = BundleTrust::new(BundleTrustConfig::default()).unwrap();
    let theta = distance_1(v(&[0.0, 0.0]));
    let error = method.minimize(&theta, v(&[1.0])).unwrap_err();
    assert!(matches!(error, OptimizeError::Input(InputError::Dimension { expected: 2, found: 1, .. })));
    let error = method.minimize(&theta, v(&[1.0, f64::NAN])).unwrap_err();
    assert!(matches!(error, OptimizeError::Input(InputError::NotFinite { index: 1, .. })));
    let config = BundleTrustConfig { tolerance: 1.0, ..Default::default() };
    let error = BundleTrust::new(config).unwrap_err();
    assert!(matches!(error, InputError::OutOfRange { setting: "tolerance", .. }));
}

#[test]
fn linear_function_is_unbounded_below() {
    let report = minimize(&FnObjective::new(2, |x: &Vector| (x[0] - x[1], v(&[1.0, -1.0]))), None, &[1.0, 2.0]);
    assert_eq!(report.termination, Termination::UnboundedBelow, "{report}");
}

#[test]
fn concave_function_is_unbounded_below() {
    let report = minimize(&FnObjective::new(1, |x: &Vector| (-x[0] * x[0], x * -2.0)), None, &[1.0]);
    assert_eq!(report.termination, Termination::UnboundedBelow, "{report}");
}

#[test]
fn linear_function_over_a_box_ends_in_a_vertex() {
    let set = Polyhedron::boxed(v(&[-1.0, -2.0]), v(&[3.0, 4.0])).unwrap();
    let report = minimize(&FnObjective::new(2, |x: &Vector| (x[0] - x[1], v(&[1.0, -1.0]))), Some(set), &[1.0, 2.0]);
    assert_eq!(report.solution, v(&[-1.0, 4.0]));
    assert!(report.termination.is_stationary(), "{report}");
}

#[test]
fn duplicate_cuts_do_no_harm() {
    // The subgradient is piecewise constant: many evaluations give the same cut.
    let theta = FnObjective::new(2, |x: &Vector| {
        crate::common::maximum(vec![
            (x[0] + 2.0 * x[1], v(&[1.0, 2.0])),
            (x[0] - 2.0 * x[1], v(&[1.0, -2.0])),
            (-3.0 * x[0], v(&[-3.0, 0.0])),
        ])
    });
    let config = BundleTrustConfig { first_step: Some(1e-3), ..Default::default() };
    let report = BundleTrust::new(config).unwrap().minimize(&theta, v(&[50.0, 20.0])).unwrap();
    assert!(report.value.abs() < 1e-6, "{report}");
}

#[test]
fn badly_scaled_variables_with_typical_sizes() {
    let sizes = v(&[1e-6, 1.0, 1e6]);
    let theta = FnObjective::new(3, |x: &Vector| {
        let scaled = v(&[x[0] / 1e-6, x[1], x[2] / 1e6]);
        let worst = scaled.iamax();
        let mut gradient = scaled.map(|entry| 2.0 * entry);
        gradient[worst] += scaled[worst].signum();
        (scaled.norm_squared() + scaled[worst].abs(), v(&[gradient[0] / 1e-6, gradient[1], gradient[2] / 1e6]))
    });
    let start = v(&[2e-6, -3.0, 4e6]);
    let config = BundleTrustConfig { scaling: VariableScaling::Typical(sizes), ..Default::default() };
    let scaled = BundleTrust::new(config).unwrap().minimize(&theta, start).unwrap();
    assert!(scaled.value < 1e-6, "{scaled}");
    assert!(scaled.counts.evaluations < 60, "{scaled}");
}

#[test]
fn units_of_the_objective_do_not_matter() {
    let run = |factor: f64| {
        let inner = cb3();
        let theta = FnObjective::new(2, move |x: &Vector| {
            use nonsmooth::NonsmoothObjective;
            let answer = inner.evaluate(&nonsmooth::Request::tight(x)).unwrap().into_evaluation();
            (answer.value * factor, answer.subgradient * factor)
        });
        minimize(&theta, None, &[2.0, 2.0])
    };
    let reference = run(1.0);
    for factor in [2f64.powi(-60), 2f64.powi(60)] {
        let report = run(factor);
        assert_eq!(report.solution, reference.solution);
        assert_eq!(report.counts.evaluations, reference.counts.evaluations);
    }
}
