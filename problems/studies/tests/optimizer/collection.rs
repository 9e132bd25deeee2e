//! The published problems in variants that must not change what the optimizer says, compared with their minima.
//!
//! ```text
//! Θ(x) = a·(f(x) + η (1 + |f*|) noise) + s,   start σ x₀,   one variable with a wide side, one call in ten failing
//! ```
//! An end is false if it is *confirmed* above the gap, unless it is a known local minimum, or the function is convex
//! and the bound stated for a finite box holds; if it is *confirmed* where the oracle is noisy and says so; if it is a
//! *noise limit* of a convex function above ten times the noise; or if it is a failure of the oracle or of the
//! subproblem above the gap although the oracle answers at the best point.

use super::Run;
use nonsmooth::{
    Answer, BundleTrust, BundleTrustConfig, Convexity, Evaluation, Matrix, NonsmoothObjective, OracleError, Polyhedron,
    Report, Request, Termination, Vector,
};
use rayon::prelude::*;
use std::cell::Cell;
use testset::Problem;
use testset::kit::jitter;

const MAX_EVALUATIONS: usize = 1000;
/// Largest gap relative to 1 + |f*| of a confirmed end, and of a minimum that is reached.
const GAP: (f64, f64) = (1e-5, 1e-6);
/// Times the noise that the gap of a convex function may be at a noise limit.
const NOISE_GAP: f64 = 10.0;
/// Bounds of the box with one wide side: of all entries, in largest entries of the start (at least 1); of the first.
const SIDES: (f64, f64) = (100.0, 1e8);
/// Every how many calls one fails.
const FAILING: usize = 10;
/// Factors of the start.
const STARTS: [f64; 7] = [1.0, 1e-12, 1e-8, 1e-4, 1e-2, 1e3, 1e6];

/// Local minima of the problems that are not convex: true gradients around them balance each other and the active
/// constraints (relative residual 1e-3, within a relative distance of 1e-5). Another one needs the same proof.
const LOCAL_MINIMA: [(&str, f64); 7] = [
    ("ElAttar", 8.021_003_60),
    ("KowalikOsborne", 1.450_883_17e-2),
    ("OET6", 8.703_185_55e-2),
    ("PBC1", 0.390_062_949),
    ("PBC3", 5.916_276_56e-2),
    ("PBC3", 6.670_214_27e-2),
    ("WF", 6.05),
];

/// A change of start, function, bounds or noise.
#[derive(Debug, Clone, Copy)]
struct Variant {
    /// The row of the table.
    change: &'static str,
    /// σ, s and a.
    start: f64,
    shift: f64,
    factor: f64,
    wide: bool,
    failing: bool,
    /// η, relative to 1 + |f*|; the oracle states it.
    noise: f64,
}

/// All variants: starts and shifts combined with each other, other changes with three starts and two shifts each, noise
/// with all starts.
fn variants() -> Vec<Variant> {
    let plain = Variant { change: "", start: 1.0, shift: 0.0, factor: 1.0, wide: false, failing: false, noise: 0.0 };
    let of = |starts: &[f64], change: Variant| starts.iter().map(|&start| Variant { start, ..change }).collect();
    let mut all: Vec<Vec<Variant>> = vec![
        of(&STARTS[..1], Variant { change: "as they are", ..plain }),
        of(&STARTS[1..], Variant { change: "starts × 1e-12 … 1e6", ..plain }),
    ];
    for shift in [1e8, -1e8] {
        all.push(of(&STARTS, Variant { change: "shifts ±1e8", shift, ..plain }));
    }
    for shift in [0.0, 1e8] {
        let plain = Variant { shift, ..plain };
        for factor in [1e6, 1e-6] {
            all.push(of(&[1.0, 1e-8, 1e3], Variant { change: "functions × 1e±6", factor, ..plain }));
        }
        all.push(of(&[1.0, 1e-8, 1e3], Variant { change: "one wide side", wide: true, ..plain }));
        all.push(of(&[1.0, 1e-8, 1e3], Variant { change: "every tenth call fails", failing: true, ..plain }));
    }
    for noise in [1e-8, 1e-4] {
        all.push(of(&STARTS, Variant { change: "noise 1e-8 and 1e-4, stated", noise, ..plain }));
    }
    all.concat()
}

/// A problem with its changes, as an objective.
struct Changed<'p> {
    problem: &'p Problem,
    variant: Variant,
    calls: Cell<usize>,
}

impl Changed<'_> {
    /// The admissible set, with the wide side.
    fn set(&self) -> Polyhedron {
        let problem = self.problem;
        let mut lower = Vector::from_column_slice(&problem.lower);
        let mut upper = Vector::from_column_slice(&problem.upper);
        if self.variant.wide {
            let side = SIDES.0 * problem.start.iter().fold(1.0_f64, |size, x| size.max(x.abs()));
            lower = lower.map(|bound| bound.max(-side));
            upper = upper.map(|bound| bound.min(side));
            upper[0] = SIDES.1;
        }
        let rows = Matrix::from_fn(problem.rows.len(), problem.dimension, |i, j| problem.rows[i][j]);
        let side = |values: &[f64]| Vector::from_column_slice(values);
        let set = Polyhedron::boxed(lower, upper).unwrap();
        set.with_rows(&rows, &side(&problem.row_lower), &side(&problem.row_upper)).unwrap()
    }

    /// η (1 + |f*|), in units of f.
    fn noise(&self) -> f64 {
        self.variant.noise * (1.0 + self.problem.optimal_value.abs())
    }

    fn run(&self, name: String) -> Run {
        let (problem, variant) = (self.problem, self.variant);
        let kind = if problem.convex { "convex" } else { "not convex" };
        let mut run = Run {
            name,
            rows: [variant.change.to_owned(), format!("{kind}, {}", variant.change)],
            excess: f64::NAN,
            ..Run::default()
        };
        let convexity = if problem.convex { Convexity::Convex } else { Convexity::Unknown };
        let config = BundleTrustConfig { max_evaluations: MAX_EVALUATIONS, convexity, ..BundleTrustConfig::default() };
        let start = Vector::from_column_slice(&problem.start) * variant.start;
        match BundleTrust::new(config).unwrap().constraints(self.set()).minimize(self, start) {
            Ok(report) => self.check(&mut run, &report),
            // The start has no value.
            Err(error) => run.termination = error.to_string(),
        }
        run
    }

    fn check(&self, run: &mut Run, report: &Report) {
        let (problem, variant) = (self.problem, self.variant);
        let Variant { shift, factor, noise, wide, .. } = variant;
        let (size, noisy) = (1.0 + problem.optimal_value.abs(), noise > 0.0);
        let rounding = 4.0 * f64::EPSILON * shift.abs() / factor / size;
        // Noise is no gain: the gap is that of the function itself.
        let value =
            if noisy { problem.evaluate(report.solution.as_slice()).0 } else { (report.value - shift) / factor };
        run.excess = (value - problem.optimal_value) / size;
        run.reached = run.excess <= GAP.1 + rounding;
        run.confirmed = report.termination.is_confirmed();
        run.evaluations = report.counts.evaluations;
        run.termination = report.termination.to_string();
        let above = run.excess > GAP.0 + rounding;
        let is_there = |(name, minimum): &(&str, f64)| {
            *name == problem.name && (value - minimum).abs() <= GAP.0 * (1.0 + minimum) + rounding * size
        };
        let answers = || (0..2).any(|_| self.evaluate(&Request::tight(&report.solution)).is_ok());
        run.wrong = match report.termination {
            Termination::Stationary { .. } if noisy => Some("confirmed in noise"),
            Termination::Stationary { gap, .. } if above => {
                // In a finite box the bound is a proof; it is relative to the values as they are, shift included.
                let holds = |gap: f64| factor * size * run.excess <= gap && gap <= GAP.0 * report.value.abs();
                let bounded = wide && gap.is_some_and(holds) || LOCAL_MINIMA.iter().any(is_there);
                (!bounded).then_some("confirmed above the minimum")
            }
            Termination::NoiseLimit { .. } if noisy && problem.convex && run.excess > NOISE_GAP * noise => {
                Some("more than noise above the minimum")
            }
            Termination::OracleFailing { .. }
            | Termination::OracleContradiction { .. }
            | Termination::SubproblemFailed { .. }
                if above && answers() =>
            {
                Some("failed where the oracle answers")
            }
            _ => None,
        };
    }
}

impl NonsmoothObjective for Changed<'_> {
    type WarmStart = ();

    fn dimension(&self) -> usize {
        self.problem.dimension
    }

    fn evaluate(&self, request: &Request<'_, ()>) -> Result<Answer<()>, OracleError> {
        let Variant { factor, shift, failing, .. } = self.variant;
        let call = self.calls.get() + 1;
        self.calls.set(call);
        if failing && call.is_multiple_of(FAILING) {
            return Err(OracleError::NotConverged { solver: "one call in ten", residual: 1.0, iterations: call });
        }
        let x = request.point.as_slice();
        let (value, subgradient) = self.problem.evaluate(x);
        let value = factor * (value + self.noise() * jitter(x, 0)) + shift;
        let evaluation = Evaluation::exact(value, Vector::from_vec(subgradient) * factor, ());
        Ok(Answer::Accurate(Evaluation { error_bound: factor * self.noise(), ..evaluation }))
    }
}

/// Runs the variants that `wanted` selects by their names, on all processors; they keep their order. Runs whose start
/// has no value are left out.
pub fn collection(mut wanted: impl FnMut(&str) -> bool) -> Vec<Run> {
    let (problems, variants) = (testset::all(), variants());
    let all = problems.iter().flat_map(|problem| variants.iter().enumerate().map(move |of| (problem, of)));
    let named = all.map(|(problem, (number, variant))| (format!("{}, #{number}", problem.name), problem, *variant));
    let chosen: Vec<(String, &Problem, Variant)> = named.filter(|(name, ..)| wanted(name)).collect();
    let run = |(name, problem, variant)| Changed { problem, variant, calls: Cell::new(0) }.run(name);
    let runs: Vec<Run> = chosen.into_par_iter().map(run).collect();
    runs.into_iter().filter(|run| run.evaluations > 0).collect()
}
