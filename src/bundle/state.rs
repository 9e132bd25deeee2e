//! Everything a run carries from step to step.

use super::cut::{Bundle, Cut};
use super::norm::ScaledNorm;
use crate::report::{Counts, IterationRecord};
use crate::{BundleTrustConfig, Vector};

/// State of a run between two steps. The weight is u = 1/t of the trust parameter t.
#[derive(Debug, Clone)]
pub(crate) struct State {
    pub norm: ScaledNorm,
    pub start: Vector,
    pub start_value: f64,
    pub center: Vector,
    pub center_value: f64,
    /// The cut of the center; never deleted.
    pub center_id: u64,
    pub bundle: Bundle,
    pub next_id: u64,
    pub weight: f64,
    pub first_weight: f64,
    pub first_step: f64,
    /// Serious steps in a row with an unchanged weight (> 0), or null steps (< 0), since the weight last changed.
    pub streak: i64,
    /// ε_v, an estimate of how far the model varies; none means unlimited.
    pub variation: Option<f64>,
    pub restarts: usize,
    /// Accuracy with which the center was asked for.
    pub center_accuracy: f64,
    /// Whether a pair of cuts ever proved Θ nonconvex.
    pub nonconvex: bool,
    /// Level of noise seen or promised, in units of Θ.
    pub noise: f64,
    /// Failed evaluations in a row.
    pub failures: usize,
    pub counts: Counts,
    pub history: Vec<IterationRecord>,
}

impl State {
    /// The size of Θ that relative tolerances refer to.
    pub(crate) fn value_scale(&self, config: &BundleTrustConfig) -> f64 {
        let automatic = || self.center_value.abs().max(1e-5 * (self.start_value - self.center_value).abs());
        config.objective_scale.unwrap_or_else(automatic)
    }

    /// Rounding level of the model: what differences of the values behind its active cuts cannot resolve.
    pub(crate) fn rounding(&self) -> f64 {
        let cuts = self.bundle.cuts().iter().filter(|cut| !cut.is_idle());
        let sizes =
            cuts.map(|cut| cut.value.abs().max(self.norm.dual_length(&cut.subgradient) * self.norm.length(&cut.point)));
        8.0 * f64::EPSILON * sizes.fold(self.center_value.abs(), f64::max)
    }

    /// The length that relative distances refer to.
    pub(crate) fn length_scale(&self) -> f64 {
        let travelled = self.norm.squared_distance(&self.center, &self.start).sqrt();
        self.norm.length(&self.center).max(travelled).max(self.norm.length(&self.start))
    }

    /// Linearization errors of all cuts at the center, in their order.
    pub(crate) fn errors_at_center(&self) -> Vec<f64> {
        let error = |cut: &Cut| {
            if cut.id == self.center_id { 0.0 } else { cut.linearization_error(&self.center, self.center_value) }
        };
        self.bundle.cuts().iter().map(error).collect()
    }

    /// Error that the oracle promised for the center's value.
    pub(crate) fn center_error_bound(&self) -> f64 {
        self.bundle.cut(self.center_id).map_or(0.0, |cut| cut.error_bound)
    }

    /// Sets the weight within its floor and ceiling; returns whether it changed.
    pub(crate) fn set_weight(&mut self, weight: f64, config: &BundleTrustConfig) -> bool {
        let (floor, ceiling) = (self.first_weight / config.weight_range, self.first_weight * config.weight_range);
        let weight = weight.clamp(floor, ceiling);
        let changed = weight != self.weight;
        self.weight = weight;
        changed
    }
}
