//! The optimal values: at known minimisers, and against a long minimisation.

use crate::common::{around_start, dot, minimise};
use testset::kit::Random;
use testset::{Problem, all, find};

fn known_minimisers() -> Vec<(&'static str, Vec<f64>)> {
    vec![
        ("Rosenbrock", vec![1.0; 2]),
        ("CB3", vec![1.0; 2]),
        ("DEM", vec![0.0, -3.0]),
        ("QL", vec![1.2, 2.4]),
        ("Mifflin1", vec![1.0, 0.0]),
        ("Mifflin2", vec![1.0, 0.0]),
        ("RosenSuzuki", vec![0.0, 1.0, 2.0, -1.0]),
        ("MAXL", vec![0.0; 20]),
        ("Goffin", vec![0.0; 50]),
        ("L1HILB", vec![0.0; 50]),
        ("WF", vec![0.0; 2]),
        ("GenMXHILB", vec![0.0; 50]),
        ("ChainedLQ", vec![0.5_f64.sqrt(); 50]),
        ("ChainedCB3II", vec![1.0; 50]),
        ("ActiveFaces", vec![0.0; 50]),
        ("ChainedCrescentI", vec![0.0; 50]),
        ("ChainedCrescentII", vec![0.0; 50]),
        ("ChebRosenN1_2", vec![1.0; 2]),
        ("ChebRosenN1_5", vec![1.0; 5]),
        ("NesterovWorst_20", vec![-0.5; 20]),
    ]
}

#[test]
fn known_minimisers_have_the_optimal_value() {
    for (name, x) in known_minimisers() {
        let problem = find(name).expect("in the table");
        let error = problem.evaluate(&x).0 - problem.optimal_value;
        assert!(error.abs() <= 1e-13 * (1.0 + problem.optimal_value.abs()), "{name}: {error:e}");
    }
}

/// The problem in scaled variables, its bounds and rows as penalties; none leaves the region where f is bounded below.
struct Penalized<'a> {
    problem: &'a Problem,
    scale: Vec<f64>,
    weight: f64,
}

impl<'a> Penalized<'a> {
    fn new(problem: &'a Problem) -> Self {
        let (badly_scaled, weight) = match problem.name.as_str() {
            "HS114" => (true, 1e5),
            "Dembo5" => (true, 1e5),
            _ => (false, 300.0),
        };
        let scale = problem.start.iter().map(|x| if badly_scaled { x.abs() } else { 1.0 }).collect();
        Self { problem, scale, weight }
    }

    fn unscaled(&self, z: &[f64]) -> Vec<f64> {
        z.iter().zip(&self.scale).map(|(z, s)| z * s).collect()
    }

    fn evaluate(&self, z: &[f64]) -> (f64, Vec<f64>) {
        let (p, x) = (self.problem, self.unscaled(z));
        let (mut value, mut gradient) = p.evaluate(&x);
        for (i, &s) in self.scale.iter().enumerate() {
            let outside = outside(x[i], p.lower[i], p.upper[i]) / s;
            value += self.weight * outside.abs();
            gradient[i] += self.weight * sign(outside) / s;
        }
        for (row, (&lower, &upper)) in p.rows.iter().zip(p.row_lower.iter().zip(&p.row_upper)) {
            let norm = row.iter().zip(&self.scale).map(|(a, s)| (a * s) * (a * s)).sum::<f64>().sqrt();
            let outside = outside(dot(row, &x), lower, upper) / norm;
            value += self.weight * outside.abs();
            gradient.iter_mut().zip(row).for_each(|(g, a)| *g += self.weight * sign(outside) * a / norm);
        }
        gradient.iter_mut().zip(&self.scale).for_each(|(g, s)| *g *= s);
        // Colville's cubic is unbounded below far from the nonnegative orthant, the alkylation process beyond x₁ = 0.
        let floor = if p.name == "Colville1" { -1.0 } else { 0.0 };
        let lost = ["Colville1", "HS114"].contains(&p.name.as_str()) && x.iter().any(|&x| x < floor);
        (if lost { f64::INFINITY } else { value }, gradient)
    }
}

fn outside(value: f64, lower: f64, upper: f64) -> f64 {
    (value - upper).max(0.0) - (lower - value).max(0.0)
}

fn sign(value: f64) -> f64 {
    if value == 0.0 { 0.0 } else { value.signum() }
}

/// Points near the optimum of the two badly scaled problems, from their statements in Hock and Schittkowski.
fn approximate_minimiser(name: &str) -> Option<Vec<f64>> {
    match name {
        "HS114" => {
            Some(vec![1698.096, 15818.73, 54.10228, 3031.226, 2000.0, 90.11537, 95.0, 10.49336, 1.561636, 153.53535])
        }
        "Dembo5" => Some(vec![579.3167, 1359.943, 5110.071, 182.0174, 295.5985, 217.9799, 286.4162, 395.5979]),
        _ => None,
    }
}

#[test]
fn long_minimisations_end_at_the_optimal_values() {
    for (seed, p) in all().iter().enumerate() {
        let mut random = Random(seed as u64);
        let penalized = Penalized::new(p);
        let spreads = [0.0, 0.01, 0.1, 0.3, 1.0, 3.0];
        let starts = spreads.map(|spread| around_start(p, spread, &mut random)).into_iter();
        let mut best = f64::INFINITY;
        for start in starts.chain(approximate_minimiser(&p.name)) {
            let z: Vec<f64> = start.iter().zip(&penalized.scale).map(|(x, s)| x / s).collect();
            let (_, z) = minimise(&|z| penalized.evaluate(z), &z, 20_000);
            let x = penalized.unscaled(&z);
            let gap = (p.evaluate(&x).0 - p.optimal_value) / (1.0 + p.optimal_value.abs());
            println!("{:18} {gap:9.1e} violation {:.0e}", p.name, p.violation(&x));
            if p.violation(&x) <= 1e-8 {
                assert!(gap >= -1e-6, "{}: below the optimal value by {:e} at {x:?}", p.name, -gap);
                best = best.min(gap);
            }
        }
        // Valleys that are hard for this method; elsewhere it is exact.
        let tolerance = match p.name.as_str() {
            "ChebRosenN1_5" => 1e-3,
            "ShellDual" | "Watson20" => 1e-5,
            _ => 1e-6,
        };
        assert!(best <= tolerance, "{}: best value above the optimal value by {best:e}", p.name);
    }
}
