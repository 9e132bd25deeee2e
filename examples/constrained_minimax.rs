//! Minimax with constraints: the straight line a + b t that meets √t at t = 1 and is as close to it as possible on [0,
//! 1].
//!
//! ```text
//! min over (a, b) of  max over 0 ≤ t ≤ 1 of |√t − a − b t|    subject to  a + b = 1,  0 ≤ a
//! ```
//! The error is 1 − b at t = 0 and 1/(4b) − 1 + b at √t = 1/(2b); both are equal at b = (2 + √2)/4, with the error (2 −
//! √2)/4.

use nonsmooth::{BundleTrust, BundleTrustConfig, FnObjective, Matrix, Polyhedron, Report, Vector};

/// Points √t = k / POINTS at which the error is watched: fine enough for 1e-6.
const POINTS: usize = 1000;

/// Largest error and one subgradient: that of a point where it is attained.
fn largest_error(x: &Vector) -> (f64, Vector) {
    let errors = (0..=POINTS).map(|k| {
        let root = k as f64 / POINTS as f64;
        let t = root * root;
        (root - x[0] - x[1] * t, t)
    });
    let (error, t) = errors.fold((0.0_f64, 0.0), |worst, one| if one.0.abs() > worst.0.abs() { one } else { worst });
    (error.abs(), Vector::from_vec(vec![1.0, t]) * -error.signum())
}

/// Minimises from the line through (0, 1) and (1, 1).
pub fn minimize() -> Result<Report, Box<dyn std::error::Error>> {
    let (lower, upper) = (Vector::from_vec(vec![0.0, f64::NEG_INFINITY]), Vector::from_element(2, f64::INFINITY));
    let (sum, one) = (Matrix::from_element(1, 2, 1.0), Vector::from_element(1, 1.0));
    let set = Polyhedron::boxed(lower, upper)?.with_rows(&sum, &one, &one)?;
    let mut method = BundleTrust::new(BundleTrustConfig::default())?.constraints(set);
    Ok(method.minimize(&FnObjective::new(2, largest_error), Vector::from_vec(vec![1.0, 0.0]))?)
}

#[allow(dead_code, reason = "a test includes this file and calls `minimize`")]
fn main() -> Result<(), Box<dyn std::error::Error>> {
    let report = minimize()?;
    println!("line {:.6} + {:.6} t\n{report}", report.solution[0], report.solution[1]);
    Ok(())
}
