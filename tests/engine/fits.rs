//! Fits of many data: sums of powers and norms of residuals, linear and not, solved by cones or by Newton's method.

use nonsmooth::composite::{EuclideanNorm, FnOuter, OuterFunction, SumOfPowers};
use nonsmooth::verify::seeded_direction;
use nonsmooth::{BundleTrust, BundleTrustConfig, CompositeFunction, Matrix, Polyhedron, Report, Vector};

const VARIABLES: usize = 10;

/// Residuals a_i·x + s sin(a_i·x) − b_i with a_i scaled by rows and columns over two decades.
fn residuals(data: usize, curvature: f64) -> impl Fn(&Vector) -> (Vector, Matrix) {
    let columns = |i: usize| seeded_direction(VARIABLES, i as u64);
    let scale = |i: usize, j: usize| 10_f64.powf((0.37 * i as f64).sin() + (0.7 * j as f64).cos());
    let rows = Matrix::from_fn(data, VARIABLES, |i, j| columns(i)[j] * scale(i, j));
    let wanted = seeded_direction(data, 7) * 3.0;
    move |x| {
        let linear = &rows * x;
        let slopes = linear.map(|z| 1.0 + curvature * z.cos());
        (linear.map(|z| z + curvature * z.sin()) - &wanted, Matrix::from_diagonal(&slopes) * &rows)
    }
}

/// A box and a row that both cut off the fit without constraints.
fn tight() -> Polyhedron {
    let row = Matrix::from_element(1, VARIABLES, 1.0);
    let (low, high) = (Vector::from_element(1, 0.01), Vector::from_element(1, f64::INFINITY));
    let side = Vector::from_element(VARIABLES, 0.02);
    Polyhedron::boxed(-&side, side).and_then(|set| set.with_rows(&row, &low, &high)).unwrap()
}

fn fit(outer: &dyn OuterFunction, (data, curvature): (usize, f64), set: &Polyhedron) -> Report {
    let theta = CompositeFunction::new(VARIABLES, outer, residuals(data, curvature));
    let config = BundleTrustConfig { max_evaluations: 60, ..BundleTrustConfig::default() };
    BundleTrust::new(config).unwrap().constraints(set.clone()).minimize(&theta, Vector::zeros(VARIABLES)).unwrap()
}

fn functions() -> Vec<(&'static str, Box<dyn OuterFunction>)> {
    vec![
        ("sum of absolute values", Box::new(SumOfPowers { exponent: 1.0 })),
        ("powers 1.2", Box::new(SumOfPowers { exponent: 1.2 })),
        ("powers 1.5", Box::new(SumOfPowers { exponent: 1.5 })),
        ("squares", Box::new(SumOfPowers { exponent: 2.0 })),
        ("fourth powers", Box::new(SumOfPowers { exponent: 4.0 })),
        ("Euclidean norm", Box::new(EuclideanNorm)),
    ]
}

/// Linear residuals need one model: what is beyond a few evaluations is the weight, which starts large.
#[test]
fn linear_fits_end_confirmed_with_a_proof_that_holds() {
    for (name, outer) in functions() {
        for (set, active) in [(Polyhedron::unbounded(VARIABLES), false), (tight(), true)] {
            let report = fit(&*outer, (300, 0.0), &set);
            assert!(report.termination.is_confirmed(), "{name}: {report}");
            assert!(report.counts.evaluations <= 10, "{name}: {report}");
            let certificate = report.certificate.unwrap();
            // h and all residuals are convex, so that the certificate bounds what is left: within reach of each
            // variable.
            let check = certificate.recheck(&set).unwrap();
            let left = check.aggregate_error + check.aggregate_norm * 2.0 * report.solution.norm();
            assert!(left <= 1e-5 * report.value, "{name}: {left:e} of {:e}", report.value);
            let proof = certificate.composite.as_ref().unwrap();
            assert!(proof.recheck(&certificate, &*outer).unwrap().largest() < 1e-9, "{name}");
            assert_eq!(certificate.bound_multipliers.amax() > 1e-3, active, "{name}");
        }
    }
}

/// As closures, the functions are solved by cuts: a second path to the values of the composite model.
#[test]
fn cones_and_cuts_lead_to_the_same_fit() {
    for (name, outer) in functions() {
        for set in [Polyhedron::unbounded(VARIABLES), tight()] {
            let by_cones = fit(&*outer, (40, 0.3), &set);
            let closure = FnOuter::new(|c: &Vector| (outer.value(c), outer.subgradient(c)));
            let by_cuts = fit(&closure, (40, 0.3), &set);
            assert!(by_cones.termination.is_confirmed(), "{name}: {by_cones}");
            let difference = (by_cones.value - by_cuts.value).abs();
            assert!(difference <= 1e-6 * by_cuts.value, "{name}: {} {}", by_cones.value, by_cuts.value);
            assert!(by_cones.counts.qp_solves < by_cuts.counts.qp_solves, "{name}");
        }
    }
}

/// Residuals that vanish at the solution: a kink of the norm and of the sum, where w is inside the domain of h*.
#[test]
fn exact_fits_are_confirmed() {
    let rows = Matrix::from_fn(40, VARIABLES, |i, j| seeded_direction(VARIABLES, i as u64)[j]);
    let solution = seeded_direction(VARIABLES, 99);
    for (name, outer) in functions() {
        let theta = CompositeFunction::new(VARIABLES, &*outer, |x: &Vector| (&rows * (x - &solution), rows.clone()));
        let report =
            BundleTrust::new(BundleTrustConfig::default()).unwrap().minimize(&theta, Vector::zeros(VARIABLES)).unwrap();
        assert!(report.termination.is_confirmed(), "{name}: {report}");
        let size = outer.value(&(&rows * &solution));
        assert!(report.value <= 1e-6 * size, "{name}: {:e} of {size:e}", report.value);
    }
}

/// The weights of a norm have length one up to the rounding of all entries; a sum of roots is not convex.
#[test]
fn many_equal_residuals_and_exponents_below_one() {
    let many = |x: &Vector| {
        (Vector::from_fn(3000, |i, _| x[i % 3] - 1.0), Matrix::from_fn(3000, 3, |i, j| f64::from(u8::from(i % 3 == j))))
    };
    let theta = CompositeFunction::new(3, EuclideanNorm, many);
    let report = BundleTrust::new(BundleTrustConfig::default()).unwrap().minimize(&theta, Vector::zeros(3)).unwrap();
    assert!(report.termination.is_confirmed() && report.counts.evaluations <= 5, "{report}");
    let roots = fit(&SumOfPowers { exponent: 0.5 }, (40, 0.0), &Polyhedron::unbounded(VARIABLES));
    assert!(matches!(roots.termination, nonsmooth::Termination::SubproblemFailed { .. }), "{roots}");
}
