//! Runs the collection of test problems with one setting and prints evaluations beside the best peers.
//!
//! `cargo run --release --example testset -- [--json] [--scale S] [--only NAME] [--jitter K] [--perturb K]`
//!
//! `--perturb K` replaces every count by the median over 2K + 1 runs from x0 (1 + 1e-13 N(0, 1)), the first of them
//! from x0 itself: a single count hangs on the last bit. `--jitter K` adds K runs per problem from starts moved by
//! about a tenth of their size.

use nonsmooth::{BundleTrust, BundleTrustConfig, FnObjective, Matrix, Polyhedron, Report, Vector};
use serde::Serialize;
use std::cell::RefCell;
use testset::{Family, Problem};

/// Evaluations that an unsolved run counts as in the penalised mean.
const UNSOLVED: usize = 1000;

/// Evaluations after which a run ends, and which an unsolved problem counts as in the plain means.
const BUDGET: usize = 2000;

/// Share of the entries by which `--jitter` moves a start.
const JITTER: f64 = 0.1;
/// Standard deviation of the relative change of every entry by `--perturb`.
const PERTURBATION: f64 = 1e-13;

const LEVELS: [f64; 4] = [1e-2, 1e-4, 1e-6, 1e-8];

/// What one problem needed.
#[derive(Serialize)]
struct ProblemRow {
    name: String,
    dimension: usize,
    constrained: bool,
    convex: bool,
    /// Evaluations to each of the levels.
    evaluations: [Option<usize>; 4],
    mpbngc: Option<usize>,
    best_peer: Option<usize>,
    best_peer_name: String,
    all_peers_solve: bool,
    infeasible: usize,
    total: usize,
    final_gap: f64,
    termination: String,
    stationary: bool,
    aborted: bool,
}

#[derive(Serialize)]
struct Summary {
    scale: f64,
    solved_unconstrained: (usize, usize),
    solved_constrained: (usize, usize),
    geometric_mean_to_mpbngc: f64,
    compared: usize,
    /// Geometric mean of the ratio to MPBNGC over all runs; an unsolved run and a missing MPBNGC count as 1000
    /// evaluations.
    penalised_mean: f64,
    /// Geometric means of the evaluations to 1e-6 over all, the convex and the other problems; an unsolved one counts
    /// as 2000.
    means: [f64; 3],
    /// Sum over the unconstrained problems that all nine peers solve.
    common_sum: usize,
    common_mpbngc: usize,
    common_unsolved: usize,
    infeasible: usize,
    aborted: usize,
    false_stops: usize,
}

fn main() {
    let args: Vec<String> = std::env::args().skip(1).collect();
    let value = |flag: &str| args.iter().position(|arg| arg == flag).and_then(|i| args.get(i + 1)).cloned();
    let scale: f64 = value("--scale").and_then(|text| text.parse().ok()).unwrap_or(1.0);
    let only = value("--only");
    let problems = testset::all().into_iter().filter(|problem| only.as_ref().is_none_or(|name| *name == problem.name));
    let config = BundleTrustConfig::default();
    let jitter: u64 = value("--jitter").and_then(|text| text.parse().ok()).unwrap_or(0);
    let perturb: u64 = value("--perturb").and_then(|text| text.parse().ok()).unwrap_or(0);
    let rows: Vec<ProblemRow> = problems
        .flat_map(|problem| (0..=jitter).map(move |seed| jittered(&problem, seed)))
        .map(|problem| median_run(&problem, perturb, scale, &config))
        .collect();
    let summary = summarize(&rows, scale);
    if args.iter().any(|arg| arg == "--json") {
        let text = serde_json::to_string_pretty(&serde_json::json!({ "summary": summary, "problems": rows }));
        println!("{}", text.expect("plain numbers serialize"));
    } else {
        rows.iter().for_each(print_row);
        print_summary(&summary);
    }
}

/// The row of the problem with the medians of its counts over 2·`perturb` + 1 runs from starts that differ by rounding.
fn median_run(problem: &Problem, perturb: u64, scale: f64, config: &BundleTrustConfig) -> ProblemRow {
    let mut row = run(problem, scale, config);
    let others: Vec<ProblemRow> = (1..=2 * perturb).map(|seed| run(&perturbed(problem, seed), scale, config)).collect();
    let levels = row.evaluations;
    let with = |first, of: fn(&ProblemRow, usize) -> Option<usize>, level| {
        median(std::iter::once(first).chain(others.iter().map(|row| of(row, level))).collect())
    };
    row.evaluations = std::array::from_fn(|level| with(levels[level], |row, level| row.evaluations[level], level));
    row.total = with(Some(row.total), |row, _| Some(row.total), 0).unwrap_or(row.total);
    row
}

/// The median count; a level that is not reached counts as beyond all others.
fn median(mut counts: Vec<Option<usize>>) -> Option<usize> {
    counts.sort_by_key(|count| count.unwrap_or(usize::MAX));
    counts[counts.len() / 2]
}

/// Numbers in [0, 1) that follow from a seed.
fn uniform(seed: u64) -> impl FnMut() -> f64 {
    let mut state = seed;
    move || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1_u64 << 53) as f64
    }
}

/// The state of the random numbers of a problem.
fn state(problem: &Problem, seed: u64) -> u64 {
    seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) ^ problem.dimension as u64
}

/// The problem with another start, moved by a share of its size; the original one for seed 0.
fn jittered(problem: &Problem, seed: u64) -> Problem {
    let mut moved = problem.clone();
    let mut next = uniform(state(problem, seed));
    for x in moved.start.iter_mut().filter(|_| seed > 0) {
        *x += JITTER * (2.0 * next() - 1.0) * x.abs().max(1.0);
    }
    moved
}

/// The problem with every entry of its start multiplied by 1 + 1e-13 N(0, 1).
fn perturbed(problem: &Problem, seed: u64) -> Problem {
    let mut moved = problem.clone();
    let mut next = uniform(state(problem, seed));
    for x in &mut moved.start {
        let length = (-2.0 * (1.0 - next()).ln()).sqrt();
        *x *= 1.0 + PERTURBATION * length * (std::f64::consts::TAU * next()).cos();
    }
    moved
}

/// Minimises f(x/scale) from scale·x0 and reads the counts off the sequence of evaluations.
fn run(problem: &Problem, scale: f64, settings: &BundleTrustConfig) -> ProblemRow {
    let log: RefCell<Vec<(f64, bool)>> = RefCell::new(vec![]);
    let theta = FnObjective::new(problem.dimension, |x: &Vector| {
        let original = x / scale;
        let (value, gradient) = problem.evaluate(original.as_slice());
        let feasible = problem.violation(original.as_slice()) <= 1e-8;
        log.borrow_mut().push((value, feasible));
        (value, Vector::from_vec(gradient) / scale)
    });
    let config = BundleTrustConfig { max_evaluations: BUDGET, ..settings.clone() };
    let report = BundleTrust::new(config)
        .expect("the settings are valid")
        .constraints(constraints(problem, scale))
        .minimize(&theta, Vector::from_vec(problem.start.clone()) * scale);
    row(problem, &log.borrow(), report.ok())
}

fn constraints(problem: &Problem, scale: f64) -> Polyhedron {
    let vector = |values: &[f64]| Vector::from_column_slice(values) * scale;
    let rows = Matrix::from_fn(problem.rows.len(), problem.dimension, |i, j| problem.rows[i][j]);
    Polyhedron::boxed(vector(&problem.lower), vector(&problem.upper))
        .and_then(|set| set.with_rows(&rows, &vector(&problem.row_lower), &vector(&problem.row_upper)))
        .expect("the table is valid")
}

fn row(problem: &Problem, log: &[(f64, bool)], report: Option<Report>) -> ProblemRow {
    let size = 1.0 + problem.optimal_value.abs();
    let lowest = log.iter().filter(|entry| entry.1).map(|entry| entry.0).fold(f64::INFINITY, f64::min);
    let diverged = lowest < problem.optimal_value - 1e-6 * size;
    let hit = |level: f64| {
        let reached = |entry: &(f64, bool)| entry.1 && entry.0 - problem.optimal_value <= level * size;
        log.iter().position(reached).map(|index| index + 1).filter(|_| !diverged)
    };
    let solved = problem.peers.iter().filter_map(|(name, count)| count.map(|count| (count, name.clone())));
    let best = solved.min();
    ProblemRow {
        name: problem.name.clone(),
        dimension: problem.dimension,
        constrained: problem.family == Family::LinearlyConstrained,
        convex: problem.convex,
        evaluations: LEVELS.map(hit),
        mpbngc: problem.peers.get("mpbngc").copied().flatten(),
        best_peer: best.as_ref().map(|best| best.0),
        best_peer_name: best.map(|best| best.1).unwrap_or_default(),
        all_peers_solve: problem.peers.values().all(Option::is_some),
        infeasible: log.iter().filter(|entry| !entry.1).count(),
        total: log.len(),
        final_gap: (lowest - problem.optimal_value) / size,
        stationary: report.as_ref().is_some_and(|report| report.termination.is_stationary()),
        aborted: report.is_none(),
        termination: report.map_or_else(|| "error".to_owned(), |report| report.termination.to_string()),
    }
}

fn summarize(rows: &[ProblemRow], scale: f64) -> Summary {
    let count = |constrained: bool| {
        let family = || rows.iter().filter(move |row| row.constrained == constrained);
        (family().filter(|row| row.evaluations[2].is_some()).count(), family().count())
    };
    let pairs: Vec<f64> =
        rows.iter().filter_map(|row| Some((row.evaluations[2]? as f64 / row.mpbngc? as f64).ln())).collect();
    let penalised = rows.iter().map(|row| {
        let peer = row.mpbngc.or(row.best_peer).unwrap_or(UNSOLVED);
        (row.evaluations[2].unwrap_or(UNSOLVED) as f64 / peer as f64).ln()
    });
    let mean = |rows: &mut dyn Iterator<Item = &ProblemRow>| {
        let logs: Vec<f64> = rows.map(|row| (row.evaluations[2].unwrap_or(BUDGET) as f64).ln()).collect();
        (logs.iter().sum::<f64>() / logs.len().max(1) as f64).exp()
    };
    let common = || rows.iter().filter(|row| row.all_peers_solve && !row.constrained);
    Summary {
        scale,
        solved_unconstrained: count(false),
        solved_constrained: count(true),
        geometric_mean_to_mpbngc: (pairs.iter().sum::<f64>() / pairs.len().max(1) as f64).exp(),
        compared: pairs.len(),
        penalised_mean: (penalised.sum::<f64>() / rows.len().max(1) as f64).exp(),
        means: [
            mean(&mut rows.iter()),
            mean(&mut rows.iter().filter(|row| row.convex)),
            mean(&mut rows.iter().filter(|row| !row.convex)),
        ],
        common_mpbngc: common().filter_map(|row| row.mpbngc).sum(),
        common_sum: common().filter_map(|row| row.evaluations[2]).sum(),
        common_unsolved: common().filter(|row| row.evaluations[2].is_none()).count(),
        infeasible: rows.iter().map(|row| row.infeasible).sum(),
        aborted: rows.iter().filter(|row| row.aborted).count(),
        false_stops: rows.iter().filter(|row| row.stationary && row.evaluations[2].is_none()).count(),
    }
}

fn print_row(row: &ProblemRow) {
    let text = |count: Option<usize>| count.map_or_else(|| "-".to_owned(), |count| count.to_string());
    println!(
        "{:<18} {:>3} | {:>5} {:>5} {:>5} {:>5} | mpbngc {:>5} best {:>5} {:<9} | total {:>5} gap {:>9.1e} {}{}",
        row.name,
        row.dimension,
        text(row.evaluations[0]),
        text(row.evaluations[1]),
        text(row.evaluations[2]),
        text(row.evaluations[3]),
        text(row.mpbngc),
        text(row.best_peer),
        row.best_peer_name,
        row.total,
        row.final_gap,
        if row.infeasible > 0 { "INFEASIBLE " } else { "" },
        row.termination
    );
}

fn print_summary(summary: &Summary) {
    println!(
        "solved {}/{} unconstrained, {}/{} constrained; geometric mean to MPBNGC {:.3} over {} (penalised {:.3}); \
         mean evaluations {:.2}, convex {:.2}, others {:.2}; common sum {} (MPBNGC {}, {} unsolved); \
         infeasible evaluations {}; aborted {}; stationary but not solved {}",
        summary.solved_unconstrained.0,
        summary.solved_unconstrained.1,
        summary.solved_constrained.0,
        summary.solved_constrained.1,
        summary.geometric_mean_to_mpbngc,
        summary.compared,
        summary.penalised_mean,
        summary.means[0],
        summary.means[1],
        summary.means[2],
        summary.common_sum,
        summary.common_mpbngc,
        summary.common_unsolved,
        summary.infeasible,
        summary.aborted,
        summary.false_stops
    );
}
