//! The curved model proposes while its record of predictions is clearly better than that of the plain cuts, so that kinks switch the
//! model off. Failures double the pause before the model proposes again.

pub(crate) mod config;
mod model;
mod pieces;
mod step;
#[cfg(test)]
mod step_tests;

use super::pause::Pause;
use super::proposal::{Proposal, SubproblemError};
use super::cuts::model::Model;
use super::proposer::Position;
use crate::Vector;
use crate::bundle::config::BundleTrustConfig;
use crate::bundle::state::State;
use crate::bundle::trial::{Comparison, Trial};
use crate::report::Origin;
use config::CurvedModelConfig;
use model::CurvedModel;
use step::Penalised;

/// The curved model, and the right to use it.
#[derive(Debug)]
pub(crate) struct Curved {
    settings: CurvedModelConfig,
    /// Weight of ‖d‖²/2 beside the matrix B.
    weight: f64,
    /// Running mean of the log ratio of the prediction errors.
    score: f64,
    /// Null steps of the model in a row.
    nulls: usize,
    pause: Pause,
    /// The model at the center, which predicts every trial point, whoever proposes it.
    model: CurvedModel,
}

impl Curved {
    pub(crate) fn new(settings: CurvedModelConfig, weight: f64) -> Self {
        Self { settings, weight, score: 0.0, nulls: 0, pause: Pause::default(), model: CurvedModel::default() }
    }

    /// The step that minimises the model and its penalty.
    fn step(&self, at: &mut Position<'_>) -> Result<Vector, SubproblemError> {
        let (state, model) = (&*at.state, &self.model);
        let (weight, radius) = (self.weight, longest_step(state));
        let penalised = Penalised { model, weight, radius, norm: &state.norm, set: at.set, center: &state.center };
        Ok(penalised.minimum(model.first_multipliers(state), at.solver, &self.settings)?)
    }

    /// Judges both predictions by the actual change.
    fn compare(&mut self, change: f64, plain: f64, curved: f64) {
        let size = change.abs() + plain.abs();
        let floor = self.settings.error_floor * size;
        // Models that agree up to rounding say nothing about each other.
        if (plain - curved).abs() > AGREEMENT * size {
            let gain = (((change - plain).abs() + floor) / ((change - curved).abs() + floor)).ln();
            let largest = self.settings.max_log_ratio;
            self.score += self.settings.newest_share * (gain.clamp(-largest, largest) - self.score);
        }
    }

    /// Lowers the weight to what the observed change asks for, if the step was good.
    fn after_serious(&mut self, state: &State, config: &BundleTrustConfig, trial: &Trial<'_>) {
        self.nulls = 0;
        self.pause.succeed();
        let (u, comparison) = (self.weight, &trial.comparison);
        if comparison.is_good(config) {
            let next = missing_weight(comparison, trial.proposal.step_length).max(u / config.weight_decrease).min(u);
            self.weight = next.max(state.weight_limits(config).0);
        }
    }

    /// Raises the weight after the first null step already: the next matrix B knows the new point. A pause forgets the weight: near a kink
    /// that no cut had shown, it has risen by the jump of the slope over a tiny step, and the cuts of the pause show that kink.
    fn after_null(&mut self, state: &State, config: &BundleTrustConfig, trial: &Trial<'_>) {
        self.nulls += 1;
        if self.nulls >= self.settings.max_null_steps {
            self.nulls = 0;
            self.pause.fail(self.settings.max_pause);
            self.weight = self.settings.weight_after_pause * state.weight;
            return;
        }
        let u = self.weight;
        let range = (LEAST_INCREASE.min(config.weight_increase) * u, config.weight_increase * u);
        let next = missing_weight(&trial.comparison, trial.proposal.step_length).clamp(range.0, range.1);
        self.weight = next.min(state.weight_limits(config).1);
    }
}

/// Two predictions are one if they differ by at most this share of the changes that are compared.
const AGREEMENT: f64 = 1e-10;

/// Least factor by which the weight beside B rises after a null step, unless `weight_increase` is smaller.
const LEAST_INCREASE: f64 = 2.0;

/// Longest step where pieces may bend down, relative to the distance of the farthest cut.
const LONGEST_STEP: f64 = 0.7;

/// How far the curvatures of the pieces are trusted.
fn longest_step(state: &State) -> f64 {
    if !state.nonconvex {
        return f64::INFINITY;
    }
    let distances = state.bundle.cuts().iter().map(|cut| state.norm.squared_distance(&cut.point, &state.center));
    LONGEST_STEP * distances.fold(0.0, f64::max).sqrt()
}

/// The weight beside B that the observed change asks for.
fn missing_weight(comparison: &Comparison, step_length: f64) -> f64 {
    2.0 * (comparison.change - comparison.model_change) / (step_length * step_length)
}

impl Curved {
    /// A trial point that should replace that of the plain cuts; none if theirs should stay. A predicted decrease up to `small` is not worth
    /// an evaluation.
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
        self.model = CurvedModel::new(at.state, cuts, &self.settings);
        if !(self.pause.pass() && self.score > self.settings.trust) {
            return Ok(None);
        }
        let step = self.step(at)?;
        let change = |step: &Vector| self.model.change(step);
        let better = plain.replaced((step, self.weight, Origin::CurvedModel), (at.set, at.state), change)?;
        Ok(Some(better).filter(|better| better.predicted_decrease > self.settings.least_promise * small))
    }

    /// Takes note that the oracle failed at a trial point of any proposer.
    pub(crate) fn shorten(&mut self, state: &mut State, config: &BundleTrustConfig, proposal: &Proposal) {
        if proposal.origin == Origin::CurvedModel {
            self.pause.fail(self.settings.max_pause);
            self.weight = (self.weight * config.weight_increase).min(state.weight_limits(config).1);
        }
    }

    /// Takes note of an evaluated trial point of any proposer; the center has not moved yet.
    pub(crate) fn learn(&mut self, state: &mut State, config: &BundleTrustConfig, trial: &Trial<'_>) {
        if trial.accurate {
            let curved = self.model.change(&trial.proposal.step);
            self.compare(trial.comparison.change, trial.proposal.cut_change, curved);
        }
        match (trial.proposal.origin, trial.serious) {
            (Origin::CurvedModel, true) => self.after_serious(state, config, trial),
            (Origin::CurvedModel, false) => self.after_null(state, config, trial),
            _ => {}
        }
    }
}
