//! Settings of the curved model.

use crate::InputError;
use crate::checks::check_setting;
use serde::{Deserialize, Serialize};

/// Settings of the curved model, which bends every cut by the curvature of its smooth piece. The defaults were measured on the
/// collection of test problems (docs/bundle.md).
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct CurvedModelConfig {
    /// Number of variables above which the run does without the curved model, because the dense matrix of the model becomes too dear.
    /// Default 200.
    pub max_dimension: usize,
    /// Ratio of the smaller to the larger linearization error of a pair with the center from which on both points count as lying on one
    /// smooth piece; also for pairs of any two cuts whose errors are both negative. Default 0.6; in \[0, 1\]. Smaller sees curvature across kinks.
    pub same_piece_at_center: f64,
    /// The same for pairs of other cuts, whose curvature bends the model from afar. Default 0.995; in \[0, 1\].
    pub same_piece: f64,
    /// Least cosine between s, the difference of two points, and r = z − B s, where z is that of their subgradients, for a rank-one
    /// update of the curvature B. Default 1e-3; in (0, 1).
    pub least_cosine: f64,
    /// A cut enters the model if, at its own point, it lies above the quadratic of the center by this share of the sizes involved.
    /// Default 0.1; ≥ 0.
    pub contradiction: f64,
    /// Quadratic programs for one trial point at most; each takes the tangents of the pieces at the newest step. Default 30; ≥ 1.
    pub max_rounds: usize,
    /// The step is accurate enough once a round promises to lower the model by at most this share of its value. Default 1e-6; in \[0, 1).
    pub accuracy: f64,
    /// Running mean of the log ratio of the prediction errors, plain over curved, above which the curved model proposes.
    /// Default 1. Larger uses it less often.
    pub trust: f64,
    /// Share of the newest comparison in that mean. Default 0.5; in (0, 1].
    pub newest_share: f64,
    /// Largest absolute value of one log ratio. Default 2; > 0.
    pub max_log_ratio: f64,
    /// Prediction errors below this share of the changes that are compared count as equally good. Default 1e-2; > 0.
    pub error_floor: f64,
    /// The curved model proposes only what it promises more than this many small decreases for (the small decrease of the stopping
    /// tests): below that, the proof of the end needs cuts. Default 100; ≥ 1.
    pub least_promise: f64,
    /// Null steps of the curved model in a row after which it pauses. Default 3; ≥ 1.
    pub max_null_steps: usize,
    /// Weight beside B after such a pause, relative to that of the plain cuts. Default 10; > 0.
    pub weight_after_pause: f64,
    /// Longest pause in evaluations; pauses double from one with every failure. Default 64; ≥ 1.
    pub max_pause: usize,
}

impl Default for CurvedModelConfig {
    fn default() -> Self {
        Self {
            max_dimension: 200,
            same_piece_at_center: 0.6,
            same_piece: 0.995,
            least_cosine: 1e-3,
            contradiction: 0.1,
            max_rounds: 30,
            accuracy: 1e-6,
            trust: 1.0,
            newest_share: 0.5,
            max_log_ratio: 2.0,
            error_floor: 1e-2,
            least_promise: 100.0,
            max_null_steps: 3,
            weight_after_pause: 10.0,
            max_pause: 64,
        }
    }
}

impl CurvedModelConfig {
    /// Checks every field against its range.
    pub(crate) fn validate(&self) -> Result<(), InputError> {
        for (setting, value) in [
            ("curved_model.same_piece_at_center", self.same_piece_at_center),
            ("curved_model.same_piece", self.same_piece),
        ] {
            check_setting(setting, value, "0 ≤ x ≤ 1", (0.0..=1.0).contains(&value))?;
        }
        let cosine = self.least_cosine > 0.0 && self.least_cosine < 1.0;
        check_setting("curved_model.least_cosine", self.least_cosine, "0 < x < 1", cosine)?;
        let share = self.newest_share > 0.0 && self.newest_share <= 1.0;
        check_setting("curved_model.newest_share", self.newest_share, "0 < x ≤ 1", share)?;
        let accuracy = (0.0..1.0).contains(&self.accuracy);
        check_setting("curved_model.accuracy", self.accuracy, "0 ≤ x < 1", accuracy)?;
        let contradiction = self.contradiction >= 0.0 && self.contradiction.is_finite();
        check_setting("curved_model.contradiction", self.contradiction, "≥ 0, finite", contradiction)?;
        check_setting("curved_model.trust", self.trust, "a finite number", self.trust.is_finite())?;
        let promise = self.least_promise >= 1.0 && self.least_promise.is_finite();
        check_setting("curved_model.least_promise", self.least_promise, "≥ 1, finite", promise)?;
        for (setting, value) in [
            ("curved_model.max_log_ratio", self.max_log_ratio),
            ("curved_model.error_floor", self.error_floor),
            ("curved_model.weight_after_pause", self.weight_after_pause),
        ] {
            check_setting(setting, value, "> 0, finite", value > 0.0 && value.is_finite())?;
        }
        for (setting, value) in [
            ("curved_model.max_rounds", self.max_rounds),
            ("curved_model.max_null_steps", self.max_null_steps),
            ("curved_model.max_pause", self.max_pause),
        ] {
            check_setting(setting, value, "≥ 1", value >= 1)?;
        }
        Ok(())
    }
}
