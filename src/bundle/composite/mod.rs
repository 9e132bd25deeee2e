//! The composite model as a proposer: trial points from h exact and c linear, as long as that pays.
//!
//! ```text
//! predicted = h(c) − h(c + G d),   ratio = (Θ(x) − Θ(x + d))/predicted:    u falls where it is large, rises where it is small
//! predicted small at small u:      stationary, proved by w ∈ ∂h and G at x alone                       radius 0
//! ```
//! One linearization is pessimistic where a constraint becomes active inside c, so that ratios above 1 are common. After
//! failures the model pauses, and cuts, curved model and exploration go on; it returns at the next center with a Jacobian.

mod model;

use super::proposers::aggregate::{aggregate_sizes, slack_error};
use super::proposers::pause::Pause;
use super::proposers::proposal::{Proposal, SubproblemError};
use super::proposers::proposer::Trial;
use super::run::Run;
use crate::composite::{Linearization, LinearizationRequest, OuterFunction};
use crate::report::{Origin, Termination};
use crate::{Accuracy, NonsmoothObjective, Vector};
use model::CompositeModel;
use std::ops::ControlFlow::{self, Break, Continue};

pub(crate) use model::CompositeStep;
pub use model::OuterCut;

/// The first weight, in first weights of the cuts.
const FIRST_WEIGHT: f64 = 1e-2;
/// A step with this share of the predicted decrease lets the weight fall.
const GOOD_RATIO: f64 = 0.5;
/// By which the weight falls.
const DECREASE: f64 = 10.0;
/// By which it rises.
const INCREASE: f64 = 10.0;
/// Longest pause after failures, evaluations.
const MAX_PAUSE: usize = 64;
/// Failures in a row before a pause.
const PATIENCE: usize = 2;
/// Accuracy asked of a Jacobian.
const JACOBIAN_ACCURACY: f64 = 1e-4;

/// The composite model of a run.
#[derive(Debug)]
pub(crate) struct Composite {
    weight: f64,
    pause: Pause,
    failures: usize,
    base: Option<Base>,
}

/// Where the model is built.
#[derive(Debug, Clone)]
pub(crate) struct Base {
    pub(super) point: Vector,
    pub(super) value: f64,
    pub(super) linearization: Linearization,
}

impl Composite {
    pub(crate) fn new(first_weight: f64) -> Self {
        let factor = std::env::var("CW").ok().and_then(|text| text.parse().ok()).unwrap_or(FIRST_WEIGHT);
        Self { weight: factor * first_weight, pause: Pause::default(), failures: 0, base: None }
    }

    /// What to ask of an evaluation; `below`: the value from which on the point becomes the center.
    pub(crate) fn request(below: f64) -> LinearizationRequest {
        let accuracy = Accuracy::relative(JACOBIAN_ACCURACY).unwrap_or(Accuracy::TIGHTEST);
        LinearizationRequest { accuracy, below }
    }

    /// Learns what came of one of its trial points.
    fn learn(&mut self, change: f64, predicted: f64, serious: bool) {
        let ratio = -change / predicted;
        if serious {
            self.failures = 0;
            self.pause.succeed();
            if ratio >= GOOD_RATIO {
                self.weight /= DECREASE;
            }
        } else {
            self.failures += 1;
            self.weight *= INCREASE;
            if self.failures >= PATIENCE {
                self.pause.fail(MAX_PAUSE);
            }
        }
    }
}

impl<O: NonsmoothObjective> Run<'_, '_, O> {
    /// The trial point of the composite model, none where it has none; ends the run at a point that it proves stationary.
    pub(super) fn composite_trial(&mut self) -> ControlFlow<Termination, Option<Proposal>> {
        let (objective, Some(composite)) = (self.objective, &mut self.composite) else { return Continue(None) };
        let (Some(outer), Some(base)) = (objective.outer(), composite.base.clone()) else { return Continue(None) };
        if !composite.pause.pass() {
            return Continue(None);
        }
        let mut weight = composite.weight;
        for _ in 0..=self.method.config.attenuation_steps {
            let found = self.solve_composite(outer, &base, weight);
            let (proposal, step) =
                match found.and_then(|step| Ok((self.composite_proposal(&base, &step, weight)?, step))) {
                    Err(error @ SubproblemError::NotConvex { .. }) => {
                        return Break(Termination::SubproblemFailed { reason: error.to_string() });
                    }
                    Err(_) => return Continue(None),
                    Ok(found) => found,
                };
            if let Some(word) = self.composite_word(&proposal) {
                self.proof = Some((base, step));
                return Break(word);
            }
            if proposal.predicted_decrease > self.small() {
                return Continue(Some(proposal));
            }
            weight /= DECREASE;
        }
        Continue(None)
    }

    /// Learns from a trial point and what its evaluation says about the outputs; whether it brought a Jacobian.
    pub(super) fn learn_structure(
        &mut self,
        trial: &Trial<'_>,
        linearization: Option<Result<Linearization, String>>,
        value: f64,
    ) -> Option<Result<(), String>> {
        let composite = self.composite.as_mut()?;
        if trial.proposal.origin == Origin::CompositeModel {
            composite.weight = trial.proposal.weight;
            composite.learn(trial.comparison.change, -trial.comparison.model_change, trial.serious);
        }
        if !trial.serious {
            return None;
        }
        self.rebase(&trial.proposal.trial, value, linearization)
    }

    /// Moves the model to a new center; whether that brought a Jacobian.
    pub(super) fn rebase(
        &mut self,
        point: &Vector,
        value: f64,
        linearization: Option<Result<Linearization, String>>,
    ) -> Option<Result<(), String>> {
        let composite = self.composite.as_mut()?;
        composite.base = None;
        Some(linearization?.map(|linearization| {
            self.state.counts.jacobians += 1;
            composite.base = Some(Base { point: point.clone(), value, linearization });
        }))
    }

    fn solve_composite(
        &mut self,
        outer: &dyn OuterFunction,
        base: &Base,
        weight: f64,
    ) -> Result<CompositeStep, SubproblemError> {
        let model = CompositeModel {
            outer,
            linearization: &base.linearization,
            value: outer.value(&base.linearization.outputs),
            base: &base.point,
            norm: &self.state.norm,
            set: &self.set,
            weight,
        };
        let before = self.solver.counts();
        let step = model.solve(&mut self.solver);
        self.count_solves(before);
        step
    }

    fn composite_proposal(&self, base: &Base, step: &CompositeStep, weight: f64) -> Result<Proposal, SubproblemError> {
        let state = &self.state;
        let outputs = &base.linearization.outputs;
        let errors = step.cuts.iter().map(|cut| cut.multiplier * cut.error(outputs, base.value).max(0.0));
        let (error, squared) = (errors.sum::<f64>(), state.norm.squared(&step.step));
        let sides = (&step.row_multipliers, &step.bound_multipliers);
        let slack = slack_error(sides, &base.point, &self.set);
        let aggregate = base.linearization.jacobian.tr_mul(&step.weights());
        Proposal {
            trial: &base.point + &step.step,
            step: step.step.clone(),
            step_length: squared.sqrt(),
            predicted_decrease: step.decrease,
            cut_change: 0.0,
            aggregate_sizes: aggregate_sizes(std::iter::once((1.0, &aggregate)), sides, &self.set),
            slack_error: slack,
            aggregate_norm: weight * squared.sqrt(),
            aggregate_error: error + slack,
            cut_error: error,
            cut_multipliers: vec![0.0; state.bundle.cuts().len()],
            row_multipliers: step.row_multipliers.clone(),
            bound_multipliers: step.bound_multipliers.clone(),
            convexification: 0.0,
            weight,
            violation: 0.0,
            origin: Origin::CompositeModel,
        }
        .admissible(&self.set, state)
    }

    /// The word for a base that the model proves stationary.
    fn composite_word(&self, proposal: &Proposal) -> Option<Termination> {
        if proposal.predicted_decrease > self.small() {
            return None;
        }
        let remaining = self.state.decrease_bound(proposal, &self.set);
        self.word_at_point(remaining)
    }
}
