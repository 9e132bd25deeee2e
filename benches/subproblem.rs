//! Time of the QP on the sequences a bundle method makes, against the interior-point solver from scratch.
//!
//! A proximal bundle loop on a synthetic maximum of convex quadratics is run once and its QPs are recorded: one new cut
//! per solve, the center moves now and then, the weight changes by factors. Then both solvers go through the record.

#[path = "../tests/qp/qps.rs"]
#[allow(dead_code)]
mod qps;
#[path = "../tests/qp/reference.rs"]
mod reference;

use std::time::{Duration, Instant};

use nonsmooth::Vector;
use nonsmooth::qp::EpigraphQpSolver;
use qps::{BundleSequence, OwnedQp};
use reference::Reference;

/// Best of several runs.
fn best_time(mut run: impl FnMut()) -> Duration {
    let timed = |run: &mut dyn FnMut()| {
        let start = Instant::now();
        run();
        start.elapsed()
    };
    (0..3).map(|_| timed(&mut run)).min().unwrap_or_default()
}

fn measure(label: &str, record: &[OwnedQp]) {
    let mut counts = Default::default();
    let mut worst = 0.0_f64;
    let mut steps: Vec<Vector> = Vec::new();
    let warm = best_time(|| {
        let mut solver = EpigraphQpSolver::new();
        steps.clear();
        for qp in record {
            let solution = solver.solve(&qp.view()).expect("the record is feasible");
            worst = worst.max(solution.kkt_residual);
            steps.push(solution.step);
        }
        counts = solver.counts();
    });
    let cold = best_time(|| {
        for qp in record {
            EpigraphQpSolver::new().solve(&qp.view()).expect("the record is feasible");
        }
    });
    let references: Vec<Reference> = record.iter().map(|qp| Reference::new(&qp.view())).collect();
    let coarse = best_time(|| references.iter().for_each(|reference| drop(reference.solve(1e-8))));
    let fine = best_time(|| references.iter().for_each(|reference| drop(reference.solve(1e-12))));
    let per_solve = |time: Duration| time.as_secs_f64() * 1e6 / record.len() as f64;
    println!(
        "{label:32} {:5} {:9.1} {:9.1} {:9.1} {:9.1} {:7.1} {:7.1} {:7.2} {:9.1e} {:4}",
        record.len(),
        per_solve(warm),
        per_solve(cold),
        per_solve(coarse),
        per_solve(fine),
        per_solve(coarse) / per_solve(warm),
        per_solve(fine) / per_solve(warm),
        counts.pivots as f64 / record.len() as f64,
        worst,
        counts.fallbacks
    );
}

fn main() {
    println!("times per solve in µs; interior-point solver at tolerance 1e-8 and 1e-12");
    println!(
        "{:32} {:>5} {:>9} {:>9} {:>9} {:>9} {:>7} {:>7} {:>7} {:>9} {:>4}",
        "sequence", "QPs", "warm", "cold", "ip 1e-8", "ip 1e-12", "ratio", "ratio", "pivots", "kkt", "fb"
    );
    let sequence = |dimension, pieces, cuts, rows, solves| BundleSequence { dimension, pieces, cuts, rows, solves };
    for (label, shape) in [
        ("36 var, 80 cuts, 150 rows + box", sequence(36, 60, 80, 150, 300)),
        ("36 var, 80 cuts, box", sequence(36, 60, 80, 0, 300)),
        ("10 var, 25 cuts, 20 rows + box", sequence(10, 15, 25, 20, 300)),
        ("3 var, 80 cuts, 5 rows + box", sequence(3, 200, 80, 5, 300)),
        ("200 var, 100 cuts, 200 rows + box", sequence(200, 100, 100, 200, 60)),
        ("1000 var, 100 cuts, 100 rows + box", sequence(1000, 60, 100, 100, 30)),
    ] {
        measure(label, &shape.record(7));
    }
}
