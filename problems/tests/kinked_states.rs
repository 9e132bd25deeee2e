//! States whose optima lie on kinks: with the composite model, toy and membrane take what cuts alone take, and a tenth
//! at most.
#![allow(clippy::unwrap_used, reason = "a test stops at the first surprise")]

use nonsmooth::composite::{OuterFunction, weighted_gram};
use nonsmooth::verify::seeded_direction;
use nonsmooth::{
    Accuracy, BundleTrust, BundleTrustConfig, Coderivative, CompositeFunction, Matrix, NonsmoothObjective, Polyhedron,
    Request, StateSolver, Vector,
};
use problems::{membrane, toy};

/// h(c) = ⟨a, c⟩ + ½ Σ q_i (c_i − z_i)².
struct LinearQuadratic {
    slopes: Vector,
    curvatures: Vector,
    centers: Vector,
}

impl LinearQuadratic {
    /// From rows (a_i, q_i, z_i).
    fn new(rows: &[[f64; 3]]) -> Self {
        let column = |k: usize| Vector::from_fn(rows.len(), |i, _| rows[i][k]);
        Self { slopes: column(0), curvatures: column(1), centers: column(2) }
    }
}

impl OuterFunction for LinearQuadratic {
    fn value(&self, c: &Vector) -> f64 {
        let away = c - &self.centers;
        self.slopes.dot(c) + 0.5 * self.curvatures.dot(&away.component_mul(&away))
    }

    fn subgradient(&self, c: &Vector) -> Vector {
        &self.slopes + self.curvatures.component_mul(&(c - &self.centers))
    }

    fn curvature(&self, _: &Vector, jacobian: &Matrix) -> Option<Matrix> {
        Some(weighted_gram(jacobian, &self.curvatures))
    }
}

/// Rows of outputs and Jacobian, the controls themselves last.
fn with_controls(rows: Vec<(f64, Vector)>, controls: &Vector) -> (Vector, Matrix) {
    let (states, n) = (rows.len(), controls.len());
    let outputs = Vector::from_fn(states + n, |i, _| if i < states { rows[i].0 } else { controls[i - states] });
    let unit = |i: usize, j: usize| f64::from(u8::from(i == j));
    let jacobian = Matrix::from_fn(states + n, n, |i, j| if i < states { rows[i].1[j] } else { unit(i - states, j) });
    (outputs, jacobian)
}

/// Values of a run from a start, with the composite model or without it.
fn values(theta: &impl NonsmoothObjective, set: &Polyhedron, start: &Vector, composite_model: bool) -> Vec<f64> {
    let config = BundleTrustConfig { composite_model, max_evaluations: 300, ..BundleTrustConfig::default() };
    let report = BundleTrust::new(config).unwrap().constraints(set.clone()).minimize(theta, start.clone()).unwrap();
    report.history.iter().map(|record| record.value.unwrap()).collect()
}

/// The ratio of the evaluations to the best value of both runs, or the optimum if it is known, and 1e-6 of its size.
fn ratio(theta: &impl NonsmoothObjective, set: &Polyhedron, start: &Vector, optimum: Option<f64>) -> f64 {
    let runs = [true, false].map(|composite_model| values(theta, set, start, composite_model));
    let best = optimum.unwrap_or_else(|| runs.iter().flatten().copied().fold(f64::INFINITY, f64::min));
    let level = best + 1e-6 * best.abs();
    let count = |run: &[f64]| 1 + run.iter().position(|value| *value <= level).expect("300 evaluations are enough");
    count(&runs[0]) as f64 / count(&runs[1]) as f64
}

fn geometric_mean(ratios: impl Iterator<Item = f64>) -> f64 {
    let logs: Vec<f64> = ratios.map(f64::ln).collect();
    (logs.iter().sum::<f64>() / logs.len() as f64).exp()
}

#[test]
fn the_toy_takes_what_cuts_take() {
    let plain = toy::toy_objective();
    // Slip, height and normal force of both nodes (t = P = 1 and 2, a = 2/5), and the controls (γ = 1/8).
    let node = |p: f64| [[p, 0.0, 0.0], [-p, 0.0, 0.0], [0.0, 0.4, 0.0]];
    let rows = [&node(1.0)[..], &node(2.0)[..], &[[0.0, 0.125, 1.0]; 2][..]].concat();
    let theta = CompositeFunction::new(2, LinearQuadratic::new(&rows), |x: &Vector| {
        let state = plain.solver().solve(x, None, Accuracy::TIGHTEST).unwrap();
        let mut rows = vec![];
        for (i, surface) in toy::SURFACE.iter().enumerate() {
            let (v, d) = (state.nodes[i].values, plain.solver().nodes()[i].derivative(state.nodes[i].status));
            for (value, slope) in [(v.slip, d.slip), (v.height, d.height), (v.normal_force, d.normal_force)] {
                rows.push((value, Vector::from_column_slice(surface) * slope));
            }
        }
        with_controls(rows, x)
    });
    let starts = (0..10).map(|seed| seeded_direction(2, seed).map(|entry| 1.0 + 5.0 * entry));
    let ratios = starts.map(|start| {
        let exact = plain.evaluate(&Request::tight(&start)).unwrap().into_evaluation().value;
        let composed = theta.evaluate(&Request::tight(&start)).unwrap().into_evaluation().value;
        assert!((exact - composed).abs() <= 1e-13 * exact.abs().max(1.0), "{exact} {composed}");
        ratio(&theta, &toy::admissible_set(), &start, Some(toy::MINIMUM))
    });
    let mean = geometric_mean(ratios);
    assert!(mean <= 1.1, "{mean}");
}

#[test]
fn the_membrane_takes_what_cuts_take() {
    const CELLS: usize = 12;
    let plain = membrane::example(CELLS).unwrap();
    let (nodes, patches) = ((CELLS - 1) * (CELLS - 1), membrane::PATCHES * membrane::PATCHES);
    let area = 1.0 / (CELLS * CELLS) as f64;
    let wanted = |[x, y]: [f64; 2]| 0.08 * (std::f64::consts::PI * x).sin() * (std::f64::consts::PI * y).sin();
    let mut rows: Vec<_> = (0..nodes).map(|i| [0.0, area, wanted(plain.solver().grid().node(i))]).collect();
    rows.extend(vec![[0.02 * area, 0.0, 0.0]; nodes]);
    rows.extend(vec![[0.0, 1e-6 / patches as f64, 0.0]; patches]);
    let theta = CompositeFunction::new(patches, LinearQuadratic::new(&rows), |x: &Vector| {
        let state = plain.solver().solve(x, None, Accuracy::TIGHTEST).unwrap();
        let values = state.displacement.iter().chain(state.reaction.iter());
        let rows = values.enumerate().map(|(i, value)| {
            let unit = Vector::from_fn(2 * nodes, |k, _| f64::from(u8::from(k == i)));
            (*value, plain.solver().coderivative(x, &state, &unit).unwrap().element)
        });
        with_controls(rows.collect(), x)
    });
    // Single counts scatter by a fifth.
    let starts: Vec<Vector> =
        (0..8).map(|seed| seeded_direction(patches, seed) * if seed == 0 { 0.0 } else { 3.0 }).collect();
    let ratio_from = |start: &Vector| {
        let exact = plain.evaluate(&Request::tight(start)).unwrap().into_evaluation().value;
        let composed = theta.evaluate(&Request::tight(start)).unwrap().into_evaluation().value;
        assert!((exact - composed).abs() <= 1e-12 * exact.abs(), "{exact} {composed}");
        ratio(&theta, &membrane::admissible_loads(), start, None)
    };
    let ratios: Vec<f64> = std::thread::scope(|scope| {
        let runs: Vec<_> = starts.iter().map(|start| scope.spawn(|| ratio_from(start))).collect();
        runs.into_iter().map(|run| run.join().unwrap()).collect()
    });
    let mean = geometric_mean(ratios.into_iter());
    assert!(mean <= 1.1, "{mean}");
}
