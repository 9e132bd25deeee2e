//! Moves the multipliers to the equality solution of the working set, dropping members that would change sign.
//!
//! ```text
//! H d + Nᵀ λ = 0,  N d − s v = b,  sᵀ λ = 1          (N: active normals, b: the sides they are held at)
//! residuals   r = −(H d + Nᵀ λ),  ρ = b − N d + s v,  σ = 1 − sᵀ λ
//! correction  q = H⁻¹ r,  (ÃᵀÃ) δλ + s δ = N q − ρ,  sᵀ δλ = σ,  δv = δ + c² σ,  δd = q − H⁻¹ Nᵀ δλ
//! ```
//! The residuals are formed from the data of the QP at the current (d, v, λ), so every pass refines the one before. The
//! step d is a variable of its own, not a function of λ: with a small H the rounding of λ alone would move it by eps
//! |g| / H. The ratio test makes each pass an ascent of the dual objective: multipliers that are dual feasible stay so.

use crate::Vector;

use super::kernels::dot;
use super::sides::Normal;
use super::working_set::{Active, FirstBlock, Place, Side, WorkingSet};

/// Relative residual at which refinement stops.
const REFINED: f64 = 4e-16;
/// Largest number of passes spent on refinement after the last member has left.
const REFINEMENT_PASSES: usize = 5;
/// Residual of a stationarity equation, relative to its terms, that is rounding.
const ROUNDING: f64 = 2e-15;

/// Moves to the equality solution; on return all multipliers have their right sign.
pub(super) fn solve_equalities(set: &mut WorkingSet<'_>) {
    let mut full_passes = 0;
    let mut previous = f64::INFINITY;
    loop {
        set.measure();
        let residuals = Residuals::new(set);
        let stalled = residuals.size > 0.5 * previous || full_passes >= REFINEMENT_PASSES;
        if full_passes > 0 && (residuals.size <= REFINED || stalled) {
            break;
        }
        if full_passes > 0 {
            previous = residuals.size;
        }
        let correction = Correction::new(set, residuals);
        match correction.first_block(set) {
            Some((length, place)) => {
                correction.apply(set, length);
                set.release(place);
                full_passes = 0;
                previous = f64::INFINITY;
            }
            None => {
                correction.apply(set, 1.0);
                set.place_fixed();
                full_passes += 1;
            }
        }
    }
}

/// Residuals of the equality system at the current point.
struct Residuals {
    /// q = H⁻¹ r; for fixed coordinates the way to their bounds.
    step: Vector,
    /// ρ.
    sides: Vec<f64>,
    /// σ.
    deficit: f64,
    /// The largest entry of ρ and σ, each relative to its terms.
    size: f64,
}

impl Residuals {
    fn new(set: &WorkingSet<'_>) -> Self {
        let residual = |active: &Active| set.held_value(active) - set.value(active.member);
        let sides: Vec<f64> = set.general.iter().map(residual).collect();
        let deficit = 1.0 - set.cut_sum();
        let mut worst = if deficit.abs() > 4.0 * f64::EPSILON { deficit.abs() } else { 0.0 };
        for (active, residual) in set.general.iter().zip(&sides).filter(|(_, residual)| **residual != 0.0) {
            let size = if active.member.is_cut() {
                set.smallest_cut_size
            } else {
                set.size(active.member, set.held_value(active))
            };
            worst = worst.max(residual.abs() / size);
        }
        Self { step: step_residual(set), sides, deficit, size: worst }
    }
}

/// q: what the stationarity equations ask of d. Entries of r that are rounding count as zero.
fn step_residual(set: &WorkingSet<'_>) -> Vector {
    let mut sum = set.sides.qp.metric.apply(&set.step);
    let mut terms = sum.abs();
    for active in &set.general {
        set.sides.add_normal(sum.as_mut_slice(), active.multiplier, active.member);
        match set.sides.normal(active.member) {
            Normal::Gradient(gradient) => add_scaled_terms(terms.as_mut_slice(), active.multiplier, gradient),
            Normal::Axis(k) => terms[k] += active.multiplier.abs(),
        }
    }
    for (sum, terms) in sum.iter_mut().zip(&terms) {
        if sum.abs() <= ROUNDING * terms {
            *sum = 0.0;
        }
    }
    set.coordinates.minimiser(&mut sum);
    for (k, fixed) in set.fixed.iter().enumerate() {
        if let Some(active) = fixed {
            sum[k] = set.held_value(active) - set.step[k];
        }
    }
    sum
}

/// Changes that lead to the equality solution.
struct Correction {
    general: Vec<f64>,
    fixed: Vec<f64>,
    step: Vector,
    epigraph: f64,
}

impl Correction {
    fn new(set: &WorkingSet<'_>, residuals: Residuals) -> Self {
        let Residuals { mut step, sides: mut general, deficit, .. } = residuals;
        for (entry, active) in general.iter_mut().zip(&set.general) {
            *entry -= set.sides.product(active.member, step.as_slice());
        }
        let cut_entry = set.sides.cut_entry;
        let mut cut_row = set.factor.orthogonal_row(step.len());
        cut_row.iter_mut().for_each(|entry| *entry /= cut_entry);
        set.factor.solve_transposed(&mut general);
        let shift = -(deficit + dot(&cut_row, &general)) / dot(&cut_row, &cut_row);
        general.iter_mut().zip(&cut_row).for_each(|(y, h)| *y = -*y - h * shift);
        set.factor.solve(&mut general);
        keep_only_cut(&set.general, &mut general, deficit);
        let mut reply = Vector::zeros(step.len());
        set.add_normals(reply.as_mut_slice(), general.iter().copied());
        set.coordinates.minimiser(&mut reply);
        for (k, reply) in reply.iter().enumerate() {
            if set.fixed[k].is_none() {
                step[k] += reply;
            }
        }
        let fixed = fixed_correction(set, &general);
        Self { general, fixed, step, epigraph: shift + cut_entry * cut_entry * deficit }
    }

    /// Step length and place of the first multiplier that would change its sign.
    fn first_block(&self, set: &WorkingSet<'_>) -> Option<(f64, Place)> {
        let mut first = FirstBlock::default();
        for (position, (active, change)) in set.general.iter().zip(&self.general).enumerate() {
            first.consider(block_length(active, *change), Place::Column(position));
        }
        for (k, change) in self.fixed.iter().enumerate() {
            if let Some(active) = &set.fixed[k] {
                first.consider(block_length(active, *change), Place::Coordinate(k));
            }
        }
        first.0
    }

    /// Moves along the correction by a share of it.
    fn apply(&self, set: &mut WorkingSet<'_>, share: f64) {
        for (active, change) in set.general.iter_mut().zip(&self.general) {
            active.multiplier += share * change;
        }
        for (active, change) in set.fixed.iter_mut().zip(&self.fixed) {
            if let Some(active) = active {
                active.multiplier += share * change;
            }
        }
        set.step.axpy(share, &self.step, 1.0);
        set.epigraph += share * self.epigraph;
    }
}

/// The only cut held does not leave: its multiplier is one. Where v is large beside the square of its column, rounding
/// may change that multiplier by more than one. What the other changes owe to that rounding, later passes repair.
fn keep_only_cut(general: &[Active], changes: &mut [f64], deficit: f64) {
    let mut cuts = general.iter().zip(changes).filter(|(active, _)| active.member.is_cut());
    if let (Some((active, change)), None) = (cuts.next(), cuts.next())
        && block_length(active, *change).is_some()
    {
        *change = deficit;
    }
}

/// Changes of the multipliers of fixed coordinates, from their stationarity equations.
fn fixed_correction(set: &WorkingSet<'_>, general: &[f64]) -> Vec<f64> {
    if set.fixed.iter().all(Option::is_none) {
        return Vec::new();
    }
    let mut target = Vector::zeros(set.step.len());
    set.add_normals(target.as_mut_slice(), set.general.iter().zip(general).map(|(active, c)| active.multiplier + c));
    let one = |(k, fixed): (usize, &Option<Active>)| {
        fixed.as_ref().map_or(0.0, |active| {
            -(set.sides.qp.metric.diagonal_entry(k) * set.held_value(active) + target[k]) - active.multiplier
        })
    };
    set.fixed.iter().enumerate().map(one).collect()
}

/// Part of a change in [0, 1) after which the multiplier reaches zero, if it would pass it.
fn block_length(active: &Active, change: f64) -> Option<f64> {
    let sign = match active.side {
        Side::Upper => 1.0,
        Side::Lower => -1.0,
        Side::Both => return None,
    };
    let (start, change) = (sign * active.multiplier, sign * change);
    (start + change < 0.0).then(|| (start / -change).clamp(0.0, 1.0))
}

/// y += |factor · x|.
fn add_scaled_terms(y: &mut [f64], factor: f64, x: &[f64]) {
    for (y, x) in y.iter_mut().zip(x) {
        *y += (factor * x).abs();
    }
}
