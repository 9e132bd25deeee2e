//! Moves the multipliers to the equality solution of the working set, dropping members that would change sign.
//!
//! ```text
//! A d − s v = b,  sᵀ λ = 1,  d = −H⁻¹ Aᵀ λ        (A: active normals, b: the sides they are held at)
//! correction:  (Ã Ãᵀ) δλ + s δ = −ρ,  sᵀ δλ = σ,  δv = δ + c² σ,     ρ = b − A d + s v,  σ = 1 − sᵀ λ
//! ```
//! The residuals ρ, σ are formed from the data of the QP at the current multipliers, so every pass refines the one before.
//! The ratio test makes each pass an ascent of the dual objective: multipliers that are dual feasible stay so.

use crate::Vector;

use super::kernels::{add_scaled, dot};
use super::working_set::{Active, Member, Place, Side, WorkingSet};

/// Changes that lead to the equality solution.
struct Correction {
    general: Vec<f64>,
    fixed: Vec<f64>,
    epigraph: f64,
}

/// Relative residual at which refinement stops.
const REFINED: f64 = 4e-16;
/// Passes spent on refinement after the last drop.
const REFINEMENT_PASSES: usize = 5;

impl WorkingSet<'_> {
    /// Moves to the equality solution; on return all multipliers have their right sign.
    pub(super) fn settle(&mut self) {
        let mut full_passes = 0;
        let mut previous = f64::INFINITY;
        loop {
            let sum = self.gradient_sum();
            self.place_step(&sum);
            let (residuals, deficit, size) = self.residuals();
            let stalled = size > 0.5 * previous || full_passes >= REFINEMENT_PASSES;
            if full_passes > 0 && (size <= REFINED || stalled) {
                break;
            }
            if full_passes > 0 {
                previous = size;
            }
            let correction = self.correction(&sum, residuals, deficit);
            match self.first_block(&correction) {
                Some((length, place)) => {
                    self.advance(&correction, length);
                    self.release(place);
                    full_passes = 0;
                    previous = f64::INFINITY;
                }
                None => {
                    self.advance(&correction, 1.0);
                    full_passes += 1;
                }
            }
        }
    }

    /// Σ λ · normal over the columns, in the variables d.
    fn gradient_sum(&self) -> Vector {
        let mut sum = Vector::zeros(self.qp.dimension());
        for active in &self.general {
            self.add_gradient(sum.as_mut_slice(), active.multiplier, active.member);
        }
        sum
    }

    fn add_gradient(&self, sum: &mut [f64], factor: f64, member: Member) {
        match (member, self.gradient(member)) {
            (_, Some(gradient)) => add_scaled(sum, factor, gradient),
            (Member::Bound(k), None) => sum[k] += factor,
            (_, None) => {}
        }
    }

    /// d of the current multipliers; fixed coordinates at their bounds.
    fn place_step(&mut self, sum: &Vector) {
        self.step.copy_from(sum);
        self.coordinates.minimiser(&mut self.step);
        for k in 0..self.fixed.len() {
            if let Some(active) = self.fixed[k] {
                self.step[k] = self.held_value(&active);
            }
        }
    }

    /// ρ, σ, and the largest of them relative to its terms.
    fn residuals(&self) -> (Vec<f64>, f64, f64) {
        let mut worst = 0.0_f64;
        let residuals = self
            .general
            .iter()
            .map(|active| {
                let held = self.held_value(active);
                let residual = held - self.value(active.member);
                if residual != 0.0 {
                    worst = worst.max(residual.abs() / self.terms(active.member, held));
                }
                residual
            })
            .collect();
        let deficit = 1.0 - self.cut_sum();
        (residuals, deficit, worst.max(deficit.abs()))
    }

    fn correction(&self, sum: &Vector, residuals: Vec<f64>, deficit: f64) -> Correction {
        let n = self.qp.dimension();
        let mut cut_row = self.factor.orthogonal_row(n);
        cut_row.iter_mut().for_each(|entry| *entry /= self.cut_entry);
        let mut general = residuals;
        self.factor.solve_transposed(&mut general);
        let shift = -(deficit + dot(&cut_row, &general)) / dot(&cut_row, &cut_row);
        general.iter_mut().zip(&cut_row).for_each(|(y, h)| *y = -*y - h * shift);
        self.factor.solve(&mut general);
        let fixed = self.fixed_correction(sum, &general);
        Correction { general, fixed, epigraph: shift + self.cut_entry * self.cut_entry * deficit }
    }

    /// Changes of the multipliers of fixed coordinates, from their stationarity equations.
    fn fixed_correction(&self, sum: &Vector, general: &[f64]) -> Vec<f64> {
        if self.fixed.iter().all(Option::is_none) {
            return Vec::new();
        }
        let mut target = sum.clone();
        for (active, change) in self.general.iter().zip(general) {
            self.add_gradient(target.as_mut_slice(), *change, active.member);
        }
        let one = |(k, fixed): (usize, &Option<Active>)| {
            fixed.as_ref().map_or(0.0, |active| {
                -(self.qp.metric.diagonal_entry(k) * self.step[k] + target[k]) - active.multiplier
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
