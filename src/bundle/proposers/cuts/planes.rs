//! The cutting-plane subproblem of a run, with model and answer kept as long as center and bundle stay.
//!
//! ```text
//! min over (d, v)  v + u‖d‖²/2,   ⟨h_i, d⟩ − a_i ≤ v,   x̂ + d ∈ U
//! z̃ = Σ λ_i h_i + Aᵀμ + ν = −u W d      aggregate subgradient, constraints included
//! ẽ = −v − u‖d‖² = Σ λ_i a_i + slack of the active constraints ≥ 0      aggregate error
//! ```

use super::model::{MANY_VARIABLES, Model};
use super::qualification::fails_within;
use super::weight::WeightRule;
use crate::bundle::norm::WeightedMetric;
use crate::bundle::proposers::aggregate::slack_error;
use crate::bundle::proposers::proposal::{Proposal, SubproblemError};
use crate::bundle::proposers::proposer::Position;
use crate::bundle::proposers::subproblem::{self, Cuts};
use crate::bundle::state::BundleState;
use crate::interruption::interrupted;
use crate::qp::QpSolution;
use crate::report::{Origin, Termination};
use crate::{Polyhedron, Vector};
use std::rc::Rc;

/// Tenfold decreases of the weight, without evaluations, where the predicted decrease is small: a restart may raise the
/// weight by 1e12, and units of variables may differ by as much.
pub(super) const MAX_DECREASES: usize = 16;
/// Weights tried, each ten times the one before, until a subproblem counts as unsolvable.
const MAX_TRIALS: usize = 4;

/// The subproblem with the model of center and bundle.
#[derive(Debug, Default)]
pub(crate) struct CuttingPlanes {
    model: Option<(Key, Model)>,
    /// The answer of the last subproblem.
    proposal: Option<(Key, Proposal)>,
    pub(super) weight_rule: WeightRule,
}

/// Center and revision of the bundle that a model or an answer belongs to.
type Key = (u64, u64);

fn key(state: &BundleState) -> Key {
    (state.center_id, state.bundle.revision())
}

impl CuttingPlanes {
    /// The model of center and bundle.
    pub(crate) fn model(&mut self, at: &mut Position<'_>) -> &Model {
        let wanted = key(at.state);
        let model = match self.model.take() {
            Some((known, model)) if known == wanted => model,
            former => Model::new(at.state, at.config, former.map(|(_, model)| model)),
        };
        &self.model.insert((wanted, model)).1
    }

    /// The answer of the last subproblem, where center and bundle are still those it was solved for.
    pub(crate) fn answer(&self, state: &BundleState) -> Option<&Proposal> {
        self.proposal.as_ref().filter(|(known, _)| *known == key(state)).map(|(_, proposal)| proposal)
    }

    /// Solves the subproblem; where this fails, larger weights are tried before the run ends.
    pub(crate) fn solve(&mut self, at: &mut Position<'_>) -> Result<Proposal, Termination> {
        let mut last = SubproblemError::Unusable;
        for _ in 0..MAX_TRIALS {
            match self.try_solve(at) {
                // What an interrupted subproblem leaves says nothing about the objective.
                _ if interrupted() => return Err(Termination::StoppedByObserver),
                Ok(proposal) => return Ok(proposal),
                Err(error) => last = error,
            }
            at.state.set_weight(10.0 * at.state.weight);
        }
        Err(match fails_within(at) {
            // Multipliers that grow without bound leave the subproblem without an accurate answer.
            Some(radius) => Termination::DegenerateConstraints { radius },
            None => Termination::SubproblemFailed { reason: last.to_string() },
        })
    }

    /// Solves the subproblem at the weight of the run.
    ///
    /// # Errors
    /// [`SubproblemError`] if the subproblem has no usable answer.
    pub(crate) fn try_solve(&mut self, at: &mut Position<'_>) -> Result<Proposal, SubproblemError> {
        let proposal = propose(self.model(at), at)?;
        at.state.bundle.set_multipliers(&proposal.cut_multipliers);
        self.proposal = Some((key(at.state), proposal.clone()));
        Ok(proposal)
    }

    /// Lowers the weight tenfold; the answer at the lower weight, or none if the subproblem cannot be solved there.
    pub(crate) fn lower_weight(&mut self, at: &mut Position<'_>) -> Option<Proposal> {
        let kept = at.state.weight;
        at.state.weight = kept / 10.0;
        let lower = self.try_solve(at).ok();
        if lower.is_none() {
            at.state.weight = kept;
        }
        lower
    }
}

fn propose(model: &Model, at: &mut Position<'_>) -> Result<Proposal, SubproblemError> {
    let state = &*at.state;
    let quadratic = state.norm.weighted(state.weight);
    let many = state.center.len() >= MANY_VARIABLES && matches!(quadratic, WeightedMetric::Diagonal(_));
    let gram = if many { model.products(state) } else { None };
    let cuts = Cuts { gram, ..model.cuts() };
    let solution = subproblem::solve(at.solver, at.set, &state.center, quadratic.metric(), cuts)?;
    let mut proposal = interpret(solution, state, at.set, model);
    proposal.tangents = at.working.map(|working| Rc::clone(&working.tangents));
    // Every solution has −v ≥ u‖d‖²; an answer that promises less than half of this is no solution. Rounding of ⟨h, d⟩
    // aside.
    let steepest = state.bundle.dual_lengths().fold(0.0, f64::max);
    if at.restoring() && proposal.step_length.is_finite() {
        return proposal.admissible(at.set, state);
    }
    proposal.predicted_decrease = proposal.predicted_decrease.max(0.0);
    proposal.cut_change = -proposal.predicted_decrease;
    if at.working.is_some_and(|working| working.reduction > 0.0) && proposal.step_length.is_finite() {
        return proposal.admissible(at.set, state);
    }
    let rounding = state.rounding() + 8.0 * f64::EPSILON * steepest * proposal.step_length;
    let least = 0.5 * proposal.aggregate_norm * proposal.step_length - rounding;
    if !(proposal.predicted_decrease >= least && proposal.step_length.is_finite()) {
        return Err(SubproblemError::Unusable);
    }
    proposal.admissible(at.set, state)
}

fn interpret(mut solution: QpSolution, state: &BundleState, set: &Polyhedron, model: &Model) -> Proposal {
    let step = std::mem::take(&mut solution.step);
    let squared = state.norm.squared(&step);
    let predicted_decrease = -solution.epigraph;
    let offsets = model.cuts().offsets;
    let cut_error: f64 = solution.cut_multipliers.iter().zip(offsets).map(|(l, a)| l * a).sum();
    model.distribute(&mut solution.cut_multipliers);
    let rows = Vector::from_vec(solution.row_multipliers);
    let bounds = Vector::from_vec(solution.bound_multipliers);
    Proposal {
        trial: &state.center + &step,
        step_length: squared.sqrt(),
        composite_aggregate: None,
        slack_error: slack_error(&rows, &bounds, &state.center, set),
        step,
        predicted_decrease,
        cut_change: -predicted_decrease,
        aggregate_norm: state.weight * squared.sqrt(),
        aggregate_error: (predicted_decrease - state.weight * squared).max(0.0),
        cut_error,
        cut_multipliers: solution.cut_multipliers,
        row_multipliers: rows,
        tangents: None,
        bound_multipliers: bounds,
        convexification: model.convexification,
        weight: state.weight,
        violation: 0.0,
        origin: Origin::Cuts,
        restores: false,
        leaves: None,
    }
}
