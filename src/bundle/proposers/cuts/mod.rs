//! The plain cuts: the proposer that every run has, and on which stopping test and certificate rest.
//!
//! ```text
//! min over (d, v)  v + u‖d‖²/2,   ⟨h_i, d⟩ − a_i ≤ v,   x̂ + d ∈ U
//! z̃ = Σ λ_i h_i + Aᵀμ + ν = −u W d      aggregate subgradient, constraints included
//! ẽ = −v − u‖d‖² = Σ λ_i a_i + slack of the active constraints ≥ 0      aggregate error
//! ```

pub(crate) mod model;
mod weight;

use super::proposal::{Proposal, SubproblemError};
use super::proposer::{Position, Proposer, Trial};
use super::subproblem;
use crate::bundle::config::BundleTrustConfig;
use crate::bundle::state::State;
use crate::qp::QpSolution;
use crate::report::Origin;
use crate::{Polyhedron, Vector};
use model::Model;

/// The cutting-plane model with the weight of the run.
#[derive(Debug)]
pub(crate) struct PlainCuts;

impl Proposer for PlainCuts {
    fn propose(&mut self, at: &mut Position<'_>, _proposed: &[Proposal]) -> Result<Option<Proposal>, SubproblemError> {
        let (state, model) = (at.state, at.model);
        let quadratic = state.norm.weighted(state.weight);
        let solution = subproblem::solve(at.solver, at.set, state, quadratic.metric(), model.cuts())?;
        let proposal = interpret(solution, (state, at.set), model);
        // Every solution has −v ≥ u‖d‖²; one that promises less is not a solution.
        let least = 0.5 * proposal.aggregate_norm * proposal.step_length - state.rounding();
        if !(proposal.predicted_decrease >= least && proposal.step_length.is_finite()) {
            return Err(SubproblemError::Unusable);
        }
        proposal.admissible(at.set, state).map(Some)
    }

    fn shorten(&mut self, state: &mut State, config: &BundleTrustConfig, proposal: &Proposal) {
        if proposal.origin == Origin::Cuts {
            state.streak = -1;
            state.set_weight(proposal.weight * config.weight_increase, config);
        }
    }

    /// Sets the next weight, after trial points of its own only.
    fn learn(&mut self, state: &mut State, config: &BundleTrustConfig, trial: &Trial<'_>) {
        if trial.proposal.origin != Origin::Cuts {
            return;
        }
        if trial.serious {
            weight::after_serious(state, config, &trial.comparison);
        } else {
            weight::after_null(state, config, trial);
        }
    }
}

/// Entries of Σ λ_i g_i + Aᵀμ + ν from the multipliers themselves, so that no error of the subproblem hides in them.
fn aggregate_sizes(solution: &QpSolution, state: &State, set: &Polyhedron) -> Vector {
    let mut sum = Vector::from_column_slice(&solution.bound_multipliers);
    let mut terms = sum.abs();
    let cuts = state.bundle.cuts().iter().zip(&solution.cut_multipliers);
    for (cut, &multiplier) in cuts.filter(|(_, multiplier)| **multiplier > 0.0) {
        sum.axpy(multiplier, &cut.subgradient, 1.0);
        terms.axpy(multiplier, &cut.subgradient.abs(), 1.0);
    }
    let rows = Vector::from_column_slice(&solution.row_multipliers);
    sum += set.rows().tr_mul(&rows);
    terms += set.rows().abs().tr_mul(&rows.abs());
    sum.abs() + terms * (2.0 * f64::EPSILON)
}

/// Σ slack·|multiplier| at the center.
fn slack_error(solution: &QpSolution, center: &Vector, set: &Polyhedron) -> f64 {
    let at_rows = set.rows() * center;
    let rows = set.row_lower().iter().zip(set.row_upper()).zip(at_rows.iter().zip(&solution.row_multipliers));
    let bounds = set.lower().iter().zip(set.upper()).zip(center.iter().zip(&solution.bound_multipliers));
    let one = |((lower, upper), (at, multiplier)): ((&f64, &f64), (&f64, &f64))| {
        let slack = if *multiplier > 0.0 { upper - at } else { at - lower };
        if *multiplier == 0.0 { 0.0 } else { multiplier.abs() * slack.max(0.0) }
    };
    rows.chain(bounds).map(one).sum()
}

fn interpret(mut solution: QpSolution, (state, set): (&State, &Polyhedron), model: &Model) -> Proposal {
    let step = std::mem::take(&mut solution.step);
    let squared = state.norm.squared(&step);
    let predicted_decrease = (-solution.epigraph).max(0.0);
    let offsets = model.cuts().offsets;
    let cut_error: f64 = solution.cut_multipliers.iter().zip(offsets).map(|(l, a)| l * a).sum();
    model.distribute(&mut solution.cut_multipliers);
    let aggregate_sizes = aggregate_sizes(&solution, state, set);
    Proposal {
        trial: &state.center + &step,
        step_length: squared.sqrt(),
        aggregate_sizes,
        slack_error: slack_error(&solution, &state.center, set),
        step,
        predicted_decrease,
        cut_change: -predicted_decrease,
        aggregate_norm: state.weight * squared.sqrt(),
        aggregate_error: (predicted_decrease - state.weight * squared).max(0.0),
        cut_error,
        cut_multipliers: solution.cut_multipliers,
        row_multipliers: Vector::from_vec(solution.row_multipliers),
        bound_multipliers: Vector::from_vec(solution.bound_multipliers),
        convexification: model.convexification,
        weight: state.weight,
        violation: 0.0,
        origin: Origin::Cuts,
    }
}
