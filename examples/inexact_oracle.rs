//! An oracle that iterates, and sweeps no more than the engine needs: a loaded string, held as level as possible.
//!
//! ```text
//! −y″ = 1 − x δ(½) on (0, 1),  y(0) = y(1) = c          Θ(x, c) = max |y|: the force x at the middle and the height c are free
//! ```
//! Optimal: x = ½, c = −1/64, where y = −1/64 at the ends and at the middle and +1/64 at the quarters. The 32
//! differences used here are exact at their nodes. Gauss–Seidel sweeps stop as soon as the error max|residual|/8
//! (maximum principle) is small enough, or as soon as it is certain that there is no descent.

use nonsmooth::{
    AccuracyPolicy, Answer, BundleTrust, BundleTrustConfig, Evaluation, NonsmoothObjective, OracleError, Report,
    Request, Vector,
};
use std::cell::Cell;

const INTERVALS: usize = 32;
const WIDTH: f64 = 1.0 / INTERVALS as f64;
/// What rounding leaves of the residual, absolute as the load is 1.
const ROUNDING: f64 = 1e-11;
/// Sweeps after which the oracle gives up.
const MOST_SWEEPS: usize = 20_000;

/// The string; counts its sweeps.
#[derive(Default)]
pub struct LevelString {
    sweeps: Cell<usize>,
}

impl LevelString {
    /// One Gauss–Seidel sweep; returns the largest residual before its nodes were updated.
    fn sweep(&self, y: &mut Vector, force: f64) -> f64 {
        self.sweeps.set(self.sweeps.get() + 1);
        (1..INTERVALS).fold(0.0_f64, |largest, k| {
            let load = 1.0 - if k == INTERVALS / 2 { force / WIDTH } else { 0.0 };
            let update = 0.5 * (y[k - 1] + y[k + 1] + load * WIDTH * WIDTH) - y[k];
            y[k] += update;
            largest.max(2.0 * update.abs() / (WIDTH * WIDTH))
        })
    }
}

/// Bound of |y − y*| once the largest update of a sweep is known: its residuals are at most twice those met on the way.
fn error_bound(residual: f64) -> f64 {
    2.0 * residual / 8.0
}

impl NonsmoothObjective for LevelString {
    /// The deflection at the nodes.
    type WarmStart = Vector;

    fn dimension(&self) -> usize {
        2
    }

    fn evaluate(&self, request: &Request<'_, Vector>) -> Result<Answer<Vector>, OracleError> {
        let (force, height) = (request.point[0], request.point[1]);
        let mut y = request.warm_start.cloned().unwrap_or_else(|| Vector::zeros(INTERVALS + 1));
        (y[0], y[INTERVALS]) = (height, height);
        let mut residual = f64::INFINITY;
        for _ in 0..MOST_SWEEPS {
            residual = self.sweep(&mut y, force);
            let bound = error_bound(residual);
            let (node, value) = (y.iamax(), y.amax());
            let t = node as f64 * WIDTH;
            // y at a node is affine in (x, c): this cut is exact, wherever the sweeps stop.
            let subgradient = Vector::from_vec(vec![-0.5 * t.min(1.0 - t), 1.0]) * y[node].signum();
            let evaluation =
                |value, error_bound| Evaluation { error_bound, ..Evaluation::exact(value, subgradient, y.clone()) };
            if bound <= request.accuracy.tolerance().max(ROUNDING) * value {
                return Ok(Answer::Accurate(evaluation(value, bound)));
            }
            if request.descent_target.is_some_and(|target| value - bound > target) {
                return Ok(Answer::NoDescent(evaluation(value - bound, bound)));
            }
        }
        Err(OracleError::NotConverged { solver: "Gauss–Seidel", residual, iterations: MOST_SWEEPS })
    }
}

/// Minimises with a policy; returns the report and the sweeps spent.
pub fn minimize(accuracy: AccuracyPolicy) -> Result<(Report, usize), Box<dyn std::error::Error>> {
    let theta = LevelString::default();
    let mut method = BundleTrust::new(BundleTrustConfig { accuracy, ..Default::default() })?;
    let report = method.minimize(&theta, Vector::zeros(2))?;
    Ok((report, theta.sweeps.get()))
}

#[allow(dead_code, reason = "a test includes this file and calls `minimize`")]
fn main() -> Result<(), Box<dyn std::error::Error>> {
    for (name, policy) in [("always tight", AccuracyPolicy::Tightest), ("on demand", AccuracyPolicy::ON_DEMAND)] {
        let (report, sweeps) = minimize(policy)?;
        println!("{name}: {sweeps} sweeps\n{report}");
    }
    Ok(())
}
