//! The collection with all pieces given: composite model against cuts alone.

use nonsmooth::composite::FnOuter;
use nonsmooth::{BundleTrust, BundleTrustConfig, CompositeFunction, Matrix, Polyhedron, StopRule, Vector};
use testset::{Composition, Problem};

/// Solved neither with the composite model nor without.
const UNSOLVED: &str = "ChebRosenN1_5";
/// Geometric mean of the evaluations with the composite model to those without, and the problems it is taken over.
const MEASURED: (f64, usize) = (0.266, 42);
/// What the mean may be at most.
const LARGEST_MEAN: f64 = 0.5;
/// Rounding differs between processors, and a few courses with it.
const MARGIN: f64 = 0.03;

fn max_evaluations(dimension: usize) -> usize {
    if dimension >= 50 { 3000 } else { 2000 }
}

/// Evaluations to value − optimum ≤ 1e-6 max(1, |optimum|).
fn evaluations(problem: &Problem, composition: &Composition, composite_model: bool) -> Option<usize> {
    let n = problem.dimension;
    let outer = FnOuter::new(|outputs: &Vector| {
        let (value, subgradient) = composition.outer().evaluate(outputs.as_slice());
        (value, Vector::from_vec(subgradient))
    });
    let theta = CompositeFunction::new(n, outer, |x: &Vector| {
        let (outputs, gradients) = composition.linearize(x.as_slice());
        let jacobian = Matrix::from_fn(outputs.len(), n, |i, j| gradients[i][j]);
        (Vector::from_vec(outputs), jacobian)
    });
    let vector = |values: &[f64]| Vector::from_column_slice(values);
    let rows = Matrix::from_fn(problem.rows.len(), n, |i, j| problem.rows[i][j]);
    let set = Polyhedron::boxed(vector(&problem.lower), vector(&problem.upper))
        .and_then(|set| set.with_rows(&rows, &vector(&problem.row_lower), &vector(&problem.row_upper)))
        .unwrap();
    let config =
        BundleTrustConfig { composite_model, max_evaluations: max_evaluations(n), ..BundleTrustConfig::default() };
    let level = problem.optimal_value + 1e-6 * problem.optimal_value.abs().max(1.0);
    let mut method = BundleTrust::new(config).unwrap().constraints(set).stop_when(StopRule::ValueBelow(level));
    let report = method.minimize(&theta, vector(&problem.start)).unwrap();
    (report.value <= level).then_some(report.counts.evaluations)
}

#[test]
fn all_pieces_at_once_halve_the_evaluations_on_the_collection_and_lose_no_problem() {
    let (mut logs, mut lost, mut table) = (vec![], vec![], vec![]);
    for problem in testset::all().into_iter().filter(|problem| problem.name != UNSOLVED) {
        let Some(composition) = problem.composition() else { continue };
        let [with, without] = [true, false].map(|composite| evaluations(&problem, composition, composite));
        table.push(format!("{} {with:?} {without:?}", problem.name));
        // The last bit decides whether cuts alone solve ShellDual: where they do not, they count with their limit.
        let without = without.unwrap_or_else(|| max_evaluations(problem.dimension));
        match with {
            Some(with) => logs.push((with as f64 / without as f64).ln()),
            None => lost.push(problem.name),
        }
    }
    let mean = (logs.iter().sum::<f64>() / logs.len() as f64).exp();
    assert!(lost.is_empty(), "{lost:?} {table:#?}");
    assert!(mean <= LARGEST_MEAN, "{mean} {table:#?}");
    assert!(logs.len() == MEASURED.1 && (mean - MEASURED.0).abs() <= MARGIN, "{mean} over {} {table:#?}", logs.len());
}
