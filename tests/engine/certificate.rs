//! The certificate is recomputed from its own data.
use crate::common::{cb3, distance_1, minimize, plane, v};
use nonsmooth::{Certificate, Polyhedron};

fn assert_agrees(certificate: &Certificate, set: &Polyhedron) {
    let check = certificate.recheck(set).unwrap();
    // The multipliers carry the subproblem's KKT residual (1e-10 relative) times slopes of order one.
    assert!((check.aggregate_norm - certificate.aggregate_norm).abs() < 1e-8, "{check:?} {certificate}");
    assert!(check.aggregate_error <= certificate.aggregate_error + 1e-8, "{check:?} {certificate}");
    assert!(check.multiplier_defect <= 1e-9 && check.violation <= 1e-9 && check.open_side_multiplier == 0.0);
}

#[test]
fn unconstrained_certificate_proves_the_value() {
    let report = minimize(&cb3(), None, &[2.0, 2.0]);
    let certificate = report.certificate.unwrap();
    assert_agrees(&certificate, &Polyhedron::unbounded(2));
    assert!(certificate.recheck(&Polyhedron::unbounded(2)).unwrap().proves(1e-3, 1e-5), "{certificate}");
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
    assert!(check.proves(1e-3, 1e-5), "{check:?} {:?} {}", report.termination, report.value);
}

#[test]
fn a_forged_certificate_does_not_agree() {
    let report = minimize(&cb3(), None, &[2.0, 2.0]);
    let mut certificate = report.certificate.unwrap();
    let active = certificate.cuts.iter_mut().find(|cut| cut.multiplier > 1e-3).unwrap();
    active.multiplier += 0.5;
    let check = certificate.recheck(&Polyhedron::unbounded(2)).unwrap();
    assert!(!check.proves(1e-3, 1e-5));
    assert!(certificate.recheck(&Polyhedron::unbounded(3)).is_err());
}

#[test]
fn a_report_survives_json() {
    let report = minimize(&cb3(), None, &[2.0, 2.0]);
    let text = serde_json::to_string(&report).unwrap();
    let back: nonsmooth::Report = serde_json::from_str(&text).unwrap();
    assert_eq!(back, report);
}
