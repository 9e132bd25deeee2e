//! Points near a start, and a descent method for functions with kinks.

use testset::Problem;
use testset::kit::Random;

/// A point around the start, moved by at most `spread` (|xᵢ| + 1/10) in each variable and clipped to the bounds.
pub fn around_start(problem: &Problem, spread: f64, random: &mut Random) -> Vec<f64> {
    let sides = problem.lower.iter().zip(&problem.upper);
    let moved = problem.start.iter().map(|x| x + spread * (x.abs() + 0.1) * random.signed());
    moved.zip(sides).map(|(x, (&l, &u))| x.clamp(l, u)).collect()
}

/// A function with a gradient.
pub type Oracle<'a> = dyn Fn(&[f64]) -> (f64, Vec<f64>) + 'a;

/// BFGS with a weak Wolfe bisection, which tolerates kinks; restarted with a fresh matrix when a search fails.
pub fn minimise(oracle: &Oracle, start: &[f64], evaluations: usize) -> (f64, Vec<f64>) {
    let n = start.len();
    let identity = || (0..n).map(|i| (0..n).map(|j| f64::from(u8::from(i == j))).collect()).collect();
    let mut inverse: Vec<Vec<f64>> = identity();
    let (mut x, (mut value, mut gradient)) = (start.to_vec(), oracle(start));
    let (mut left, mut fresh) = (evaluations, true);
    while left > 0 {
        let direction: Vec<f64> = inverse.iter().map(|row| -dot(row, &gradient)).collect();
        let slope = dot(&direction, &gradient);
        let found = if slope < 0.0 { search(oracle, &x, value, &direction, slope, &mut left) } else { None };
        let Some((next, next_value, next_gradient, curvature)) = found else {
            if fresh {
                break;
            }
            (inverse, fresh) = (identity(), true);
            continue;
        };
        let s: Vec<f64> = next.iter().zip(&x).map(|(a, b)| a - b).collect();
        let y: Vec<f64> = next_gradient.iter().zip(&gradient).map(|(a, b)| a - b).collect();
        if curvature && dot(&s, &y) > 0.0 {
            if fresh {
                let scale = dot(&s, &y) / dot(&y, &y);
                inverse.iter_mut().flatten().for_each(|h| *h *= scale);
            }
            update(&mut inverse, &s, &y);
            fresh = false;
        }
        (x, value, gradient) = (next, next_value, next_gradient);
    }
    (value, x)
}

type Step = (Vec<f64>, f64, Vec<f64>, bool);

fn search(oracle: &Oracle, x: &[f64], value: f64, d: &[f64], slope: f64, left: &mut usize) -> Option<Step> {
    let (mut low, mut high, mut step) = (0.0, f64::INFINITY, 1.0);
    let mut best = None;
    for _ in 0..60 {
        let next: Vec<f64> = x.iter().zip(d).map(|(x, d)| x + step * d).collect();
        let (next_value, next_gradient) = oracle(&next);
        *left = left.saturating_sub(1);
        // The comparisons fail for values that are no numbers.
        let descends = next_value < value + 1e-4 * step * slope;
        if !descends {
            high = step;
        } else if dot(&next_gradient, d) < 0.5 * slope {
            low = step;
            best = Some((next, next_value, next_gradient, false));
        } else {
            return Some((next, next_value, next_gradient, true));
        }
        step = if high.is_finite() { 0.5 * (low + high) } else { 2.0 * step };
        if *left == 0 {
            break;
        }
    }
    best
}

fn update(inverse: &mut [Vec<f64>], s: &[f64], y: &[f64]) {
    let rho = 1.0 / dot(s, y);
    let hy: Vec<f64> = inverse.iter().map(|row| dot(row, y)).collect();
    let factor = rho * (1.0 + rho * dot(y, &hy));
    for (i, row) in inverse.iter_mut().enumerate() {
        for (j, h) in row.iter_mut().enumerate() {
            *h += factor * s[i] * s[j] - rho * (s[i] * hy[j] + hy[i] * s[j]);
        }
    }
}

pub fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}
