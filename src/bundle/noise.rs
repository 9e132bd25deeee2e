//! Noise that the values of an oracle show.

use super::config::Convexity;
use super::proposers::proposal::Proposal;
use super::state::{BundleState, NOISE_MARGIN};
use crate::Evaluation;

/// Only steps shorter than this share of the length scale tell noise from slope: on longer ones, unseen steep pieces
/// pass for noise.
const NOISE_STEP: f64 = 1e-4;
/// A change of Θ is noise if it exceeds this many times ‖d‖ times the largest ‖g‖*, promised errors and rounding aside.
const STEEPNESS_MARGIN: f64 = 4.0;

/// Takes note of an accurate value: values that jump although the points almost coincide, and cuts above the values of
/// a convex function, are noise.
pub(super) fn watch(state: &mut BundleState, convexity: Convexity, proposal: &Proposal, evaluation: &Evaluation<()>) {
    let change = evaluation.value - state.center_value;
    let promised = evaluation.error_bound + state.center_error_bound() + state.rounding();
    if proposal.step_length <= NOISE_STEP * state.length_scale().max(state.first_step) {
        let steepest = state.bundle.dual_lengths().fold(state.norm.dual_length(&evaluation.subgradient), f64::max);
        if change.abs() > STEEPNESS_MARGIN * steepest * proposal.step_length + NOISE_MARGIN * promised {
            state.noise = state.noise.max(change.abs());
            // Pairs that seemed to prove Θ nonconvex may have shown noise; the others prove it again.
            state.nonconvex = false;
        }
    }
    if convexity == Convexity::Convex {
        let error = evaluation.subgradient.dot(&proposal.step) - change;
        let terms = evaluation.subgradient.abs().dot(&(proposal.trial.abs() + state.center.abs()));
        if error < -NOISE_MARGIN * (promised + 8.0 * f64::EPSILON * terms) {
            state.noise = state.noise.max(-error);
        }
    }
}
