//! Independent certificate of an answer: the KKT residual, from the data alone.
//!
//! ```text
//! stationarity      max_i |r_i| / √H_ii  over  max_i t_i / √H_ii,   r = H d + Σ π g + Aᵀ μ + ν,  t = Σ |terms of r|
//! primal            excess over a side / (|side| + Σ |terms| + |a| (1e-10 ℓ + 1e-3 b))
//! dual              |Σ π − 1|,  −π_j,  multipliers of open or wrong sides relative to t
//! complementarity   (relative size of the multiplier) · (relative slack)
//! ```
//! ℓ = |d| + max_j |g_j| in the norms of the metric gives a side a size where all its terms vanish, as at d = 0; |g_j|
//! is the length of the unconstrained step of cut j alone. b is the largest distance |side| / |a| of any row or bound
//! (0 for cuts): sides are differences, and what is left of an active row's side at the center is rounding of that
//! size. Every part is a quotient of like quantities, so the residual does not depend on the units of values and
//! variables.

use crate::Vector;

use super::problem::{EpigraphQp, Metric, QpSolution};

/// Largest relative residual of the KKT system at an answer; the stored `kkt_residual`, `pivots` and `method` are not
/// read.
///
/// Parts: stationarity, primal feasibility, signs of the multipliers and Σ π = 1, complementarity, each relative to the
/// size of its terms. NaN anywhere gives +∞.
pub fn kkt_residual(qp: &EpigraphQp<'_>, solution: &QpSolution) -> f64 {
    let stationarity = Stationarity::new(qp, solution);
    let mut worst = stationarity.residual;
    let floor = SizeFloor::new(qp, &solution.step);
    raise(&mut worst, cut_residual(qp, solution, &floor));
    raise(&mut worst, row_residual(qp, solution, &stationarity, &floor));
    raise(&mut worst, bound_residual(qp, solution, &stationarity, &floor));
    worst
}

/// Share of |a| ℓ in the size of a side.
pub(super) const LENGTH_SHARE: f64 = 1e-10;
/// Share of |a| b in the size of a row's or a bound's side.
pub(super) const SIDE_SHARE: f64 = 1e-3;

/// b: the largest distance |side| / |a| among rows and bounds. Sides are differences in the caller's hands (side − A
/// x̂), so each carries the rounding of the largest. Numbers from 1e15 on stand for open sides.
pub(super) fn largest_side(qp: &EpigraphQp<'_>, row_norms: &[f64], weights: &[f64]) -> f64 {
    let rows = qp.row_lower.iter().zip(qp.row_upper).zip(row_norms);
    let bounds = qp.lower.iter().zip(qp.upper).zip(weights);
    let distances = rows.chain(bounds).flat_map(|((&lower, &upper), &norm)| [(lower, norm), (upper, norm)]);
    let finite = distances.filter(|(side, norm)| side.abs() < 1e15 && *norm > 0.0);
    finite.map(|(side, norm)| side.abs() / norm).fold(0.0, f64::max)
}

/// The part of a side's size that does not vanish with its terms.
struct SizeFloor {
    weights: Vec<f64>,
    cut_share: f64,
    side_share: f64,
}

impl SizeFloor {
    fn new(qp: &EpigraphQp<'_>, step: &Vector) -> Self {
        let weights: Vec<f64> = (0..qp.dimension()).map(|i| qp.metric.diagonal_entry(i).sqrt().recip()).collect();
        let step_length = step.iter().zip(&weights).map(|(d, w)| (d / w).powi(2)).sum::<f64>().sqrt();
        let mut floor = Self { weights, cut_share: 0.0, side_share: 0.0 };
        let steepest = qp.slopes.iter().map(|slope| floor.norm(slope.iter())).fold(0.0, f64::max);
        let row_norms: Vec<f64> = qp.rows.row_iter().map(|row| floor.norm(row.iter())).collect();
        floor.cut_share = LENGTH_SHARE * (step_length + steepest);
        floor.side_share = floor.cut_share + SIDE_SHARE * largest_side(qp, &row_norms, &floor.weights);
        floor
    }

    fn norm<'b>(&self, normal: impl Iterator<Item = &'b f64>) -> f64 {
        normal.zip(&self.weights).map(|(a, w)| (a * w).powi(2)).sum::<f64>().sqrt()
    }
}

/// Maximum that turns NaN into +∞.
fn raise(worst: &mut f64, value: f64) {
    *worst = if value.is_nan() { f64::INFINITY } else { worst.max(value) };
}

/// Quotient that is 0 for 0/0.
fn ratio(value: f64, size: f64) -> f64 {
    if value == 0.0 { 0.0 } else { value / size }
}

/// Residual of the stationarity equation and the size of its terms, both in the metric's own scale.
struct Stationarity {
    residual: f64,
    size: f64,
    weights: Vec<f64>,
}

impl Stationarity {
    fn new(qp: &EpigraphQp<'_>, solution: &QpSolution) -> Self {
        let n = qp.dimension();
        let weights: Vec<f64> = (0..n).map(|i| qp.metric.diagonal_entry(i).sqrt().recip()).collect();
        let mut sum = qp.metric.apply(&solution.step);
        let mut terms = metric_terms(qp, &solution.step);
        for (slope, &pi) in qp.slopes.iter().zip(&solution.cut_multipliers).filter(|(_, pi)| **pi != 0.0) {
            sum.axpy(pi, slope, 1.0);
            terms.iter_mut().zip(slope.iter()).for_each(|(t, g)| *t += (pi * g).abs());
        }
        for (i, &mu) in solution.row_multipliers.iter().enumerate().filter(|(_, mu)| **mu != 0.0) {
            for (k, a) in qp.rows.row(i).iter().enumerate() {
                sum[k] += mu * a;
                terms[k] += (mu * a).abs();
            }
        }
        for (k, nu) in solution.bound_multipliers.iter().enumerate() {
            sum[k] += nu;
            terms[k] += nu.abs();
        }
        let (mut worst, mut size) = (0.0_f64, 0.0_f64);
        for k in 0..n {
            raise(&mut worst, sum[k].abs() * weights[k]);
            raise(&mut size, terms[k] * weights[k]);
        }
        let mut residual = 0.0;
        raise(&mut residual, ratio(worst, size));
        Self { residual, size, weights }
    }

    /// Size of a multiplier's contribution relative to all terms, at most 1.
    fn share(&self, multiplier: f64, scaled_norm: f64) -> f64 {
        ratio(multiplier.abs() * scaled_norm, self.size).min(1.0)
    }
}

fn metric_terms(qp: &EpigraphQp<'_>, step: &Vector) -> Vector {
    match qp.metric {
        Metric::Dense(matrix) => matrix.abs() * step.abs(),
        _ => qp.metric.apply(step).abs(),
    }
}

fn cut_residual(qp: &EpigraphQp<'_>, solution: &QpSolution, floor: &SizeFloor) -> f64 {
    let mut worst = 0.0;
    let mut sum = -1.0;
    for ((slope, &offset), &pi) in qp.slopes.iter().zip(qp.offsets).zip(&solution.cut_multipliers) {
        let (value, terms) = value_and_terms(slope.iter(), &solution.step);
        let gap = value - offset - solution.epigraph;
        if gap.is_nan() {
            return f64::INFINITY;
        }
        let size = terms + offset.abs() + solution.epigraph.abs() + floor.cut_share * floor.norm(slope.iter());
        raise(&mut worst, ratio(gap.max(0.0), size));
        raise(&mut worst, pi.abs().min(1.0) * ratio((-gap).max(0.0), size));
        raise(&mut worst, -pi);
        sum += pi;
    }
    raise(&mut worst, f64::abs(sum));
    worst
}

fn row_residual(qp: &EpigraphQp<'_>, solution: &QpSolution, stationarity: &Stationarity, floor: &SizeFloor) -> f64 {
    let mut worst = 0.0;
    for (i, &mu) in solution.row_multipliers.iter().enumerate() {
        let row = qp.rows.row(i);
        let (value, terms) = value_and_terms(row.iter(), &solution.step);
        let norm = row.iter().zip(&stationarity.weights).map(|(a, w)| (a * w).abs()).fold(0.0, f64::max);
        let share = stationarity.share(mu, norm);
        raise(
            &mut worst,
            interval_residual(
                value,
                terms + floor.side_share * floor.norm(row.iter()),
                qp.row_lower[i],
                qp.row_upper[i],
                mu,
                share,
            ),
        );
    }
    worst
}

fn bound_residual(qp: &EpigraphQp<'_>, solution: &QpSolution, stationarity: &Stationarity, floor: &SizeFloor) -> f64 {
    let mut worst = 0.0;
    for (i, &nu) in solution.bound_multipliers.iter().enumerate() {
        let value = solution.step[i];
        let share = stationarity.share(nu, stationarity.weights[i]);
        let terms = value.abs() + floor.side_share * floor.weights[i];
        raise(&mut worst, interval_residual(value, terms, qp.lower[i], qp.upper[i], nu, share));
    }
    worst
}

/// Excess over either side, and complementarity with the side the multiplier names.
fn interval_residual(value: f64, terms: f64, lower: f64, upper: f64, multiplier: f64, share: f64) -> f64 {
    let excess = |gap: f64, side: f64| ratio(gap.max(0.0), terms + side.abs());
    let primal = excess(value - upper, upper).max(excess(lower - value, lower));
    if value.is_nan() || multiplier.is_nan() {
        return f64::INFINITY;
    }
    if multiplier == 0.0 {
        return primal;
    }
    let side = if multiplier > 0.0 { upper } else { lower };
    let slack = if side.is_finite() { ratio((side - value).abs(), terms + side.abs()) } else { 1.0 };
    primal.max(share * slack)
}

fn value_and_terms<'b>(normal: impl Iterator<Item = &'b f64>, step: &Vector) -> (f64, f64) {
    normal.zip(step.iter()).fold((0.0, 0.0), |(value, terms), (a, d)| (value + a * d, terms + (a * d).abs()))
}
