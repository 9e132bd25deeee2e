//! Outputs that have kinks themselves: there the composite model must give way to the cuts before it has cost anything.

use nonsmooth::composite::{EuclideanNorm, FnOuter, OuterFunction, SumOfPowers};
use nonsmooth::verify::seeded_direction;
use nonsmooth::{BundleTrust, BundleTrustConfig, CompositeFunction, Matrix, Vector};

type Linearize = Box<dyn Fn(&Vector) -> (Vector, Matrix)>;

/// A problem whose optimum lies on kinks of its outputs.
struct Kinked {
    dimension: usize,
    outer: Box<dyn OuterFunction>,
    linearize: Linearize,
    start: Vector,
    /// Unknown for the obstacle.
    optimum: Option<f64>,
}

fn random(rows: usize, columns: usize, seed: u64) -> Matrix {
    let entries = seeded_direction(rows * columns, seed);
    Matrix::from_fn(rows, columns, |i, j| entries[i * columns + j])
}

/// h of c_i = b_i + |a_i (x − x*) + ½β (a_i (x − x*))²|, b_i > 0, h growing in each output: x* on all kinks is the
/// optimum.
fn folded(outer: Box<dyn OuterFunction>, n: usize, seed: u64, curvature: f64) -> Kinked {
    let rows = random(n + 2, n, seed + 3);
    let floor = seeded_direction(n + 2, seed + 4).map(|entry| 0.5 + 0.4 * entry);
    let solution = seeded_direction(n, seed + 1);
    let start = &solution + seeded_direction(n, seed + 2);
    let optimum = Some(outer.value(&floor));
    let linearize = move |x: &Vector| {
        let lengths = &rows * (x - &solution);
        let signed = lengths.map(|length| length + 0.5 * curvature * length * length);
        let slope = |i: usize, j: usize| signed[i].signum() * (1.0 + curvature * lengths[i]) * rows[(i, j)];
        (&floor + signed.abs(), Matrix::from_fn(n + 2, n, slope))
    };
    Kinked { dimension: n, outer, linearize: Box::new(linearize), start, optimum }
}

/// A chain of m = 2n springs over the ground, K y = B x − load + λ, y ≥ 0 ⊥ λ ≥ 0: y near a shape that lies below the
/// ground in parts, and small forces λ; outputs (y, λ, x).
fn obstacle(n: usize, seed: u64) -> Kinked {
    let m = 2 * n;
    let forces = random(m, n, seed + 3);
    let wanted = seeded_direction(m, seed + 4) * 0.1;
    let outer = FnOuter::new(move |c: &Vector| {
        let slope = |i: usize| {
            if i < m {
                c[i] - wanted[i]
            } else if i < 2 * m {
                0.5
            } else {
                1e-3 * c[i]
            }
        };
        let slopes = Vector::from_fn(c.len(), |i, _| slope(i));
        let value = |i: usize| {
            if i < m {
                0.5 * slopes[i].powi(2)
            } else if i < 2 * m {
                0.5 * c[i]
            } else {
                5e-4 * c[i].powi(2)
            }
        };
        ((0..c.len()).map(value).sum(), slopes)
    });
    let linearize = move |x: &Vector| {
        let (state, rates) = chain(&forces, x);
        let mut jacobian = Matrix::identity(2 * m + n, n);
        jacobian.rows_mut(0, 2 * m).copy_from(&rates);
        jacobian.rows_mut(2 * m, n).fill_with_identity();
        (Vector::from_fn(2 * m + n, |i, _| if i < 2 * m { state[i] } else { x[i - 2 * m] }), jacobian)
    };
    let start = seeded_direction(n, seed + 1) + seeded_direction(n, seed + 2) * 3.0;
    Kinked { dimension: n, outer: Box::new(outer), linearize: Box::new(linearize), start, optimum: None }
}

/// (y, λ) and its derivative, by the primal–dual active set method, which is finite for this M-matrix.
fn chain(forces: &Matrix, x: &Vector) -> (Vector, Matrix) {
    let m = forces.nrows();
    let entry = |i: usize, j: usize| f64::from(u8::from(i == j)) * 2.0 - f64::from(u8::from(i.abs_diff(j) == 1));
    let stiffness = Matrix::from_fn(m, m, entry);
    let load = (forces * x).add_scalar(-0.3);
    let mut closed = vec![false; m];
    loop {
        let held = |i: usize, j: usize| if closed[i] { f64::from(u8::from(i == j)) } else { stiffness[(i, j)] };
        let factor = Matrix::from_fn(m, m, held).lu();
        let free = |of: &Matrix| Matrix::from_fn(m, of.ncols(), |i, j| if closed[i] { 0.0 } else { of[(i, j)] });
        let solve = |of: &Matrix| {
            let y = factor.solve(&free(of)).unwrap();
            let pressed = &stiffness * &y - of;
            Matrix::from_fn(2 * m, of.ncols(), |i, j| if i < m { y[(i, j)] } else { pressed[(i - m, j)] })
        };
        let state = solve(&Matrix::from_column_slice(m, 1, load.as_slice())).column(0).into_owned();
        let next: Vec<bool> = (0..m).map(|i| if closed[i] { state[m + i] > 0.0 } else { state[i] < 0.0 }).collect();
        if next == closed {
            return (state, solve(forces));
        }
        closed = next;
    }
}

/// The best value of a run after each of its evaluations.
fn values(problem: &Kinked, composite_model: bool) -> Vec<f64> {
    let theta = CompositeFunction::new(problem.dimension, &*problem.outer, |x: &Vector| (problem.linearize)(x));
    let config = BundleTrustConfig { composite_model, max_evaluations: 600, ..BundleTrustConfig::default() };
    let report = BundleTrust::new(config).unwrap().minimize(&theta, problem.start.clone()).unwrap();
    assert!(report.termination.is_stationary(), "{report}");
    report.history.iter().map(|record| record.center_value).collect()
}

/// Evaluations to 1e-6 with the composite model and without; the optimum is the better end where it is not known.
fn counts(problem: &Kinked) -> [usize; 2] {
    let runs = [values(problem, true), values(problem, false)];
    let best = runs.iter().flatten().copied().fold(f64::INFINITY, f64::min);
    let optimum = problem.optimum.unwrap_or(best);
    let level = optimum + 1e-6 * optimum.abs().max(1.0);
    runs.map(|run| 1 + run.iter().position(|value| *value <= level).unwrap_or_else(|| panic!("{run:?} {level}")))
}

/// Geometric mean of the ratio with to without over dimensions 3 … 10, five problems each.
fn mean(problem: impl Fn(usize, u64) -> Kinked) -> f64 {
    let all = (3..=10_usize).flat_map(|n| (0..5_u64).map(move |k| (n, 1000 * k + n as u64)));
    let logs: Vec<f64> = all
        .map(|(n, seed)| {
            let [with, without] = counts(&problem(n, seed));
            (with as f64 / without as f64).ln()
        })
        .collect();
    (logs.iter().sum::<f64>() / logs.len() as f64).exp()
}

/// What 40 problems may take with the composite model, relative to cuts alone.
const LARGEST_MEAN: f64 = 1.1;

#[test]
fn on_kinks_of_the_outputs_the_composite_model_costs_at_most_a_tenth() {
    let means = [
        ("sum of squares", mean(|n, seed| folded(Box::new(SumOfPowers { exponent: 2.0 }), n, seed, 0.0))),
        ("sum of fourth powers", mean(|n, seed| folded(Box::new(SumOfPowers { exponent: 4.0 }), n, seed, 0.0))),
        ("Euclidean norm", mean(|n, seed| folded(Box::new(EuclideanNorm), n, seed, 0.0))),
        ("curved kinks", mean(|n, seed| folded(Box::new(SumOfPowers { exponent: 2.0 }), n, seed, 0.2))),
        ("obstacle", mean(obstacle)),
    ];
    assert!(means.iter().all(|(_, mean)| *mean <= LARGEST_MEAN), "{means:?}");
}

/// Each problem takes at most a tenth and one evaluation more than with the cuts alone, and about the counts measured
/// before.
#[test]
fn three_kinked_problems_take_what_the_cuts_take() {
    let problems = [
        ("sum of squares", folded(Box::new(SumOfPowers { exponent: 2.0 }), 6, 6, 0.0), [27, 28]),
        ("Euclidean norm", folded(Box::new(EuclideanNorm), 8, 8, 0.0), [32, 37]),
        ("obstacle", obstacle(5, 5), [54, 53]),
    ];
    let mut differences = vec![];
    for (name, problem, measured) in problems {
        let found = counts(&problem);
        assert!(found[0] as f64 <= 1.1 * found[1] as f64 + 1.0, "{name}: {found:?}");
        let about = |found: usize, measured: usize| found as f64 <= 1.15 * measured as f64 + 2.0;
        if !(about(found[0], measured[0]) && about(found[1], measured[1])) {
            differences.push(format!("{name}: {found:?}"));
        }
    }
    assert!(differences.is_empty(), "{differences:#?}");
}
