//! Subgradients against differences, and against the inequality of convex functions.

use crate::common::{around_start, dot};
use testset::kit::Random;
use testset::{Problem, all, find};

/// Step of the differences in the variable x.
fn step(x: f64) -> f64 {
    3e-4 * x.abs().clamp(0.01, 1.0)
}

/// A point counts as smooth when its nearest kink, to first order, is farther than this many times the longest reach of
/// the differences. The factor covers the curvature of the kinks.
const CLEARANCE: f64 = 4.0;

fn is_smooth(problem: &Problem, x: &[f64]) -> bool {
    let reach = x.iter().map(|&x| 2.0 * step(x)).fold(0.0, f64::max);
    problem.kink_distance(x) > CLEARANCE * reach
}

/// Central difference of fourth order.
fn difference(problem: &Problem, x: &[f64], i: usize) -> f64 {
    let h = step(x[i]);
    let at = |shift: f64| {
        let mut moved = x.to_vec();
        moved[i] += shift;
        problem.evaluate(&moved).0
    };
    (8.0 * (at(h) - at(-h)) - (at(2.0 * h) - at(-2.0 * h))) / (12.0 * h)
}

/// Largest error of the subgradient relative to its largest entry (or one).
fn error(problem: &Problem, x: &[f64]) -> f64 {
    let (_, subgradient) = problem.evaluate(x);
    let scale = subgradient.iter().fold(1.0, |m: f64, g| m.max(g.abs()));
    let errors = subgradient.iter().enumerate().map(|(i, g)| (g - difference(problem, x, i)).abs());
    errors.fold(0.0, f64::max) / scale
}

#[test]
fn subgradients_are_the_differences_at_smooth_points() {
    let mut failures = Vec::new();
    for (seed, problem) in all().iter().enumerate() {
        let mut random = Random(seed as u64);
        let (mut checked, mut worst) = (0, 0.0_f64);
        for _ in 0..400 {
            let x = around_start(problem, 0.3, &mut random);
            if checked == 12 || !is_smooth(problem, &x) {
                continue;
            }
            checked += 1;
            worst = worst.max(error(problem, &x));
        }
        println!("{:18} points {checked:3}  worst relative error {worst:.1e}", problem.name);
        if checked < 12 || worst > 1e-6 {
            failures.push((problem.name.clone(), checked, worst));
        }
    }
    assert!(failures.is_empty(), "{failures:?}");
}

#[test]
fn smoothness_criterion_tells_kinks_from_smooth_points() {
    // MAXL: the kink of the two largest entries, at distance gap / √2.
    let problem = find("MAXL").expect("MAXL is in the table");
    let mut x = vec![0.0; 20];
    (x[0], x[1]) = (1.0, 1.0 - 1e-4);
    assert!((problem.kink_distance(&x) - 1e-4 / 2f64.sqrt()).abs() < 1e-12);
    assert!(!is_smooth(&problem, &x));
    assert!(error(&problem, &x) > 1e-2, "the difference does cross this kink");
    x[1] = 1.0 - 1e-2;
    assert!(is_smooth(&problem, &x));
    assert!(error(&problem, &x) < 1e-12);
    // Mifflin2: a curved kink, the unit circle.
    let problem = find("Mifflin2").expect("Mifflin2 is in the table");
    for (radius, smooth) in [(1.0, false), (1.0 + 1e-4, false), (0.99, true), (1.01, true)] {
        assert_eq!(is_smooth(&problem, &[0.6 * radius, 0.8 * radius]), smooth, "{radius}");
    }
    // No kink at all.
    let problem = find("Rosenbrock").expect("Rosenbrock is in the table");
    assert_eq!(problem.kink_distance(&problem.start), f64::INFINITY);
}

#[test]
fn convex_problems_lie_above_their_linearizations() {
    for (seed, problem) in all().iter().filter(|p| p.convex).enumerate() {
        let mut random = Random(1000 + seed as u64);
        let mut point = |spread: f64| {
            let x = around_start(problem, spread, &mut random);
            x.iter().zip(&problem.convex_lower).map(|(x, l)| x.max(*l)).collect::<Vec<f64>>()
        };
        for k in 0..400 {
            // Far and near pairs; the near ones see the curvature.
            let x = point(2.0);
            let far = point(2.0);
            let t = [1.0, 0.1, 0.01][k % 3];
            let y: Vec<f64> = x.iter().zip(&far).map(|(x, y)| x + t * (y - x)).collect();
            let ((f, g), (f_y, _)) = (problem.evaluate(&x), problem.evaluate(&y));
            let change: Vec<f64> = y.iter().zip(&x).map(|(y, x)| y - x).collect();
            let gap = f_y - f - dot(&g, &change);
            assert!(gap >= -1e-12 * (1.0 + f.abs() + f_y.abs()), "{}: {gap:e}", problem.name);
        }
    }
}

#[test]
fn convexity_needs_the_stated_orthant() {
    let middle_is_above = |name: &str, x: &[f64], d: &[f64]| {
        let problem = find(name).expect("in the table");
        assert!(x.iter().zip(&problem.convex_lower).any(|(x, l)| x < l));
        let at = |t: f64| problem.evaluate(&x.iter().zip(d).map(|(x, d)| x + t * d).collect::<Vec<_>>()).0;
        at(1.0) + at(-1.0) - 2.0 * at(0.0) < -1e-6
    };
    assert!(middle_is_above("Colville1", &[-10.0; 5], &[0.1, 0.0, 0.0, 0.0, 0.0]));
    assert!(middle_is_above("Wong1", &[0.0, 0.0, 0.0, 0.0, 0.0, -1.0, 0.05], &[0.0, 0.0, 0.0, 0.0, 0.0, 0.03, 0.1]));
}
