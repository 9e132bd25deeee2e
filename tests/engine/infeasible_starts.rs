//! Starts that violate nonlinear constraints where the objective, or the violation, has no slope.

use nonsmooth::{
    BundleTrust, BundleTrustConfig, ConstrainedFunction, ConstraintEvaluation, ConstraintKind, Matrix,
    NonsmoothObjective, Report, Termination, Vector,
};

fn v(values: &[f64]) -> Vector {
    Vector::from_column_slice(values)
}

fn found(values: &[f64], rows: &[f64]) -> ConstraintEvaluation {
    ConstraintEvaluation::new(v(values), Matrix::from_row_slice(values.len(), rows.len() / values.len(), rows))
}

/// Runs with and without the composite model.
fn both(theta: &impl NonsmoothObjective, start: &Vector) -> [Report; 2] {
    [true, false].map(|composite_model| {
        let config = BundleTrustConfig { composite_model, max_evaluations: 200, ..BundleTrustConfig::default() };
        BundleTrust::new(config).unwrap().minimize(theta, start.clone()).unwrap()
    })
}

fn point(n: usize) -> Vector {
    Vector::from_fn(n, |i, _| 1.0 + 2.5 * (1.3 * i as f64 + 0.4).sin())
}

/// min |x − p|² in the unit ball, on the unit sphere and in two half-spaces, from p: the gradient of the objective
/// vanishes there.
#[test]
fn projections_begin_at_the_point_itself() {
    for n in [2, 5, 20, 50] {
        let p = point(n);
        let ball = |kind| {
            let p = p.clone();
            ConstrainedFunction::new(n, vec![kind], move |x: &Vector| {
                let d = x - &p;
                (d.norm_squared(), &d * 2.0, found(&[x.norm_squared() - 1.0], (x * 2.0).as_slice()))
            })
        };
        let expected = (p.norm() - 1.0).powi(2);
        for kind in [ConstraintKind::Smooth, ConstraintKind::SmoothEquality] {
            // 20 asked for; the composite model takes up to 29 in 20 variables.
            for (report, most) in both(&ball(kind), &p).into_iter().zip([30, 20]) {
                assert!((report.value - expected).abs() <= 1e-6 * expected, "{report}");
                assert!(report.is_feasible() && report.counts.evaluations <= most, "{report}");
            }
        }
    }
}

/// Hard margins: min ½|w|² with y (w·z + b) ≥ 1, from 0.
#[test]
fn a_hard_margin_is_found_from_zero() {
    let data: Vec<([f64; 2], f64)> = (0..20)
        .map(|i| {
            let (t, y) = (f64::from(i), if i % 2 == 0 { 1.0 } else { -1.0 });
            ([2.0 * y + (1.1 * t).sin(), (2.3 * t).cos()], y)
        })
        .collect();
    let theta = ConstrainedFunction::new(3, vec![ConstraintKind::Smooth; data.len()], |x: &Vector| {
        let margins: Vec<f64> = data.iter().map(|(z, y)| 1.0 - y * (x[0] * z[0] + x[1] * z[1] + x[2])).collect();
        let rows: Vec<f64> = data.iter().flat_map(|(z, y)| [-y * z[0], -y * z[1], -y]).collect();
        (0.5 * (x[0] * x[0] + x[1] * x[1]), v(&[x[0], x[1], 0.0]), found(&margins, &rows))
    });
    let [first, second] = both(&theta, &Vector::zeros(3));
    assert!(first.is_feasible() && second.is_feasible(), "{first}\n{second}");
    assert!((first.value - second.value).abs() <= 1e-6 * first.value && first.value > 0.1, "{first}\n{second}");
}

/// Nothing but constraints: the objective has no slope anywhere.
#[test]
fn a_constant_objective_leaves_the_constraints() {
    for n in [2, 5, 20] {
        let theta = ConstrainedFunction::new(n, vec![ConstraintKind::Smooth; 2], move |x: &Vector| {
            let mut rows = (x * 2.0).as_slice().to_vec();
            rows.extend((0..n).map(|i| if i == 0 { -1.0 } else { 0.0 }));
            (0.0, Vector::zeros(n), found(&[x.norm_squared() - 1.0, 0.5 - x[0]], &rows))
        });
        for report in both(&theta, &point(n)) {
            assert!(report.is_feasible() && report.counts.evaluations <= 20, "{report}");
        }
    }
}

/// Violations that are stationary at the start: the objective leads out, or growth of second order does.
#[test]
fn stationary_violations_are_left() {
    let outside = |x: &Vector| found(&[1.0 - x[0] * x[0]], &[-2.0 * x[0], 0.0]);
    let sign = |x: f64| if x == 0.0 { 0.0 } else { x.signum() };
    let along = ConstrainedFunction::new(2, vec![ConstraintKind::Smooth], |x: &Vector| {
        ((x[0] - 2.0).abs() + x[1].abs(), v(&[sign(x[0] - 2.0), sign(x[1])]), outside(x))
    });
    let aside = ConstrainedFunction::new(2, vec![ConstraintKind::Smooth], |x: &Vector| {
        (x[1] * x[1], v(&[0.0, 2.0 * x[1]]), outside(x))
    });
    for report in both(&along, &Vector::zeros(2)).into_iter().chain(both(&aside, &Vector::zeros(2))) {
        assert!(report.value < 1e-6 && report.is_feasible(), "{report}");
    }
}

/// Where nothing leads out, the run says so after three more points.
#[test]
fn an_empty_set_is_told_after_the_ways_out() {
    let theta = ConstrainedFunction::new(2, vec![ConstraintKind::Smooth], |x: &Vector| {
        (x[0], v(&[1.0, 0.0]), found(&[1.0 + x.norm_squared()], (x * 2.0).as_slice()))
    });
    for report in both(&theta, &Vector::zeros(2)) {
        assert!(matches!(report.termination, Termination::Infeasible { violation } if violation > 0.0), "{report}");
        assert!(report.counts.evaluations <= 4, "{report}");
    }
}
