//! Nonlinear inequalities against the same engine on an exact penalty, f + ρ max(0, c_j), and what declared convexity
//! proves.

use crate::common::v;
use nonsmooth::{
    BundleTrust, BundleTrustConfig, ConstrainedFunction, ConstraintEvaluation, ConstraintKind, Convexity, FnObjective,
    Matrix, NonsmoothObjective, Polyhedron, Report, Termination, Vector,
};
use std::cell::Cell;
use testset::constrained::{ConstrainedProblem, Kind, all};
use testset::kit::jitters;

/// The first evaluation at which f + ρ max(0, c_j) is within 1e-6 of the optimum.
struct Watch<'a> {
    problem: &'a ConstrainedProblem,
    evaluations: Cell<usize>,
    first: Cell<Option<usize>>,
}

impl<'a> Watch<'a> {
    fn new(problem: &'a ConstrainedProblem) -> Self {
        Self { problem, evaluations: Cell::new(0), first: Cell::new(None) }
    }

    fn reached(&self, x: &Vector) -> bool {
        let (value, _) = penalized(self.problem, x);
        (value - self.problem.optimum).abs() <= 1e-6 * self.problem.optimum.abs().max(1.0)
    }

    fn see(&self, x: &Vector) {
        self.evaluations.set(self.evaluations.get() + 1);
        if self.first.get().is_none() && self.reached(x) {
            self.first.set(Some(self.evaluations.get()));
        }
    }
}

fn penalized(problem: &ConstrainedProblem, x: &Vector) -> (f64, Vector) {
    let found = problem.evaluate(x.as_slice());
    let (value, slope) = (found.value, Vector::from_vec(found.subgradient));
    match found.constraints.into_iter().max_by(|a, b| a.0.total_cmp(&b.0)) {
        Some((c, s)) if c > 0.0 => (value + problem.penalty * c, slope + Vector::from_vec(s) * problem.penalty),
        _ => (value, slope),
    }
}

fn constrained(problem: &ConstrainedProblem, x: &Vector) -> (f64, Vector, ConstraintEvaluation) {
    let found = problem.evaluate(x.as_slice());
    let (values, rows): (Vec<f64>, Vec<Vec<f64>>) = found.constraints.into_iter().unzip();
    let jacobian = Matrix::from_fn(rows.len(), x.len(), |j, k| rows[j][k]);
    (found.value, Vector::from_vec(found.subgradient), ConstraintEvaluation::new(Vector::from_vec(values), jacobian))
}

fn run(objective: &impl NonsmoothObjective, set: Polyhedron, start: &[f64], convexity: Convexity) -> Report {
    let config = BundleTrustConfig { max_evaluations: 1000, convexity, ..Default::default() };
    BundleTrust::new(config).unwrap().constraints(set).minimize(objective, v(start)).unwrap()
}

/// All inequalities as a single nonsmooth one.
#[test]
fn joined_inequalities_are_solved_at_least_as_often_as_by_the_penalty_and_with_fewer_evaluations() {
    let (mut solved, mut ratios) = ([0; 2], vec![]);
    let problems =
        all().into_iter().filter(|problem| problem.dimension <= 20 && !problem.kinds.contains(&Kind::SmoothEquality));
    for problem in problems.map(|problem| problem.joined()) {
        let set = Polyhedron::boxed(v(&problem.lower), v(&problem.upper)).unwrap();
        let watches = [Watch::new(&problem), Watch::new(&problem)];
        let limited = ConstrainedFunction::new(problem.dimension, vec![ConstraintKind::Nonsmooth], |x: &Vector| {
            watches[0].see(x);
            constrained(&problem, x)
        });
        let with_penalty = FnObjective::new(problem.dimension, |x: &Vector| {
            watches[1].see(x);
            penalized(&problem, x)
        });
        let reports = [
            run(&limited, set.clone(), &problem.start, Convexity::Unknown),
            run(&with_penalty, set, &problem.start, Convexity::Unknown),
        ];
        for (count, (report, watch)) in solved.iter_mut().zip(reports.iter().zip(&watches)) {
            *count += usize::from(watch.reached(&report.solution));
        }
        let report = &reports[0];
        let true_end = watches[0].reached(&report.solution)
            || problem.other_optima.iter().any(|value| (report.value - value).abs() <= 1e-5 * value.abs());
        assert!(true_end || !report.termination.is_confirmed(), "{}: {report}", problem.name);
        println!("{}: {:?} {:?}", problem.name, watches[0].first, watches[1].first);
        if let [Some(here), Some(there)] = [watches[0].first.get(), watches[1].first.get()] {
            ratios.push((here as f64 / there as f64).ln());
        }
    }
    let ratio = (ratios.iter().sum::<f64>() / ratios.len() as f64).exp();
    println!("solved {solved:?} of {}, evaluations over the penalty's {ratio:.3}", ratios.len());
    assert!(solved[0] >= solved[1], "{solved:?}");
    assert!(ratio <= 1.1, "{ratio}");
}

/// Largest eigenvalue of A₀ + Σ x_k A_k at most 1, where the objective is linear.
#[test]
fn limits_on_eigenvalues_are_confirmed_where_convexity_is_declared() {
    for seed in 0..10 {
        let (n, m) = (6, 8);
        let mut matrices: Vec<Matrix> = vec![];
        for k in 0..=n {
            let entries: Vec<f64> = jitters(&vec![0.5; m * m], seed * 100 + k as u64).collect();
            let matrix = Matrix::from_vec(m, m, entries);
            matrices.push((&matrix + matrix.transpose()) * if k == 0 { 0.1 } else { 1.0 });
        }
        let cost = Vector::from_vec(jitters(&vec![0.5; n], seed).collect());
        let limited = ConstrainedFunction::new(n, vec![ConstraintKind::Nonsmooth], |x: &Vector| {
            let sum = (0..n).fold(matrices[0].clone(), |sum, k| sum + &matrices[k + 1] * x[k]);
            let eigen = sum.symmetric_eigen();
            let largest = eigen.eigenvalues.imax();
            let mode = eigen.eigenvectors.column(largest).into_owned();
            let slope = Matrix::from_fn(1, n, |_, k| mode.dot(&(&matrices[k + 1] * &mode)));
            let limit = ConstraintEvaluation::new(v(&[eigen.eigenvalues[largest] - 1.0]), slope);
            (cost.dot(x), cost.clone(), limit)
        });
        let set = || Polyhedron::unbounded(n);
        let [inside, outside] = [0.0, 3.0].map(|start| run(&limited, set(), &vec![start; n], Convexity::Convex));
        for (report, other) in [(&inside, &outside), (&outside, &inside)] {
            let Termination::Stationary { gap: Some(gap), .. } = report.termination else {
                panic!("seed {seed}: {report}")
            };
            let size = report.value.abs();
            assert!(gap <= 1e-6 * size, "seed {seed}: gap {gap:e}");
            assert!(report.value - other.value <= gap + 1e-9 * size, "seed {seed}: {} {}", report.value, other.value);
        }
    }
}
