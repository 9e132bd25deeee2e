//! Objectives with known minimum 1, made hostile: stretched variables, noise, failures.

use nonsmooth::{Answer, Evaluation, NonsmoothObjective, OracleError, Request, Vector};
use std::sync::atomic::{AtomicUsize, Ordering};
use testset::kit::jitter;

/// An exact objective: value and one subgradient.
pub type Exact = fn(&Vector) -> (f64, Vector);

/// The minimiser of the objectives below, entry by entry.
pub fn centre(index: usize) -> f64 {
    0.3 + 0.1 * index as f64
}

/// 1 + Σ (i + 1)/n |xᵢ − cᵢ|.
pub fn polyhedral(x: &Vector) -> (f64, Vector) {
    let weight = |i: usize| (i + 1) as f64 / x.len() as f64;
    let value = x.iter().enumerate().map(|(i, x)| weight(i) * (x - centre(i)).abs()).sum::<f64>();
    (1.0 + value, Vector::from_fn(x.len(), |i, _| weight(i) * (x[i] - centre(i)).signum()))
}

/// 1 + max (xᵢ − cᵢ)².
pub fn largest_square(x: &Vector) -> (f64, Vector) {
    let offset = |i: usize| x[i] - centre(i);
    let worst = (0..x.len()).fold(0, |worst, i| if offset(i).abs() > offset(worst).abs() { i } else { worst });
    let distance = offset(worst);
    let mut slope = Vector::zeros(x.len());
    slope[worst] = 2.0 * distance;
    (1.0 + distance * distance, slope)
}

/// 1 + max over k of aₖ·(x − c), aₖ equal up to 1e-8, and the same reversed: cuts that are parallel to eight digits.
pub fn nearly_parallel(x: &Vector) -> (f64, Vector) {
    let row = |k: usize| {
        Vector::from_fn(x.len(), |i, _| 1.0 / (i + 1) as f64 + 1e-8 * (1.3 * (k * x.len() + i) as f64).sin())
    };
    let offset = Vector::from_fn(x.len(), |i, _| x[i] - centre(i));
    let mut best = (f64::NEG_INFINITY, Vector::zeros(x.len()));
    for k in 0..40 {
        let slope = row(k) * if k % 2 == 0 { 1.0 } else { -1.0 };
        let value = slope.dot(&offset);
        if value > best.0 {
            best = (value, slope);
        }
    }
    (1.0 + best.0, best.1)
}

/// 1 + the nonconvex crescent max{x² + (y − 1)² + y − 1, −x² − (y − 1)² + y + 1}.
pub fn crescent(x: &Vector) -> (f64, Vector) {
    let (a, b) = (x[0], x[1] - 1.0);
    let round = a * a + b * b;
    if round + b >= b + 2.0 - round {
        (1.0 + round + b, Vector::from_vec(vec![2.0 * a, 2.0 * b + 1.0]))
    } else {
        (3.0 + b - round, Vector::from_vec(vec![-2.0 * a, 1.0 - 2.0 * b]))
    }
}

/// An objective in variables z with x = D z, noisy and failing as told.
pub struct Hostile {
    pub exact: Exact,
    pub scales: Vector,
    /// Relative size of the noise in value and subgradient.
    pub noise: f64,
    /// Every how many calls one fails; none for never.
    pub failing: Option<usize>,
    calls: AtomicUsize,
}

impl Hostile {
    /// A well-behaved objective of some variables.
    pub fn new(exact: Exact, dimension: usize) -> Self {
        let scales = Vector::from_element(dimension, 1.0);
        Self { exact, scales, noise: 0.0, failing: None, calls: AtomicUsize::new(0) }
    }
}

impl NonsmoothObjective for Hostile {
    type WarmStart = ();

    fn dimension(&self) -> usize {
        self.scales.len()
    }

    fn evaluate(&self, request: &Request<'_, ()>) -> Result<Answer<()>, OracleError> {
        let call = self.calls.fetch_add(1, Ordering::Relaxed) + 1;
        if self.failing.is_some_and(|every| call.is_multiple_of(every)) {
            return Err(OracleError::NotConverged { solver: "hostile oracle", residual: 1.0, iterations: call });
        }
        let z = request.point;
        let (exact, slope) = (self.exact)(&z.component_mul(&self.scales));
        let value = exact * (1.0 + self.noise * jitter(z.as_slice(), 0));
        let size = slope.norm();
        let noisy = Vector::from_fn(z.len(), |i, _| slope[i] + self.noise * size * jitter(z.as_slice(), 1 + i as u64));
        let subgradient = noisy.component_mul(&self.scales);
        Ok(Answer::Accurate(Evaluation::exact(value, subgradient, ())))
    }
}
