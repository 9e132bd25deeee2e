//! Checkpoint and resume: an interrupted run ends where the uninterrupted one ends, bit by bit.
//!
//! Θ(x) = max(x₁² + (x₂ − 1)² + x₂ − 1, −x₁² − (x₂ − 1)² + x₂ + 1), Kiwiel's crescent: nonconvex, minimum 0 at the origin.

use nonsmooth::{BundleTrust, BundleTrustConfig, FnObjective, Report, Snapshot, StopRule, Vector};
use std::path::Path;

fn crescent(x: &Vector) -> (f64, Vector) {
    let circle = x[0].powi(2) + (x[1] - 1.0).powi(2);
    let (outer, inner) = (circle + x[1] - 1.0, -circle + x[1] + 1.0);
    let sign = if outer >= inner { 1.0 } else { -1.0 };
    (outer.max(inner), Vector::from_vec(vec![2.0 * sign * x[0], 2.0 * sign * (x[1] - 1.0) + 1.0]))
}

/// The report of a run that was never interrupted, and of one that was stopped and resumed from its file.
pub fn both_ways(file: &Path) -> Result<[Report; 2], Box<dyn std::error::Error>> {
    let theta = FnObjective::new(2, crescent);
    let start = Vector::from_vec(vec![-1.5, 2.0]);
    let method = || BundleTrust::new(BundleTrustConfig::default());
    let whole = method()?.minimize(&theta, start.clone())?;
    // The file holds the state after the last serious step; nothing but it survives.
    let stopped = method()?.checkpoint(file).stop_when(StopRule::Evaluations(10)).minimize(&theta, start)?;
    println!("stopped: {}", stopped.termination);
    let resumed = method()?.continue_from(&theta, Snapshot::read(file)?)?;
    Ok([whole, resumed])
}

#[allow(dead_code, reason = "a test includes this file and calls `both_ways`")]
fn main() -> Result<(), Box<dyn std::error::Error>> {
    let file = std::env::temp_dir().join(format!("nonsmooth-example-{}.json", std::process::id()));
    let [whole, resumed] = both_ways(&file)?;
    std::fs::remove_file(&file)?;
    println!("resumed: {resumed}");
    println!("equal to the uninterrupted run: {}", whole.solution == resumed.solution);
    Ok(())
}
