//! A journal: a run that was interrupted ends where the uninterrupted one ends, bit by bit, and nothing is evaluated
//! twice.
//!
//! Θ(x) = max(x₁² + (x₂ − 1)² + x₂ − 1, −x₁² − (x₂ − 1)² + x₂ + 1), Kiwiel's crescent: nonconvex, minimum 0 at the
//! origin.

use nonsmooth::{BundleTrust, BundleTrustConfig, FnObjective, Journaled, Report, StopRule, Vector};
use std::path::Path;

fn crescent(x: &Vector) -> (f64, Vector) {
    let circle = x[0].powi(2) + (x[1] - 1.0).powi(2);
    let (outer, inner) = (circle + x[1] - 1.0, -circle + x[1] + 1.0);
    let sign = if outer >= inner { 1.0 } else { -1.0 };
    (outer.max(inner), Vector::from_vec(vec![2.0 * sign * x[0], 2.0 * sign * (x[1] - 1.0) + 1.0]))
}

/// The report of a run that was never interrupted, and of one that was stopped and continued from its folder.
pub fn both_ways(folder: &Path) -> Result<[Report; 2], Box<dyn std::error::Error>> {
    let start = Vector::from_vec(vec![-1.5, 2.0]);
    let method = || BundleTrust::new(BundleTrustConfig::default());
    let whole = method()?.minimize(&FnObjective::new(2, crescent), start.clone())?;
    // Nothing but the folder survives; a kill at any moment would leave as much.
    let theta = Journaled::open(FnObjective::new(2, crescent), folder, "Kiwiel's crescent")?;
    let stopped = method()?.stop_when(StopRule::Evaluations(10)).minimize(&theta, start.clone())?;
    println!("stopped: {}", stopped.termination);
    // A second run of this program begins at the same start; the journal answers its requests.
    let theta = Journaled::open(FnObjective::new(2, crescent), folder, "Kiwiel's crescent")?;
    println!("evaluations in the journal: {}", theta.held());
    let mut continued = method()?.minimize(&theta, start)?;
    theta.complete(&mut continued);
    Ok([whole, continued])
}

#[allow(dead_code, reason = "a test includes this file and calls `both_ways`")]
fn main() -> Result<(), Box<dyn std::error::Error>> {
    let folder = std::env::temp_dir().join(format!("nonsmooth-example-{}", std::process::id()));
    let [whole, continued] = both_ways(&folder)?;
    std::fs::remove_dir_all(&folder)?;
    println!("continued: {continued}");
    println!("equal to the uninterrupted run: {}", whole.solution == continued.solution);
    Ok(())
}
