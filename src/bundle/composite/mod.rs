//! The composite model as a proposer: trial points from h exact and c linear, as long as that pays.
//!
//! ```text
//! predicted = h(c) − h(c + G d),   ratio = (Θ(x) − Θ(x + d))/predicted:    u falls where it is large, rises where it is small
//! predicted small at small u:      stationary, proved by w ∈ ∂h and G at x alone                       radius 0
//! ```
//! One linearization is pessimistic where a constraint becomes active inside c, so that ratios above 1 are common. After
//! failures the model pauses, and cuts, curved model and exploration go on; it returns at the next center with a Jacobian.

mod curvature;
mod excursion;
mod model;

use super::proposers::aggregate::{aggregate_sizes, slack_error};
use super::proposers::pause::Pause;
use super::proposers::proposal::{Proposal, SubproblemError};
use super::proposers::proposer::Trial;
use super::run::Run;
use crate::composite::{Linearization, LinearizationRequest};
use crate::report::{Origin, Termination};
use crate::{Accuracy, NonsmoothObjective, Polyhedron, Vector};
use curvature::Memory;
use excursion::Excursion;
use model::CompositeModel;
use std::ops::ControlFlow::{self, Break, Continue};

pub(crate) use model::CompositeStep;
pub use model::OuterCut;

/// The first weight, in first weights of the cuts.
const FIRST_WEIGHT: f64 = 1e-2;
/// A step with this share of the predicted decrease lets the weight fall.
const GOOD_RATIO: f64 = 0.5;
/// By which the weight falls, and by which it rises.
const FACTOR: f64 = 10.0;
/// Length of the step after a rejected one, as a share of its length.
const SHORTER: f64 = 0.3;
/// Weights tried until a step is short enough.
const MAX_WEIGHTS: usize = 20;
/// Growth of a small predicted decrease, as the weight falls, from which on the weight matters.
const LEAST_GAIN: f64 = 1.1;
/// Longest pause after failures, evaluations.
const MAX_PAUSE: usize = 64;
/// Failures in a row before a pause.
const PATIENCE: usize = 3;
/// Longest step on from a rejected trial point, in lengths of the rejected step.
const CONTRACTION: f64 = 0.5;
/// Subproblems solved for weights and curvature that belong together.
const PASSES: usize = 2;
/// Accuracy asked of a Jacobian.
const JACOBIAN_ACCURACY: f64 = 1e-4;

/// The composite model of a run.
#[derive(Debug)]
pub(crate) struct Composite {
    weight: f64,
    /// Length that the next step must not exceed, after a rejected one.
    longest: f64,
    pause: Pause,
    failures: usize,
    /// Where the model is built: the center, if its Jacobian is known.
    base: Option<Base>,
    /// A rejected trial point with its Jacobian.
    rejected: Option<Base>,
    /// Whether the pending trial point is a correction.
    correcting: bool,
    /// Whether the pending trial point is one of the model's own.
    proposing: bool,
    /// Whether the model takes the curvature of the outputs into account: since a step has failed without it.
    bends: bool,
    memory: Memory,
    /// Weights of the outputs at the last subproblem's solution.
    weights: Option<Vector>,
    excursion: Option<Excursion>,
}

/// Where the model is built.
#[derive(Debug, Clone)]
pub(crate) struct Base {
    pub point: Vector,
    pub value: f64,
    pub linearization: Linearization,
}

/// What proves that a point is stationary.
#[derive(Debug, Clone)]
pub(crate) struct Proof {
    pub word: Termination,
    pub base: Base,
    pub step: CompositeStep,
    pub proposal: Proposal,
}

impl Composite {
    pub(crate) fn new(first_weight: f64) -> Self {
        Self {
            weight: FIRST_WEIGHT * first_weight,
            longest: f64::INFINITY,
            pause: Pause::default(),
            failures: 0,
            base: None,
            rejected: None,
            correcting: false,
            proposing: false,
            bends: false,
            memory: Memory::default(),
            weights: None,
            excursion: None,
        }
    }

    /// What to ask of an evaluation; `below`: the value from which on the point becomes the center.
    pub(crate) fn request(&self, below: f64) -> LinearizationRequest {
        LinearizationRequest {
            // What a rejected trial point of its own tells is used by the correction.
            below: if self.proposing { f64::INFINITY } else { below },
            ..Self::first_request()
        }
    }

    /// What to ask of the first evaluation.
    pub(crate) fn first_request() -> LinearizationRequest {
        let accuracy = Accuracy::relative(JACOBIAN_ACCURACY).unwrap_or(Accuracy::TIGHTEST);
        LinearizationRequest { accuracy, below: f64::INFINITY }
    }

    /// Learns what came of a step of its own: the ratio of the decrease to the one predicted, none if the oracle failed.
    fn learn(&mut self, proposal: &Proposal, ratio: Option<f64>, accepted: bool) {
        self.weight = proposal.weight;
        if accepted {
            self.failures = 0;
            self.pause.succeed();
            self.longest = f64::INFINITY;
            if ratio.is_some_and(|ratio| ratio >= GOOD_RATIO) {
                self.weight /= FACTOR;
            }
        } else {
            self.failures += 1;
            self.weight *= FACTOR;
            self.longest = SHORTER * proposal.step_length;
            if self.failures >= PATIENCE {
                self.pause.fail(MAX_PAUSE);
            }
        }
    }
}

impl<O: NonsmoothObjective> Run<'_, '_, O> {
    /// The trial point of the composite model, none where it has none; ends the run at a point that it proves stationary.
    pub(super) fn composite_trial(&mut self) -> ControlFlow<Termination, Option<Proposal>> {
        let proposal = self.next_composite_trial()?;
        if let Some(composite) = &mut self.composite {
            composite.proposing = proposal.is_some();
        }
        Continue(proposal)
    }

    fn next_composite_trial(&mut self) -> ControlFlow<Termination, Option<Proposal>> {
        let Some(composite) = &mut self.composite else { return Continue(None) };
        if let Some(excursion) = composite.excursion.take() {
            return self.continue_excursion(excursion);
        }
        let Some(base) = composite.base.clone().filter(|_| composite.pause.pass()) else { return Continue(None) };
        let mut weight = composite.weight;
        if let Some(rejected) = composite.rejected.take() {
            if let Some(proposal) = self.correction(&base, &rejected)? {
                return Continue(Some(proposal));
            }
            if let Some(composite) = &mut self.composite {
                composite.bends = true;
            }
        }
        let (mut raised, mut last) = (false, None::<Proposal>);
        for _ in 0..MAX_WEIGHTS {
            let Some((proposal, step)) = self.composite_step(&base, weight, None)? else { return Continue(None) };
            if let Some(word) = self.composite_word(&proposal) {
                return self.leave(Proof { word, base, step, proposal });
            }
            let longest = self.composite.as_ref().map_or(0.0, |composite| composite.longest);
            if proposal.predicted_decrease > self.small() {
                if proposal.step_length <= longest {
                    return Continue(Some(proposal));
                }
                (weight, raised) = (weight * FACTOR, true);
                continue;
            }
            weight /= FACTOR;
            if std::mem::take(&mut raised) {
                // What a step short enough promises is little: only a longer one, with the curvature seen since, can tell.
                if let Some(composite) = &mut self.composite {
                    composite.longest = f64::INFINITY;
                }
            } else if last.is_some_and(|last| proposal.predicted_decrease < LEAST_GAIN * last.predicted_decrease) {
                // The weight matters no more: the model's own last step, little as it promises, leads to a point that it can prove.
                let seen = proposal.predicted_decrease > self.state.rounding() && longest == f64::INFINITY;
                return Continue(Some(proposal).filter(|_| seen));
            }
            last = Some(proposal);
        }
        Continue(None)
    }

    /// A step on from a rejected trial point, if it is so short that it leads below the center.
    ///
    /// A step along a curved kink of h leaves the kink, by second order in its length, and pays for it by first order (Maratos
    /// effect): the model at its end leads back.
    fn correction(&mut self, base: &Base, rejected: &Base) -> ControlFlow<Termination, Option<Proposal>> {
        let Some(composite) = &mut self.composite else { return Continue(None) };
        let weight = composite.weight / FACTOR;
        let origin = &base.point - &rejected.point;
        let Some((proposal, _)) = self.composite_step_near(rejected, weight, None, Some(&origin))? else {
            return Continue(None);
        };
        let length = self.state.norm.length(&(&proposal.trial - &rejected.point));
        let first = self.state.norm.length(&(&rejected.point - &base.point));
        let predicted_decrease = base.value - rejected.value + proposal.predicted_decrease;
        if length > CONTRACTION * first || predicted_decrease <= self.small() {
            return Continue(None);
        }
        if let Some(composite) = &mut self.composite {
            composite.correcting = true;
        }
        Continue(Some(Proposal { predicted_decrease, ..proposal }))
    }

    /// The step of the model at a base with a weight, and the trial point that it leads to; none where the subproblem cannot be
    /// solved. `set`: the admissible set, if it is not that of the run.
    pub(super) fn composite_step(
        &mut self,
        base: &Base,
        weight: f64,
        set: Option<&Polyhedron>,
    ) -> ControlFlow<Termination, Option<(Proposal, CompositeStep)>> {
        self.composite_step_near(base, weight, set, None)
    }

    fn composite_step_near(
        &mut self,
        base: &Base,
        weight: f64,
        set: Option<&Polyhedron>,
        origin: Option<&Vector>,
    ) -> ControlFlow<Termination, Option<(Proposal, CompositeStep)>> {
        let before = self.solver.counts();
        let step = self.solve_composite(base, weight, set, origin);
        self.count_solves(before);
        match step.and_then(|step| Ok((self.composite_proposal(base, &step, weight)?, step))) {
            Err(error @ SubproblemError::NotConvex { .. }) => {
                Break(Termination::SubproblemFailed { reason: error.to_string() })
            }
            Err(_) => Continue(None),
            Ok(found) => Continue(Some(found)),
        }
    }

    /// Solves the subproblem, with the curvature of the outputs for the weights of its own solution.
    fn solve_composite(
        &mut self,
        base: &Base,
        weight: f64,
        set: Option<&Polyhedron>,
        origin: Option<&Vector>,
    ) -> Result<CompositeStep, SubproblemError> {
        let (Some(outer), Some(composite)) = (self.objective.outer(), &mut self.composite) else {
            return Err(SubproblemError::Unusable);
        };
        let jacobian = &base.linearization.jacobian;
        let model = CompositeModel {
            outer,
            linearization: &base.linearization,
            value: outer.value(&base.linearization.outputs),
            base: &base.point,
            norm: &self.state.norm,
            set: set.unwrap_or(&self.set),
            weight,
            curvature: None,
            origin,
        };
        if !composite.bends || outer.curvature(&base.linearization.outputs, jacobian).is_some() {
            return model.solve(&mut self.solver);
        }
        if composite.weights.is_none() {
            composite.weights = Some(model.solve(&mut self.solver)?.weights());
        }
        let mut step = None;
        for _ in 0..PASSES {
            let Some(weights) = &composite.weights else { break };
            let curvature = composite.memory.curvature((&base.point, jacobian), weights, model.norm);
            let model = CompositeModel { curvature: curvature.as_ref(), ..model };
            let found = model.solve(&mut self.solver)?;
            composite.weights = Some(found.weights());
            step = Some(found);
        }
        step.ok_or(SubproblemError::Unusable)
    }

    /// Learns from a trial point and what its evaluation says about the outputs; whether it brought a Jacobian.
    pub(super) fn learn_structure(
        &mut self,
        trial: &Trial<'_>,
        value: f64,
        linearization: Option<Result<Linearization, String>>,
    ) -> Option<Result<(), String>> {
        let composite = self.composite.as_mut()?;
        if let Some(Ok(linearization)) = &linearization {
            composite.memory.remember(&trial.proposal.trial, &linearization.jacobian);
        }
        if composite.excursion.is_some() {
            return self.learn_excursion(trial, value, linearization);
        }
        if trial.proposal.origin == Origin::CompositeModel {
            let ratio = trial.comparison.change / trial.comparison.model_change;
            let correcting = std::mem::take(&mut composite.correcting);
            if correcting && !trial.serious {
                composite.bends = true;
            }
            if trial.serious || !correcting {
                composite.learn(trial.proposal, Some(ratio), trial.serious);
            }
            if !trial.serious && !correcting {
                if let Some(Ok(linearization)) = linearization {
                    let point = trial.proposal.trial.clone();
                    composite.rejected = Some(Base { point, value, linearization });
                }
                return None;
            }
        }
        if !trial.serious {
            return None;
        }
        self.rebase(&trial.proposal.trial, value, linearization)
    }

    /// Takes note that the oracle failed at a trial point.
    pub(super) fn shorten_composite(&mut self, proposal: &Proposal) {
        let Some(composite) = &mut self.composite else { return };
        if let Some(excursion) = &mut composite.excursion {
            excursion.give_up();
        } else if proposal.origin == Origin::CompositeModel {
            composite.learn(proposal, None, false);
        }
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
        composite.rejected = None;
        Some(linearization?.map(|linearization| {
            self.state.counts.jacobians += 1;
            composite.memory.remember(point, &linearization.jacobian);
            composite.base = Some(Base { point: point.clone(), value, linearization });
        }))
    }

    fn composite_proposal(&self, base: &Base, step: &CompositeStep, weight: f64) -> Result<Proposal, SubproblemError> {
        let state = &self.state;
        let outputs = &base.linearization.outputs;
        let errors = step.cuts.iter().map(|cut| cut.multiplier * cut.error(outputs, base.value).max(0.0));
        let (error, length) = (errors.sum::<f64>(), state.norm.length(&step.step));
        let rows = step.row_multipliers.rows(0, self.set.rows().nrows()).into_owned();
        let sides = (&rows, &step.bound_multipliers);
        let slack = slack_error(sides, &base.point, &self.set);
        let aggregate = base.linearization.jacobian.tr_mul(&step.weights());
        let trial = &base.point + &step.step;
        let proposal = Proposal {
            step: &trial - &state.center,
            trial,
            step_length: length,
            predicted_decrease: step.decrease,
            cut_change: 0.0,
            aggregate_sizes: aggregate_sizes(std::iter::once((1.0, &aggregate)), sides, &self.set),
            slack_error: slack,
            aggregate_norm: step.aggregate_norm,
            aggregate_error: error + slack,
            cut_error: error,
            cut_multipliers: vec![0.0; state.bundle.cuts().len()],
            bound_multipliers: step.bound_multipliers.clone(),
            row_multipliers: rows,
            convexification: 0.0,
            weight,
            violation: 0.0,
            origin: Origin::CompositeModel,
        };
        proposal.admissible(&self.set, state)
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
