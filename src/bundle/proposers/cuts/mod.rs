//! The plain cuts: every run has this proposer, and stopping test and certificate rest on it.
//!
//! ```text
//! min over (d, v)  v + u‖d‖²/2,   ⟨h_i, d⟩ − a_i ≤ v,   x̂ + d ∈ U
//! z̃ = Σ λ_i h_i + Aᵀμ + ν = −u W d      aggregate subgradient, constraints included
//! ẽ = −v − u‖d‖² = Σ λ_i a_i + slack of the active constraints ≥ 0      aggregate error
//! ```

pub(crate) mod model;
mod weight;

use super::aggregate::slack_error;
use super::proposal::{Proposal, SubproblemError};
use super::proposer::{Position, Trial};
use super::subproblem::{self, Cuts};
use crate::bundle::config::BundleTrustConfig;
use crate::bundle::norm::WeightedMetric;
use crate::bundle::state::State;
use crate::qp::QpSolution;
use crate::report::Origin;
use crate::{Polyhedron, Vector};
use model::{MANY_VARIABLES, Model};

/// The trial point of the cutting-plane model with the weight of the run.
///
/// # Errors
/// [`SubproblemError`] if the subproblem has no usable answer.
pub(crate) fn propose(at: &mut Position<'_>) -> Result<Proposal, SubproblemError> {
    let (state, model) = (at.state, at.model);
    let quadratic = state.norm.weighted(state.weight);
    let many = state.center.len() >= MANY_VARIABLES && matches!(quadratic, WeightedMetric::Diagonal(_));
    let gram = if many { model.products(state) } else { None };
    let cuts = Cuts { gram, ..model.cuts() };
    let solution = subproblem::solve(at.solver, at.set, &state.center, quadratic.metric(), cuts)?;
    let proposal = interpret(solution, (state, at.set), model);
    // Every solution has −v ≥ u‖d‖²; an answer that promises less than half of this is no solution.
    let least = 0.5 * proposal.aggregate_norm * proposal.step_length - state.rounding();
    if !(proposal.predicted_decrease >= least && proposal.step_length.is_finite()) {
        return Err(SubproblemError::Unusable);
    }
    proposal.admissible(at.set, state)
}

/// Takes note that the oracle failed at a trial point of any proposer.
pub(crate) fn shorten(state: &mut State, config: &BundleTrustConfig, proposal: &Proposal) {
    if proposal.origin == Origin::Cuts {
        state.streak = -1;
        state.set_weight(proposal.weight * config.weight_increase, config);
    }
}

/// Sets the next weight, after trial points of the plain cuts only; the center has not moved yet.
pub(crate) fn learn(state: &mut State, config: &BundleTrustConfig, trial: &Trial<'_>) {
    if trial.proposal.origin != Origin::Cuts {
        return;
    }
    if trial.serious {
        weight::after_serious(state, config, &trial.comparison);
    } else {
        weight::after_null(state, config, trial);
    }
}

fn interpret(mut solution: QpSolution, (state, set): (&State, &Polyhedron), model: &Model) -> Proposal {
    let step = std::mem::take(&mut solution.step);
    let squared = state.norm.squared(&step);
    let predicted_decrease = (-solution.epigraph).max(0.0);
    let offsets = model.cuts().offsets;
    let cut_error: f64 = solution.cut_multipliers.iter().zip(offsets).map(|(l, a)| l * a).sum();
    model.distribute(&mut solution.cut_multipliers);
    let multipliers = (Vector::from_vec(solution.row_multipliers), Vector::from_vec(solution.bound_multipliers));
    let sides = (&multipliers.0, &multipliers.1);
    Proposal {
        trial: &state.center + &step,
        step_length: squared.sqrt(),
        composite_aggregate: None,
        slack_error: slack_error(sides, &state.center, set),
        step,
        predicted_decrease,
        cut_change: -predicted_decrease,
        aggregate_norm: state.weight * squared.sqrt(),
        aggregate_error: (predicted_decrease - state.weight * squared).max(0.0),
        cut_error,
        cut_multipliers: solution.cut_multipliers,
        row_multipliers: multipliers.0,
        bound_multipliers: multipliers.1,
        convexification: model.convexification,
        weight: state.weight,
        violation: 0.0,
        origin: Origin::Cuts,
    }
}
