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

use super::kernels::{add_scaled, dot};
use super::working_set::{Active, Member, Place, Side, WorkingSet};

/// Changes that lead to the equality solution.
struct Correction {
    general: Vec<f64>,
    fixed: Vec<f64>,
    step: Vector,
    epigraph: f64,
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

/// Relative residual at which refinement stops.
const REFINED: f64 = 4e-16;
/// Largest number of passes spent on refinement after the last member has left.
const REFINEMENT_PASSES: usize = 5;
/// Residual of a stationarity equation, relative to its terms, that is rounding.
const ROUNDING: f64 = 2e-15;

impl WorkingSet<'_> {
    /// Moves to the equality solution; on return all multipliers have their right sign.
    pub(super) fn solve_equalities(&mut self) {
        let mut full_passes = 0;
        let mut previous = f64::INFINITY;
        loop {
            self.measure();
            let residuals = self.residuals();
            let stalled = residuals.size > 0.5 * previous || full_passes >= REFINEMENT_PASSES;
            if full_passes > 0 && (residuals.size <= REFINED || stalled) {
                break;
            }
            if full_passes > 0 {
                previous = residuals.size;
            }
            let correction = self.correction(residuals);
            match self.first_block(&correction) {
                Some((length, place)) => {
                    self.advance(&correction, length);
                    self.release(place);
                    full_passes = 0;
                    previous = f64::INFINITY;
                }
                None => {
                    self.advance(&correction, 1.0);
                    self.place_fixed();
                    full_passes += 1;
                }
            }
        }
    }

    /// Sets d to the minimiser that belongs to the multipliers of the columns, v to 0.
    pub(super) fn place_step(&mut self) {
        let mut step = Vector::zeros(self.qp.dimension());
        for active in &self.general {
            self.add_gradient(step.as_mut_slice(), active.multiplier, active.member);
        }
        self.coordinates.minimiser(&mut step);
        self.step = step;
        self.epigraph = 0.0;
    }

    /// Puts fixed coordinates on their bounds without rounding.
    fn place_fixed(&mut self) {
        for k in 0..self.fixed.len() {
            if let Some(active) = self.fixed[k] {
                self.step[k] = self.held_value(&active);
            }
        }
    }

    fn add_gradient(&self, sum: &mut [f64], factor: f64, member: Member) {
        match (member, self.gradient(member)) {
            (_, Some(gradient)) => add_scaled(sum, factor, gradient),
            (Member::Bound(k), None) => sum[k] += factor,
            (_, None) => {}
        }
    }

    fn residuals(&self) -> Residuals {
        let sides: Vec<f64> =
            self.general.iter().map(|active| self.held_value(active) - self.value(active.member)).collect();
        let deficit = 1.0 - self.cut_sum();
        let mut worst = if deficit.abs() > 4.0 * f64::EPSILON { deficit.abs() } else { 0.0 };
        for (active, residual) in self.general.iter().zip(&sides).filter(|(_, residual)| **residual != 0.0) {
            let size = match active.member {
                Member::Cut(_) => self.smallest_cut_size,
                _ => self.size(active.member, self.held_value(active)),
            };
            worst = worst.max(residual.abs() / size);
        }
        Residuals { step: self.step_residual(), sides, deficit, size: worst }
    }

    /// q: what the stationarity equations ask of d. Entries of r that are rounding count as zero.
    fn step_residual(&self) -> Vector {
        let mut sum = self.qp.metric.apply(&self.step);
        let mut terms = sum.abs();
        for active in &self.general {
            self.add_gradient(sum.as_mut_slice(), active.multiplier, active.member);
            match (active.member, self.gradient(active.member)) {
                (_, Some(gradient)) => add_scaled_terms(terms.as_mut_slice(), active.multiplier, gradient),
                (Member::Bound(k), None) => terms[k] += active.multiplier.abs(),
                (_, None) => {}
            }
        }
        for (sum, terms) in sum.iter_mut().zip(&terms) {
            if sum.abs() <= ROUNDING * terms {
                *sum = 0.0;
            }
        }
        self.coordinates.minimiser(&mut sum);
        for (k, fixed) in self.fixed.iter().enumerate() {
            if let Some(active) = fixed {
                sum[k] = self.held_value(active) - self.step[k];
            }
        }
        sum
    }

    fn correction(&self, residuals: Residuals) -> Correction {
        let n = self.qp.dimension();
        let Residuals { mut step, sides: mut general, deficit, .. } = residuals;
        for (entry, active) in general.iter_mut().zip(&self.general) {
            *entry -= match (active.member, self.gradient(active.member)) {
                (_, Some(gradient)) => dot(gradient, step.as_slice()),
                (Member::Bound(k), None) => step[k],
                (_, None) => 0.0,
            };
        }
        let mut cut_row = self.factor.orthogonal_row(n);
        cut_row.iter_mut().for_each(|entry| *entry /= self.cut_entry);
        self.factor.solve_transposed(&mut general);
        let shift = -(deficit + dot(&cut_row, &general)) / dot(&cut_row, &cut_row);
        general.iter_mut().zip(&cut_row).for_each(|(y, h)| *y = -*y - h * shift);
        self.factor.solve(&mut general);
        self.keep_only_cut(&mut general, deficit);
        let mut reply = Vector::zeros(n);
        for (active, change) in self.general.iter().zip(&general) {
            self.add_gradient(reply.as_mut_slice(), *change, active.member);
        }
        self.coordinates.minimiser(&mut reply);
        for (k, reply) in reply.iter().enumerate() {
            if self.fixed[k].is_none() {
                step[k] += reply;
            }
        }
        let fixed = self.fixed_correction(&general);
        Correction { general, fixed, step, epigraph: shift + self.cut_entry * self.cut_entry * deficit }
    }

    /// The only cut held does not leave: its multiplier is one. Where v is large beside the square of its column,
    /// rounding may change that multiplier by more than one. What the other changes owe to that rounding, later passes
    /// repair.
    fn keep_only_cut(&self, changes: &mut [f64], deficit: f64) {
        let mut cuts = self.general.iter().zip(changes).filter(|(active, _)| matches!(active.member, Member::Cut(_)));
        if let (Some((active, change)), None) = (cuts.next(), cuts.next())
            && block_length(active, *change).is_some()
        {
            *change = deficit;
        }
    }

    /// Changes of the multipliers of fixed coordinates, from their stationarity equations.
    fn fixed_correction(&self, general: &[f64]) -> Vec<f64> {
        if self.fixed.iter().all(Option::is_none) {
            return Vec::new();
        }
        let mut target = Vector::zeros(self.qp.dimension());
        for (active, change) in self.general.iter().zip(general) {
            self.add_gradient(target.as_mut_slice(), active.multiplier + change, active.member);
        }
        let one = |(k, fixed): (usize, &Option<Active>)| {
            fixed.as_ref().map_or(0.0, |active| {
                -(self.qp.metric.diagonal_entry(k) * self.held_value(active) + target[k]) - active.multiplier
            })
        };
        self.fixed.iter().enumerate().map(one).collect()
    }

    /// Step length and place of the first multiplier that would change its sign.
    fn first_block(&self, correction: &Correction) -> Option<(f64, Place)> {
        let mut first: Option<(f64, Place)> = None;
        let mut consider = |active: &Active, change: f64, place: Place| {
            if let Some(length) = block_length(active, change)
                && first.is_none_or(|(shortest, _)| length < shortest)
            {
                first = Some((length, place));
            }
        };
        for (position, (active, change)) in self.general.iter().zip(&correction.general).enumerate() {
            consider(active, *change, Place::Column(position));
        }
        for (k, change) in correction.fixed.iter().enumerate() {
            if let Some(active) = &self.fixed[k] {
                consider(active, *change, Place::Coordinate(k));
            }
        }
        first
    }

    fn advance(&mut self, correction: &Correction, length: f64) {
        for (active, change) in self.general.iter_mut().zip(&correction.general) {
            active.multiplier += length * change;
        }
        for (active, change) in self.fixed.iter_mut().zip(&correction.fixed) {
            if let Some(active) = active {
                active.multiplier += length * change;
            }
        }
        self.step.axpy(length, &correction.step, 1.0);
        self.epigraph += length * correction.epigraph;
    }
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
