//! The curved model proposes while its record of predictions is clearly better than that of the plain cuts, so that
//! kinks switch the model off.

mod model;
mod pieces;
mod step;

use super::cuts::model::Model;
use super::proposal::{Proposal, SubproblemError};
use super::proposer::Position;
use crate::Vector;
use crate::bundle::state::BundleState;
use crate::bundle::trial::{Comparison, Trial};
use crate::report::Origin;
use model::CurvedModel;
use step::Penalised;

/// Number of variables above which a run does without the curved model, because its dense matrices become too
/// expensive.
pub(crate) const MAX_DIMENSION: usize = 100;
/// Prediction errors below this share of the changes that are compared count as equally good.
const ERROR_FLOOR: f64 = 1e-2;

/// The curved model, and the right to use it.
#[derive(Debug)]
pub(crate) struct Curved {
    /// Weight of ‖d‖²/2 beside the matrix B.
    weight: f64,
    /// Running mean of the log ratio of the prediction errors, plain over curved; the newest counts for half.
    score: f64,
    /// Whether the oracle failed at the last trial point of the model: the plain cuts propose next.
    failed: bool,
    /// The model at the center, which predicts every trial point, whoever proposes it.
    model: CurvedModel,
}

impl Curved {
    pub(crate) fn new(weight: f64) -> Self {
        Self { weight, score: 0.0, failed: false, model: CurvedModel::default() }
    }

    /// The step that minimises the model and its penalty.
    fn step(&self, at: &mut Position<'_>) -> Result<Vector, SubproblemError> {
        let (state, model) = (&*at.state, &self.model);
        let (weight, radius) = (self.weight, longest_step(state));
        let penalised = Penalised { model, weight, radius, norm: &state.norm, set: at.set, center: &state.center };
        Ok(penalised.minimum(model.multipliers_of(state.center_id), at.solver)?)
    }

    /// Compares both predictions with the actual change.
    fn compare(&mut self, change: f64, plain: f64, curved: f64) {
        let size = change.abs() + plain.abs();
        let floor = ERROR_FLOOR * size;
        // Models that agree say nothing about each other.
        if plain != curved {
            let gain = (((change - plain).abs() + floor) / ((change - curved).abs() + floor)).ln();
            self.score = 0.5 * (self.score + gain.clamp(-2.0, 2.0));
        }
    }

    /// Lowers the weight to what the observed change asks for.
    fn after_serious(&mut self, state: &BundleState, trial: &Trial<'_>) {
        let u = self.weight;
        let next = missing_weight(&trial.comparison, trial.proposal.step_length).max(u / 10.0);
        self.weight = next.min(u).max(state.weight_limits().0);
    }

    /// Raises the weight after the first null step already: the next matrix B knows the new point.
    fn after_null(&mut self, state: &BundleState, trial: &Trial<'_>) {
        let u = self.weight;
        let next = missing_weight(&trial.comparison, trial.proposal.step_length).clamp(2.0 * u, 10.0 * u);
        self.weight = next.min(state.weight_limits().1);
    }
}

/// How far the curvatures of the pieces are trusted: up to the farthest cut, where pieces may be concave.
fn longest_step(state: &BundleState) -> f64 {
    if !state.nonconvex {
        return f64::INFINITY;
    }
    let distances = state.bundle.cuts().iter().map(|cut| state.norm.squared_distance(&cut.point, &state.center));
    distances.fold(0.0, f64::max).sqrt()
}

/// The weight beside B that the observed change asks for.
fn missing_weight(comparison: &Comparison, step_length: f64) -> f64 {
    2.0 * (comparison.change - comparison.model_change) / (step_length * step_length)
}

impl Curved {
    /// A trial point that should replace that of the plain cuts; none if theirs should stay. A predicted decrease up to
    /// `small` is not worth an evaluation.
    ///
    /// # Errors
    /// [`SubproblemError`]: the model proposes nothing.
    pub(crate) fn propose(
        &mut self,
        at: &mut Position<'_>,
        cuts: &Model,
        plain: &Proposal,
        small: f64,
    ) -> Result<Option<Proposal>, SubproblemError> {
        self.model = CurvedModel::new(at.state, cuts);
        if std::mem::take(&mut self.failed) || self.score <= 1.0 {
            return Ok(None);
        }
        let step = self.step(at)?;
        let change = |step: &Vector| self.model.change(step);
        let better = plain.replaced(at.set, at.state, step, self.weight, Origin::CurvedModel, change)?;
        Ok(Some(better).filter(|better| better.predicted_decrease > small))
    }

    /// Takes note that the oracle failed at a trial point of any proposer.
    pub(crate) fn shorten(&mut self, state: &mut BundleState, proposal: &Proposal) {
        if proposal.origin == Origin::CurvedModel {
            self.failed = true;
            self.weight = (10.0 * self.weight).min(state.weight_limits().1);
        }
    }

    /// Takes note of an evaluated trial point of any proposer; the center has not moved yet.
    pub(crate) fn learn(&mut self, state: &mut BundleState, trial: &Trial<'_>) {
        if trial.accurate {
            let curved = self.model.change(&trial.proposal.step);
            self.compare(trial.comparison.objective_change, trial.proposal.cut_change, curved);
        }
        match (trial.proposal.origin, trial.serious) {
            (Origin::CurvedModel, true) => self.after_serious(state, trial),
            (Origin::CurvedModel, false) => self.after_null(state, trial),
            _ => {}
        }
    }
}
