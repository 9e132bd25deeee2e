//! A membrane over a dome takes a wanted shape without pressing on the dome, by the bundle-trust engine:
//! `cargo run --release -p problems --example membrane`.
//!
//! `problems/src/membrane` is the state problem: a partial differential equation with an obstacle, its solver and its
//! coderivative behind the traits of the framework.

use nonsmooth::{Accuracy, BundleTrust, BundleTrustConfig, StateSolver, Vector};
use problems::membrane::{PATCHES, admissible_loads, example};
use std::error::Error;

/// Largest gap, relative to the largest height, that counts as none.
const MAX_TOUCHING_GAP: f64 = 1e-6;

fn main() -> Result<(), Box<dyn Error>> {
    let theta = example(48)?;
    let config = BundleTrustConfig { max_evaluations: 400, ..Default::default() };
    let mut method = BundleTrust::new(config)?.constraints(admissible_loads());
    let report = method.minimize(&theta, Vector::zeros(PATCHES * PATCHES))?;
    let state = theta.solver().solve(&report.solution, None, Accuracy::TIGHTEST)?;
    // Nodes on which the dome presses, and others that touch it: those are at the kink.
    let largest = state.displacement.iter().fold(0.0_f64, |largest, u| largest.max(u.abs()));
    let gaps = state.displacement.iter().zip(theta.solver().obstacle()).map(|(u, psi)| u - psi);
    let touches = |(gap, active): &(f64, &bool)| !**active && *gap <= MAX_TOUCHING_GAP * largest;
    let touching = gaps.zip(&state.active).filter(touches).count();
    let pressing = state.active.iter().filter(|active| **active).count();
    println!(
        "of {} nodes {pressing} are pressed by the dome and {touching} just touch it\n{report}",
        state.active.len()
    );
    Ok(())
}
