//! The next weight of the plain cuts.
//!
//! ```text
//! u_int = 2u(1 − (Θ(y) − Θ(x̂))/v)                 minimiser of the parabola through both values and the slope v
//! serious:  u ← max(u_int, u/10)   if the step before was serious too and Θ(y) − Θ(x̂) ≤ m_R v;   u/2 after three before this one
//!           where u is to fall below its floor after such a step, the floor falls to u
//! null:     u ← min(u_int, 10u)   if the new error exceeds max(ε_v, 2|v|), after four before this one
//!           u ← 2u                if ẽ > 10 u‖d‖², after three before this one, for many variables, and if Θ looks convex
//! ```
//! v = −predicted decrease; steps count since the weight last changed, the one that changed it included.
//! Reference: \[Kiwiel1990\] (proximity control); SS/NS tests: \[SchrammZowe1992\].

use super::model::MANY_VARIABLES;
use crate::bundle::proposers::proposal::Proposal;
use crate::bundle::state::{BundleState, NOISE_MARGIN};
use crate::bundle::trial::{Comparison, Trial};
use crate::report::Origin;

/// The memory of the steps of the plain cuts that sets the next weight.
#[derive(Debug, Clone, Default)]
pub(crate) struct WeightRule {
    /// Serious steps in a row (> 0), or minus the null steps in a row (< 0), counted from the one that last changed the
    /// weight.
    streak: i64,
    /// ε_v, an estimate of how far the model varies; none means unlimited.
    variation: Option<f64>,
}

impl WeightRule {
    /// Takes note that the oracle failed at a trial point of any proposer.
    pub(super) fn shorten(&mut self, state: &mut BundleState, proposal: &Proposal) {
        if proposal.origin == Origin::Cuts {
            self.streak = -1;
            state.set_weight(10.0 * proposal.weight);
        }
    }

    /// Sets the next weight, after trial points of the plain cuts only; the center has not moved yet.
    pub(super) fn learn(&mut self, state: &mut BundleState, trial: &Trial<'_>) {
        if trial.proposal.origin != Origin::Cuts || trial.proposal.restores {
            return;
        }
        if trial.serious {
            self.after_serious(state, &trial.comparison);
        } else {
            self.after_null(state, trial);
        }
    }

    /// Sets the weight after a serious step, before the center moves.
    fn after_serious(&mut self, state: &mut BundleState, comparison: &Comparison) {
        let u = state.weight;
        let mut changed = false;
        if self.streak > 0 && comparison.is_good() {
            let next = interpolated_weight(comparison, u).max(u / 10.0).min(u);
            if -comparison.change > NOISE_MARGIN * state.noise + state.rounding() {
                state.lower_floor(next);
            }
            changed = state.set_weight(next);
        } else if self.streak > 2 {
            changed = state.set_weight(u / 2.0);
        }
        self.streak = if changed { 1 } else { (self.streak + 1).max(1) };
        self.variation = self.variation.map(|variation| variation.max(-2.0 * comparison.model_change));
    }

    /// Sets the weight after a null step.
    fn after_null(&mut self, state: &mut BundleState, trial: &Trial<'_>) {
        let comparison = &trial.comparison;
        let u = state.weight;
        let seen = trial.proposal.aggregate_norm + trial.proposal.cut_error;
        let variation = self.variation.map_or(seen, |variation| variation.min(seen));
        self.variation = Some(variation);
        // For few variables the cuts around the center are complete before their errors matter.
        let may_rest_on_errors = !state.nonconvex && self.streak < -2 && state.center.len() >= MANY_VARIABLES;
        let changed = if error(comparison) > variation.max(-2.0 * comparison.model_change) && self.streak < -3 {
            state.set_weight(interpolated_weight(comparison, u).min(10.0 * u).max(u))
        } else {
            may_rest_on_errors && rests_on_errors(trial.proposal) && state.set_weight(2.0 * u)
        };
        self.streak = if changed { -1 } else { (self.streak - 1).min(-1) };
    }
}

/// Whether the predicted decrease −v = u‖d‖² + ẽ is nearly all error: the cuts were then taken too far away to describe
/// Θ around the center, where a larger weight looks. Cuts that were made convex carry errors of another kind.
fn rests_on_errors(proposal: &Proposal) -> bool {
    proposal.aggregate_error > 10.0 * proposal.aggregate_norm * proposal.step_length
}

/// The weight at which the parabola through both values with the predicted slope has its minimum at the trial point;
/// the weight itself where neither Θ nor the model has changed.
fn interpolated_weight(comparison: &Comparison, weight: f64) -> f64 {
    let ratio = comparison.change / comparison.model_change;
    if ratio.is_nan() { weight } else { 2.0 * weight * (1.0 - ratio) }
}

/// The linearization error of the new cut at the center before the step.
fn error(comparison: &Comparison) -> f64 {
    comparison.slope - comparison.objective_change
}
