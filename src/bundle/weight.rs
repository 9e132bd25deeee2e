//! Serious or null, and the next weight.
//!
//! ```text
//! serious (SS):   Θ(y) − Θ(x̂) ≤ m_S v           v = −predicted decrease
//! u_int = 2u(1 − (Θ(y) − Θ(x̂))/v)                 minimiser of the parabola through both values and the slope v
//! serious:  u ← max(u_int, u/8)   if the weight is not fresh and Θ(y) − Θ(x̂) ≤ m_R v;   u/2 after three in a row
//! null:     u ← min(u_int, 10u)   if the new error exceeds max(ε_v, 2|v|) after three in a row
//! ```
//! Reference: \[Kiwiel1990\] (proximity control); SS/NS tests: \[SchrammZowe1992\].

use super::curvature::{Origin, missing_weight};
use super::state::State;
use super::subproblem::Proposal;
use crate::{BundleTrustConfig, Vector};

/// Comparison of a trial point with what the model said.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Comparison {
    /// Θ(y) − Θ(x̂).
    pub change: f64,
    /// ⟨g, d⟩ with the subgradient at the trial point.
    pub slope: f64,
    /// v = −predicted decrease.
    pub model_change: f64,
}

impl Comparison {
    pub(crate) fn new(state: &State, proposal: &Proposal, value: f64, subgradient: &Vector) -> Self {
        Self {
            change: value - state.center_value,
            slope: subgradient.dot(&proposal.step),
            model_change: -proposal.predicted_decrease,
        }
    }

    /// Test SS(i): enough of the predicted decrease came true. Rounding in the difference of the values is not held
    /// against the step only where the values do fall.
    pub(crate) fn is_serious(&self, config: &BundleTrustConfig) -> bool {
        self.change < 0.0 && self.change <= config.serious_fraction * self.model_change
    }

    /// The new cut's linearization error at the old center.
    fn error(&self) -> f64 {
        self.slope - self.change
    }

    fn interpolated_weight(&self, weight: f64) -> f64 {
        2.0 * weight * (1.0 - self.change / self.model_change)
    }
}

/// Weight after a serious step; call before the center moves.
pub(crate) fn after_serious(
    state: &mut State,
    config: &BundleTrustConfig,
    proposal: &Proposal,
    comparison: &Comparison,
) {
    if proposal.origin != Origin::Plain {
        return curved_after_serious(state, config, proposal, comparison);
    }
    let u = state.weight;
    let mut changed = false;
    if state.streak > 0 && comparison.change <= config.good_fraction * comparison.model_change {
        let next = comparison.interpolated_weight(u).max(u / config.weight_decrease).min(u);
        changed = state.set_weight(next, config);
    } else if state.streak > 2 {
        changed = state.set_weight(u / 2.0, config);
    }
    state.streak = if changed { 1 } else { (state.streak + 1).max(1) };
    state.variation = state.variation.map(|variation| variation.max(-2.0 * comparison.model_change));
}

/// Weight after a null step.
pub(crate) fn after_null(state: &mut State, config: &BundleTrustConfig, proposal: &Proposal, comparison: &Comparison) {
    if proposal.origin != Origin::Plain {
        return curved_after_null(state, config, proposal, comparison);
    }
    let u = state.weight;
    let seen = proposal.aggregate_norm + proposal.cut_error;
    let variation = state.variation.map_or(seen, |variation| variation.min(seen));
    state.variation = Some(variation);
    let error = comparison.error();
    let interpolated = comparison.interpolated_weight(u);
    if is_concave_ray(state, config, comparison) {
        let factor = (interpolated / u).clamp(2.0, config.weight_increase);
        state.set_weight(u * factor, config);
        state.streak = -1;
    } else if error > variation.max(-2.0 * comparison.model_change) && state.streak < -3 {
        let changed = state.set_weight(interpolated.min(config.weight_increase * u).max(u), config);
        state.streak = if changed { -1 } else { (state.streak - 1).min(-1) };
    } else {
        state.streak = (state.streak - 1).min(-1);
    }
}

/// The weight beside B after a serious step: down to what the observed change asks for. Explorations leave it alone.
fn curved_after_serious(state: &mut State, config: &BundleTrustConfig, proposal: &Proposal, comparison: &Comparison) {
    let u = state.curvature.weight;
    if proposal.origin == Origin::Curved && comparison.change <= config.good_fraction * comparison.model_change {
        let next = missing_weight(comparison, proposal.step_length).max(u / config.weight_decrease).min(u);
        state.curvature.weight = next.max(state.first_weight / config.weight_range);
    }
}

/// The same after a null step: up at once, as the next matrix B knows the new point already.
fn curved_after_null(state: &mut State, config: &BundleTrustConfig, proposal: &Proposal, comparison: &Comparison) {
    let u = state.curvature.weight;
    if proposal.origin == Origin::Curved {
        let range = (2.0_f64.min(config.weight_increase) * u, config.weight_increase * u);
        let next = missing_weight(comparison, proposal.step_length).clamp(range.0, range.1);
        state.curvature.weight = next.min(state.first_weight * config.weight_range);
    }
}

/// Test NS(iii) failing: Θ bends down along the step, and the new cut, made convex, would not improve the model.
fn is_concave_ray(state: &State, config: &BundleTrustConfig, comparison: &Comparison) -> bool {
    let error = comparison.error();
    let bent = error < -1e-10 * state.value_scale(config) - state.noise;
    let repaired = error.abs();
    bent && comparison.slope - repaired < 0.5 * comparison.model_change
}
