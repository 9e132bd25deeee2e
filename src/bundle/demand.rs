//! The accuracy that the engine asks of the oracle.

use super::config::{AccuracyPolicy, BundleTrustConfig};
use super::state::BundleState;
use crate::Accuracy;

/// A center that is evaluated again is asked for this share of the accuracy that would just do. With a tenth or a third
/// of it, the runs with accuracy on demand cost 2 % more.
const REFINEMENT_SHARE: f64 = 0.03;

/// The accuracy with which a trial point is evaluated that promises a decrease.
pub(super) fn for_trial(state: &BundleState, config: &BundleTrustConfig, predicted_decrease: f64) -> Accuracy {
    let AccuracyPolicy::OnDemand { tightest, coarsest, factor } = config.accuracy else { return Accuracy::TIGHTEST };
    let size = state.center_value.abs().max(f64::MIN_POSITIVE);
    let tolerance = (factor * predicted_decrease / size).clamp(tightest, coarsest);
    Accuracy::relative(tolerance).unwrap_or(Accuracy::TIGHTEST)
}

/// The accuracy with which the center is evaluated again.
pub(super) fn for_center(state: &BundleState, config: &BundleTrustConfig, predicted_decrease: f64) -> Accuracy {
    for_trial(state, config, REFINEMENT_SHARE * predicted_decrease)
}

/// Whether the promised error of the center's value hides the predicted decrease, and a better value can be asked for.
pub(super) fn center_is_too_coarse(state: &BundleState, config: &BundleTrustConfig, predicted_decrease: f64) -> bool {
    let AccuracyPolicy::OnDemand { factor, .. } = config.accuracy else { return false };
    let wanted = for_center(state, config, predicted_decrease).tolerance();
    state.center_error_bound() > factor * predicted_decrease && wanted < 0.5 * state.center_accuracy
}

/// The error up to which a known value at a trial point tells all that an evaluation would tell.
pub(super) fn largest_error(config: &BundleTrustConfig, predicted_decrease: f64) -> f64 {
    match config.accuracy {
        AccuracyPolicy::Tightest => f64::INFINITY,
        AccuracyPolicy::OnDemand { factor, .. } => factor * predicted_decrease,
    }
}
