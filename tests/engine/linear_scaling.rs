//! A linear scaling measures lengths in other coordinates; points, bounds and certificate stay in those of the problem.

use crate::common::v;
use nonsmooth::{BundleTrust, BundleTrustConfig, FnObjective, Matrix, Polyhedron, Report, VariableScaling, Vector};

/// Steep across a curved kink, slowly falling along (1, 1, 1). No step ends on the kink itself, where rounding decides
/// the side.
fn valley(x: &Vector) -> (f64, Vector) {
    let (across, difference, along) = (x[0] - x[1] + 0.05 * x[2] * x[2], x[1] - x[2], x.sum());
    let value = 10.0 * across.abs() + 5.0 * difference * difference + 1e-2 * along;
    let (side, slope) = (10.0 * across.signum(), 10.0 * difference);
    (value, v(&[side + 1e-2, -side + slope + 1e-2, 0.1 * x[2] * side - slope + 1e-2]))
}

/// Stretches the mean thirtyfold.
fn stretch() -> Matrix {
    Matrix::from_fn(3, 3, |i, j| 29.0 / 3.0 + f64::from(u8::from(i == j)))
}

fn admissible() -> Polyhedron {
    let row = Matrix::from_row_slice(1, 3, &[1.0, -2.0, 0.5]);
    Polyhedron::boxed(Vector::from_element(3, -5.0), Vector::from_element(3, 5.0))
        .unwrap()
        .with_rows(&row, &v(&[f64::NEG_INFINITY]), &v(&[4.0]))
        .unwrap()
}

fn start() -> Vector {
    v(&[3.0, 1.0, -2.0])
}

fn scaled() -> Report {
    let scaling = VariableScaling::Linear(stretch());
    let config = BundleTrustConfig { scaling, first_step: Some(1.0), ..BundleTrustConfig::default() };
    let method = BundleTrust::new(config).unwrap();
    method.constraints(admissible()).minimize(&FnObjective::new(3, valley), start()).unwrap()
}

/// The run in the coordinates β of x = M β, where bounds are rows.
fn by_hand() -> Report {
    let (matrix, set) = (stretch(), admissible());
    let theta = FnObjective::new(3, |beta: &Vector| {
        let (value, gradient) = valley(&(stretch() * beta));
        (value, stretch().tr_mul(&gradient))
    });
    let constraints = Polyhedron::unbounded(3)
        .with_rows(&matrix, set.lower(), set.upper())
        .and_then(|rows| rows.with_rows(&(set.rows() * &matrix), set.row_lower(), set.row_upper()))
        .unwrap();
    let config = BundleTrustConfig { first_step: Some(1.0), ..BundleTrustConfig::default() };
    let beta = matrix.try_inverse().unwrap() * start();
    BundleTrust::new(config).unwrap().constraints(constraints).minimize(&theta, beta).unwrap()
}

#[test]
fn the_run_takes_the_course_of_the_coordinates() {
    let (report, expected) = (scaled(), by_hand());
    assert!(report.counts.evaluations > 12, "{report}");
    for (record, other) in report.history.iter().zip(&expected.history).take(12) {
        assert_eq!((record.kind, record.origin), (other.kind, other.origin));
        let pairs = [
            (record.value.unwrap(), other.value.unwrap()),
            (record.predicted_decrease, other.predicted_decrease),
            (record.aggregate_norm, other.aggregate_norm),
            (record.weight, other.weight),
            (record.step_length, other.step_length),
            (record.convexification, other.convexification),
        ];
        for (own, other) in pairs {
            assert!((own - other).abs() <= 1e-8 * own.abs().max(1e-3), "{record:?} {other:?}");
        }
    }
    assert!((report.value - expected.value).abs() < 1e-6, "{report}{expected}");
    let solution = stretch() * &expected.solution;
    assert!((&report.solution - solution).norm() < 1e-4, "{report}");
}

#[test]
fn the_certificate_is_rechecked_with_the_set_of_the_problem() {
    let report = scaled();
    assert!(report.termination.is_stationary(), "{report}");
    let certificate = report.certificate.as_ref().unwrap();
    assert_eq!(certificate.point, report.solution);
    assert!(certificate.bound_multipliers.iter().any(|multiplier| *multiplier < 0.0));
    let check = certificate.recheck(&admissible()).unwrap();
    assert!((check.aggregate_norm - certificate.aggregate_norm).abs() < 1e-8, "{check:?} {certificate}");
    assert!(check.aggregate_error <= certificate.aggregate_error + 1e-8, "{check:?} {certificate}");
    assert!(check.multiplier_defect <= 1e-9 && check.violation <= 1e-9 && check.open_side_multiplier == 0.0);
    let text = serde_json::to_string(&report).unwrap();
    assert_eq!(serde_json::from_str::<Report>(&text).unwrap(), report);
}

#[test]
fn norms_are_those_of_the_coordinates() {
    let norm = scaled().certificate.unwrap().norm;
    let (d, g) = (v(&[1.0, -2.0, 0.5]), v(&[0.3, 4.0, -1.0]));
    let beta = stretch().try_inverse().unwrap() * &d;
    assert!((norm.length(&d) - beta.norm()).abs() < 1e-14);
    assert!((norm.dual_length(&g) - stretch().tr_mul(&g).norm()).abs() < 1e-12);
    assert!((norm.lower_index(&d) - norm.matrix() * &d).norm() < 1e-14);
    assert!((norm.lower_index(&d).dot(&d) - norm.squared(&d)).abs() < 1e-13);
}

#[test]
fn matrices_without_inverse_or_of_another_size_are_refused() {
    let config =
        |matrix| BundleTrustConfig { scaling: VariableScaling::Linear(matrix), ..BundleTrustConfig::default() };
    assert!(config(Matrix::zeros(3, 3)).validate().unwrap_err().to_string().contains("scaling.linear"));
    assert!(config(Matrix::zeros(3, 2)).validate().is_err());
    assert!(config(Matrix::from_element(1, 1, f64::NAN)).validate().is_err());
    let mut method = BundleTrust::new(config(Matrix::identity(2, 2))).unwrap();
    assert!(method.minimize(&FnObjective::new(3, valley), start()).is_err());
}
