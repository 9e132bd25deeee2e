//! Everything a run carries from step to step.

use super::constrained::Constraints;
use super::cut::{Cut, MAX_RELATIVE_SLOPE};
use super::kept_cuts::Bundle;
use super::norm::ScaledNorm;
use super::seen::Seen;
use crate::report::{Counts, IterationRecord};
use crate::{Accuracy, BundleTrustConfig, Evaluation, Vector};
use std::cell::RefCell;
use std::rc::Rc;

/// Promised errors and rounding explain a change of Θ, or a cut above a convex Θ, up to this many times their sum; more
/// is noise.
pub(crate) const NOISE_MARGIN: f64 = 8.0;

/// Range of the weight around its first value; good steps lower the floor further.
const WEIGHT_RANGE: f64 = 1e10;
/// The floor of the weight never falls below this: a weight of zero gives no step.
pub(crate) const LEAST_WEIGHT: f64 = f64::MIN_POSITIVE / f64::EPSILON;

/// Cuts in the bundle beyond the number of variables, unless `bundle_size` is set. With 8 or 50 of them, the collection
/// takes 6 % more evaluations.
const EXTRA_CUTS: usize = 15;
/// Largest number of cuts, unless `bundle_size` is set: it bounds memory and time of a subproblem.
const MAX_CUTS: usize = 500;

/// How large the variables are at a center.
#[derive(Debug)]
pub(crate) struct Lengths {
    pub size: Vector,
    pub reach: Vector,
    /// ‖size‖².
    pub squared: f64,
}

/// The scale of a composite Θ = h(c) at a center, from its outputs c.
#[derive(Debug, Clone)]
pub(crate) struct OutputScales {
    /// Σ_i |w_i| |G_ik| for every variable k: the terms that cancel in Gᵀw.
    pub slopes: Vector,
    /// The larger of h(c ± |G| reach), minus h(c); 0 where h gives no such number.
    pub within_reach: f64,
}

/// BundleState of a run between two steps. The weight is u = 1/t of the trust parameter t.
#[derive(Debug, Clone)]
pub(crate) struct BundleState {
    pub norm: ScaledNorm,
    pub start: Vector,
    pub start_value: f64,
    pub center: Vector,
    pub center_value: f64,
    /// The cut of the center; never deleted.
    pub center_id: u64,
    pub bundle: Bundle,
    pub seen: Seen,
    /// The lowest of the null steps' points with less than Θ(x̂) at the time.
    pub lowest: Option<Cut>,
    pub next_id: u64,
    pub weight: f64,
    pub first_weight: f64,
    /// What is left of the floor of the weight: beside a pole, the first subgradient can be 1e16 times as long as those
    /// at the minimum.
    pub floor_share: f64,
    pub first_step: f64,
    /// Relative accuracy with which the center was last asked for.
    pub center_accuracy: f64,
    /// Whether a pair of cuts ever proved Θ nonconvex.
    pub nonconvex: bool,
    /// Level of noise seen in values and cuts, in units of Θ.
    pub noise: f64,
    /// Failed evaluations in a row.
    pub failures: usize,
    /// Length of the next step at most: half of the last one that failed; none after an answer at a trial point.
    pub longest_step: Option<f64>,
    /// Trial points in a row that were known, so that nothing was evaluated.
    pub known_trials: usize,
    pub counts: Counts,
    pub history: Vec<IterationRecord>,
    /// The scale of Θ from its outputs, if these are known at the center.
    pub output_scales: Option<OutputScales>,
    /// The evaluations of the nonlinear constraints; none without such constraints.
    pub constraints: Option<Box<Constraints>>,
    /// The lengths that belong to a center, with its identity.
    pub lengths: RefCell<Option<(u64, Rc<Lengths>)>>,
}

impl BundleState {
    /// The size of Θ beside which linearization errors count as rounding: |Θ(x̂)|, but at least 1e-5 of the decrease so
    /// far. The stopping tests refer to `natural_scale` instead.
    pub(crate) fn value_scale(&self, config: &BundleTrustConfig) -> f64 {
        let automatic = || self.center_value.abs().max(1e-5 * (self.start_value - self.center_value).abs());
        config.objective_scale.unwrap_or_else(automatic)
    }

    /// Rounding level of the model: what differences of the values behind its active cuts cannot resolve.
    pub(crate) fn rounding(&self) -> f64 {
        let cuts = self.bundle.cuts().iter().zip(self.bundle.terms()).filter(|(cut, _)| cut.is_active());
        let sizes = cuts.map(|(cut, terms)| cut.value.abs().max(terms));
        8.0 * f64::EPSILON * sizes.fold(self.center_value.abs(), f64::max)
    }

    /// The length that relative step lengths refer to: the largest of ‖x̂‖, ‖x̂ − x⁰‖ and ‖x⁰‖.
    pub(crate) fn length_scale(&self) -> f64 {
        let travelled = self.norm.squared_distance(&self.center, &self.start).sqrt();
        self.norm.length(&self.center).max(travelled).max(self.norm.length(&self.start))
    }

    /// Linearization errors of all cuts at the center and their squared distances from it, in their order. `center` is
    /// the position of the center's cut.
    pub(crate) fn errors_at_center(&self, center: usize) -> (Vec<f64>, Vec<f64>) {
        let pairs = self.bundle.pairs();
        let error = |i: usize| {
            if i == center { 0.0 } else { self.bundle.pair_error(i, center) }
        };
        let count = self.bundle.cuts().len();
        ((0..count).map(error).collect(), (0..count).map(|i| pairs.distance(i, center)).collect())
    }

    /// Error that the oracle promised for the center's value.
    pub(crate) fn center_error_bound(&self) -> f64 {
        self.bundle.cut(self.center_id).map_or(0.0, |cut| cut.error_bound)
    }

    /// Least and largest weight. The least one falls as the run comes to lengths beyond that of its first step, which
    /// is arbitrary where it starts at zero.
    pub(crate) fn weight_limits(&self) -> (f64, f64) {
        let share = self.first_step / self.first_step.max(self.length_scale());
        let floor = self.floor_share * share * self.first_weight / WEIGHT_RANGE;
        let ceiling = self.first_weight * WEIGHT_RANGE;
        (floor.max(LEAST_WEIGHT).min(ceiling), ceiling)
    }

    /// Lowers the floor towards a weight that a good step asks for, as far as one step may lower the weight.
    pub(crate) fn lower_floor(&mut self, weight: f64) {
        self.floor_share *= (weight / self.weight_limits().0).clamp(0.1, 1.0);
    }

    /// Sets the weight within its floor and ceiling; returns whether it changed.
    pub(crate) fn set_weight(&mut self, weight: f64) -> bool {
        let (floor, ceiling) = self.weight_limits();
        let weight = weight.clamp(floor, ceiling);
        let changed = weight != self.weight;
        self.weight = weight;
        changed
    }

    /// The largest ‖g‖* that can be held beside the subgradients known; none where all of them are zero.
    pub(crate) fn longest_slope(&self) -> Option<f64> {
        let longest = self.bundle.dual_lengths().fold(self.first_weight * self.first_step, f64::max);
        (longest > 0.0).then_some(MAX_RELATIVE_SLOPE * longest)
    }

    /// Adds the cut of an evaluation to the bundle.
    pub(crate) fn add_cut(
        &mut self,
        config: &BundleTrustConfig,
        point: &Vector,
        evaluation: &Evaluation<()>,
        certified: bool,
    ) {
        let size = config.bundle_size.unwrap_or_else(|| (point.len() + EXTRA_CUTS).min(MAX_CUTS));
        // The objective of an infeasible start may lie below all that is feasible.
        let counts = self.constraints.is_some() || evaluation.value <= self.start_value;
        self.seen.add(point, evaluation.value, &evaluation.subgradient, counts);
        if let (Some(constraints), Some(found)) = (&mut self.constraints, &evaluation.constraints) {
            constraints.add(point, evaluation.value, found, &self.norm);
        }
        self.bundle.make_room(size, self.center_id, &mut self.next_id, &self.norm);
        let cut = Cut {
            id: self.next_id,
            point: point.clone(),
            radius: 0.0,
            value: evaluation.value,
            subgradient: evaluation.subgradient.clone(),
            error_bound: evaluation.error_bound,
            certified,
            multiplier: 0.0,
            idle: 0,
        };
        self.bundle.push(cut, &self.norm);
        self.next_id += 1;
    }

    /// Moves the center to the point of the newest cut.
    pub(crate) fn move_center(&mut self, accuracy: Accuracy) {
        if let Some(newest) = self.bundle.cuts().last() {
            (self.center, self.center_value, self.center_id) = (newest.point.clone(), newest.value, newest.id);
            self.center_accuracy = accuracy.tolerance();
            if let Some(constraints) = &mut self.constraints {
                constraints.move_center(&self.norm);
            }
        }
    }

    /// Remembers the newest cut if it is the lowest so far and lies below the center.
    pub(crate) fn remember_lowest(&mut self) {
        if self.constraints.is_some() {
            return;
        }
        let lowest = self.lowest.as_ref().map_or(self.center_value, Cut::highest_value).min(self.center_value);
        let newest = self.bundle.cuts().last().filter(|cut| cut.highest_value() < lowest);
        self.lowest = newest.cloned().or(self.lowest.take());
    }

    /// v at the center.
    pub(crate) fn violation(&self) -> f64 {
        self.constraints.as_ref().map_or(0.0, |constraints| constraints.center_violation())
    }

    /// Whether the center satisfies the nonlinear constraints.
    pub(crate) fn is_feasible(&self) -> bool {
        self.constraints.as_ref().is_none_or(|constraints| constraints.center_excess() <= 1.0)
    }

    /// P at the center.
    pub(crate) fn merit(&self) -> f64 {
        self.center_value
            + self.constraints.as_ref().map_or(0.0, |constraints| constraints.penalty * constraints.center_violation())
    }

    /// Keeps the linearizations of the constraints at a point that has not become the center.
    pub(crate) fn reject_constraints(&mut self) {
        if let Some(constraints) = &mut self.constraints {
            constraints.reject(&self.norm);
        }
    }

    /// Moves the center to the best point that the constraints know.
    pub(crate) fn move_to_best(&mut self) {
        let Some(constraints) = &mut self.constraints else { return };
        constraints.move_to_best();
        (self.center, self.center_value) = (constraints.best().point.clone(), constraints.best().objective);
        (self.center_id, self.next_id) = (self.next_id, self.next_id + 1);
    }

    /// The highest value at the start and in the bundle. The scale of Θ refers to it rather than to the highest value
    /// of the run: one value far above all that the bundle keeps would make large decreases count as small.
    pub(crate) fn highest_kept(&self) -> f64 {
        self.bundle.cuts().iter().map(|cut| cut.value).fold(self.start_value, f64::max)
    }

    /// The decrease of the run from a value to the center; from the highest merit seen where there are constraints.
    pub(crate) fn drop_from(&self, value: f64) -> f64 {
        match &self.constraints {
            Some(constraints) => constraints.merit_drop(),
            None => (value - self.center_value).max(0.0),
        }
    }

    /// Moves the center to the lowest point evaluated, if this is another one.
    pub(crate) fn move_to_lowest(&mut self) -> bool {
        let below = self.center_value - self.center_error_bound();
        let Some(lowest) = self.lowest.take().filter(|lowest| lowest.highest_value() < below) else { return false };
        (self.center, self.center_value, self.center_id) = (lowest.point.clone(), lowest.value, lowest.id);
        if self.bundle.cut(lowest.id).is_none() {
            self.bundle.push(lowest, &self.norm);
        }
        true
    }
}
