//! A run that ends where the objective is constant says so; one at a minimum does not.

use nonsmooth::{BundleTrust, BundleTrustConfig, FnObjective, Vector};

/// Whether a run from a start is said to end on a plateau.
fn on_plateau(start: f64, theta: fn(f64) -> (f64, f64)) -> bool {
    let objective = FnObjective::new(2, move |x: &Vector| {
        let [first, second] = [theta(x[0]), theta(x[1])];
        (first.0 + second.0, Vector::from_vec(vec![first.1, second.1]))
    });
    let mut method = BundleTrust::new(BundleTrustConfig::default()).unwrap();
    let report = method.minimize(&objective, Vector::from_element(2, start)).unwrap();
    assert!(report.termination.is_confirmed(), "{}", report.termination);
    report.warnings.iter().any(|warning| warning.starts_with("plateau: "))
}

#[test]
fn a_constant_around_the_end_is_told() {
    assert!(on_plateau(3.0, |_| (5.0, 0.0)));
    let hinge = |x: f64| ((x - 10.0).max(0.0), f64::from(u8::from(x > 10.0)));
    assert!(on_plateau(0.0, hinge));
}

#[test]
fn a_minimum_is_no_plateau() {
    assert!(!on_plateau(0.0, |x| (x * x, 2.0 * x)));
    assert!(!on_plateau(0.0, |x| (1.0 + x * x, 2.0 * x)));
    assert!(!on_plateau(2.5, |x| (x.abs(), if x == 0.0 { 0.0 } else { x.signum() })));
}
