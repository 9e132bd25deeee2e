//! A closure as objective: the geometric median of three points (the Fermat point of a triangle).
//!
//! Θ(x) = Σ |x − pᵢ| is smooth except at the points themselves. For the triangle (0,0), (1,0), (½, √3/2) the Fermat
//! point is the centre (½, √3/6), Θ = √3.

use nonsmooth::{BundleTrust, BundleTrustConfig, FnObjective, Report, Vector};

/// Sum of the distances, and one subgradient: at a point pᵢ its own distance contributes 0, which lies in the unit
/// ball.
fn distances(x: &Vector) -> (f64, Vector) {
    let corners = [[0.0, 0.0], [1.0, 0.0], [0.5, 0.75_f64.sqrt()]];
    corners.iter().fold((0.0, Vector::zeros(2)), |(sum, subgradient), corner| {
        let away = x - Vector::from_column_slice(corner);
        let length = away.norm();
        let direction = if length > 0.0 { away / length } else { Vector::zeros(2) };
        (sum + length, subgradient + direction)
    })
}

/// Minimises from a corner of the triangle, where Θ has a kink.
pub fn minimize() -> Result<Report, Box<dyn std::error::Error>> {
    let mut method = BundleTrust::new(BundleTrustConfig::default())?;
    Ok(method.minimize(&FnObjective::new(2, distances), Vector::zeros(2))?)
}

#[allow(dead_code, reason = "a test includes this file and calls `minimize`")]
fn main() -> Result<(), Box<dyn std::error::Error>> {
    let report = minimize()?;
    println!("Fermat point ({:.6}, {:.6})\n{report}", report.solution[0], report.solution[1]);
    Ok(())
}
