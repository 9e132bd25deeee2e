//! Evaluations per problem of the collection, pinned: a change of the engine that changes one fails here.
//!
//! The counts must be equal on processors with AVX-512, as the one that wrote the table has. The dense kernels choose their
//! instructions by the processor, and on another one a run may take another course, as they round differently: there each problem
//! may take 15 % and 2 evaluations more than pinned. On all processors, the sum over the unconstrained problems that all peers
//! solve and the geometric mean to MPBNGC may be 5 % above the numbers below.
use nonsmooth::{BundleTrust, BundleTrustConfig, FnObjective, Matrix, Polyhedron, Vector};
use std::cell::Cell;
use testset::kit::rounds_alike;
use testset::{Family, Problem};

/// Evaluations to f − f* ≤ 1e-6 (1 + |f*|). Not pinned: ChebRosenN1_5, which is not solved, and ShellDual, where the last bit
/// decides whether 2000 are enough.
const MEASURED: [(&str, usize); 42] = [
    ("Rosenbrock", 69),
    ("CB2", 10),
    ("CB3", 12),
    ("DEM", 7),
    ("QL", 13),
    ("Mifflin1", 14),
    ("Mifflin2", 12),
    ("RosenSuzuki", 26),
    ("Shor", 26),
    ("Colville1", 32),
    ("ElAttar", 83),
    ("Maxquad", 38),
    ("Steiner2", 87),
    ("MAXL", 38),
    ("Goffin", 52),
    ("L1HILB", 15),
    ("WF", 24),
    ("EVD52", 28),
    ("PBC3", 41),
    ("KowalikOsborne", 90),
    ("Davidon2", 32),
    ("OET6", 243),
    ("PBC1", 46),
    ("Wong1", 46),
    ("Wong3", 167),
    ("Polak3", 43),
    ("Watson20", 264),
    ("MAD1", 8),
    ("MAD4", 13),
    ("PENTAGON", 13),
    ("EQUIL", 68),
    ("Wong3lin", 166),
    ("HS114", 58),
    ("Dembo5", 67),
    ("GenMXHILB", 13),
    ("ChainedLQ", 127),
    ("ChainedCB3II", 28),
    ("ActiveFaces", 2),
    ("ChainedCrescentI", 47),
    ("ChainedCrescentII", 392),
    ("ChebRosenN1_2", 16),
    ("NesterovWorst_20", 137),
];
/// Sum over the unconstrained problems that all nine peers solve.
const COMMON_SUM: f64 = 392.0;
/// Geometric mean of the ratio to MPBNGC over the problems both solve.
const MEAN: f64 = 0.672;

fn evaluations(problem: &Problem) -> Option<usize> {
    let (count, hit) = (Cell::new(0), Cell::new(None));
    let level = 1e-6 * (1.0 + problem.optimal_value.abs());
    let theta = FnObjective::new(problem.dimension, |x: &Vector| {
        let (value, gradient) = problem.evaluate(x.as_slice());
        count.set(count.get() + 1);
        assert!(problem.violation(x.as_slice()) <= 1e-8, "{}: infeasible evaluation", problem.name);
        if hit.get().is_none() && value - problem.optimal_value <= level {
            hit.set(Some(count.get()));
        }
        (value, Vector::from_vec(gradient))
    });
    let vector = |values: &[f64]| Vector::from_column_slice(values);
    let rows = Matrix::from_fn(problem.rows.len(), problem.dimension, |i, j| problem.rows[i][j]);
    let set = Polyhedron::boxed(vector(&problem.lower), vector(&problem.upper))
        .and_then(|set| set.with_rows(&rows, &vector(&problem.row_lower), &vector(&problem.row_upper)))
        .unwrap();
    let max_evaluations = if problem.dimension >= 50 { 3000 } else { 2000 };
    let config = BundleTrustConfig { max_evaluations, ..BundleTrustConfig::default() };
    BundleTrust::new(config).unwrap().constraints(set).minimize(&theta, vector(&problem.start)).unwrap();
    hit.get()
}

#[test]
fn evaluation_counts_do_not_grow() {
    let (mut worse, mut common, mut logs) = (vec![], 0, vec![]);
    for (name, measured) in MEASURED {
        let problem = testset::find(name).unwrap();
        let Some(count) = evaluations(&problem) else {
            worse.push(format!("{name}: not solved"));
            continue;
        };
        if rounds_alike() && count != measured {
            worse.push(format!("{name}: {count} evaluations, pinned {measured}"));
        } else if count > (1.15 * measured as f64).ceil() as usize + 2 {
            worse.push(format!("{name}: {count} evaluations, measured {measured}"));
        }
        if problem.family == Family::Unconstrained && problem.peers.values().all(Option::is_some) {
            common += count;
        }
        if let Some(peer) = problem.peers.get("mpbngc").copied().flatten() {
            logs.push((count as f64 / peer as f64).ln());
        }
    }
    let mean = (logs.iter().sum::<f64>() / logs.len() as f64).exp();
    assert!(worse.is_empty(), "{worse:#?}");
    assert!(common as f64 <= 1.05 * COMMON_SUM, "sum {common}");
    assert!(mean <= 1.05 * MEAN, "mean {mean:.3} over {}", logs.len());
}
