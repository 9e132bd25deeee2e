//! The certificate is recomputed from its own data.
use crate::common::{Inaccurate, cb3, distance_1, minimize, plane, v};
use nonsmooth::verify::seeded_direction;
use nonsmooth::{BundleTrust, BundleTrustConfig, Certificate, Convexity, Polyhedron, Vector};
use testset::Family;

/// Norm and error follow from the multipliers, the predicted decrease from the step: −v = ‖z̃‖²/u + ẽ at the solution
/// of a subproblem.
fn assert_agrees(certificate: &Certificate, set: &Polyhedron) {
    let check = certificate.recheck(set).unwrap();
    assert_eq!(
        (check.aggregate_norm, check.aggregate_error),
        (certificate.aggregate_norm, certificate.aggregate_error)
    );
    // The multipliers carry the subproblem's KKT residual (1e-10 relative) times slopes of order one.
    let predicted = check.aggregate_norm.powi(2) / certificate.weight + check.aggregate_error;
    assert!((predicted - certificate.predicted_decrease).abs() < 1e-8, "{check:?} {certificate}");
    assert!(check.multiplier_defect <= 1e-9 && check.violation <= 1e-9 && check.open_side_multiplier == 0.0);
}

#[test]
fn unconstrained_certificate_proves_the_value() {
    let report = minimize(&cb3(), None, &[2.0, 2.0]);
    let certificate = report.certificate.unwrap();
    assert_agrees(&certificate, &Polyhedron::unbounded(2));
    assert!(certificate.recheck(&Polyhedron::unbounded(2)).unwrap().confirms(1e-3, 1e-5), "{certificate}");
    assert!(certificate.active_cuts().count() >= 2);
    assert_eq!(certificate.point, report.solution);
}

#[test]
fn constrained_certificate_uses_the_multipliers_of_rows_and_bounds() {
    let set = plane(&[1.0, 2.0, 3.0], 2.0, 0.5);
    let report = minimize(&distance_1(v(&[-2.0, 0.0, 0.0])), Some(set.clone()), &[0.0, 0.0, 0.0]);
    let certificate = report.certificate.unwrap();
    assert_agrees(&certificate, &set);
    assert!(certificate.row_multipliers[0].abs() > 1e-3);
    let check = certificate.recheck(&set).unwrap();
    assert!(check.confirms(1e-3, 1e-5), "{check:?} {:?} {}", report.termination, report.value);
}

/// Θ(y) ≥ Θ(x̂) − ‖z̃‖‖y − x̂‖ − ẽ, with the exact Θ on both sides, for functions whose values are inaccurate.
#[test]
fn a_convex_certificate_bounds_the_exact_function() {
    let (mut certificates, mut predicted) = (0, 0);
    for problem in testset::all().iter().filter(|p| p.convex && p.family == Family::Unconstrained && p.dimension <= 20)
    {
        for error in [1e-6, 1e-3, 1e-1] {
            let inaccurate = Inaccurate { problem, shift: 0.0, error, promised: error };
            let config = BundleTrustConfig { convexity: Convexity::Convex, max_evaluations: 300, ..Default::default() };
            let report = BundleTrust::new(config).unwrap().minimize(&inaccurate, v(&problem.start)).unwrap();
            let certificate = report.certificate.unwrap();
            let check = certificate.recheck(&Polyhedron::unbounded(problem.dimension)).unwrap();
            let from_step = check.aggregate_norm.powi(2) / certificate.weight + check.aggregate_error;
            predicted += usize::from((from_step - certificate.predicted_decrease).abs() <= 1e-6 * from_step);
            let at = |x: &Vector| problem.evaluate(x.as_slice()).0;
            for trial in 0..200 {
                let length = 0.3_f64.powi(trial % 8);
                let way = seeded_direction(problem.dimension, trial as u64) * length;
                let bound = certificate.aggregate_norm * way.norm() + certificate.aggregate_error;
                let (here, there) = (at(&certificate.point), at(&(&certificate.point + way)));
                assert!(there >= here - bound - 1e-12 * here.abs(), "{} {error:.0e}: {bound:.1e}", problem.name);
            }
            certificates += 1;
        }
    }
    assert!(certificates >= 30 && 2 * predicted > certificates, "{predicted} of {certificates}");
}

#[test]
fn a_forged_certificate_does_not_agree() {
    let report = minimize(&cb3(), None, &[2.0, 2.0]);
    let mut certificate = report.certificate.unwrap();
    let active = certificate.cuts.iter_mut().find(|cut| cut.multiplier > 1e-3).unwrap();
    active.multiplier += 0.5;
    let check = certificate.recheck(&Polyhedron::unbounded(2)).unwrap();
    assert!(!check.confirms(1e-3, 1e-5));
    assert!(certificate.recheck(&Polyhedron::unbounded(3)).is_err());
}

#[test]
fn a_report_survives_json() {
    let report = minimize(&cb3(), None, &[2.0, 2.0]);
    let text = serde_json::to_string(&report).unwrap();
    let back: nonsmooth::Report = serde_json::from_str(&text).unwrap();
    assert_eq!(back, report);
}
