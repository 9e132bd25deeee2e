//! Settings of exploration.

use crate::InputError;
use crate::checks::check_setting;
use serde::{Deserialize, Serialize};

/// Settings of exploration, which looks far along directions in which no subgradient changes once a run has stalled.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct ExplorationConfig {
    /// Number of variables above which the run does without exploration, because the dense matrix S becomes too dear. Default
    /// 200.
    pub max_dimension: usize,
    /// A run has stalled when the predicted decrease times the evaluations is below this share of the decrease so far. Default
    /// 0.01; > 0. Larger explores earlier.
    pub stall_share: f64,
    /// An exploration must promise this many times the decrease of the trial point that it replaces. Default 10; ≥ 1.
    pub min_gain: f64,
    /// Least factor by which the weight of an exploration lies below that of the run, and factor between the weights tried. Default
    /// 100; > 1.
    pub weight_factor: f64,
    /// Weights tried at one center. Default 2; ≥ 1.
    pub weights: usize,
    /// Least cosine of s and z, the differences of two points and of their subgradients, with which a pair enters the matrix
    /// S = Σ z zᵀ/⟨z, s⟩ of curvature seen. Default 1e-2; in (0, 1). A smaller cosine counts as this one.
    pub least_cosine: f64,
    /// Factor by which S shrinks after an exploration that kept its promise, as a good serious step does, and by which it grows again, up to
    /// its own size, after any other one. Default 0.5; in (0, 1].
    pub metric_decrease: f64,
    /// Longest pause in evaluations; pauses double from one with every failure. Default 64; ≥ 1.
    pub max_pause: usize,
}

impl Default for ExplorationConfig {
    fn default() -> Self {
        Self {
            max_dimension: 200,
            stall_share: 0.01,
            min_gain: 10.0,
            weight_factor: 100.0,
            weights: 2,
            least_cosine: 1e-2,
            metric_decrease: 0.5,
            max_pause: 64,
        }
    }
}

impl ExplorationConfig {
    /// Checks every field against its range.
    pub(crate) fn validate(&self) -> Result<(), InputError> {
        let stall = self.stall_share > 0.0 && self.stall_share.is_finite();
        check_setting("exploration.stall_share", self.stall_share, "> 0, finite", stall)?;
        let gain = self.min_gain >= 1.0 && self.min_gain.is_finite();
        check_setting("exploration.min_gain", self.min_gain, "≥ 1, finite", gain)?;
        let factor = self.weight_factor > 1.0 && self.weight_factor.is_finite();
        check_setting("exploration.weight_factor", self.weight_factor, "> 1, finite", factor)?;
        let cosine = self.least_cosine > 0.0 && self.least_cosine < 1.0;
        check_setting("exploration.least_cosine", self.least_cosine, "0 < x < 1", cosine)?;
        let decrease = self.metric_decrease > 0.0 && self.metric_decrease <= 1.0;
        check_setting("exploration.metric_decrease", self.metric_decrease, "0 < x ≤ 1", decrease)?;
        check_setting("exploration.weights", self.weights, "≥ 1", self.weights >= 1)?;
        check_setting("exploration.max_pause", self.max_pause, "≥ 1", self.max_pause >= 1)
    }
}
