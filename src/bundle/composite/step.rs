//! Steps of the composite model: from a base, and on from a rejected trial point.

use super::base::Base;
use super::model::{CompositeModel, CompositeStep};
use super::proof::Proof;
use super::state::FACTOR;
use crate::bundle::proposers::aggregate::slack_error;
use crate::bundle::proposers::proposal::{Proposal, SubproblemError};
use crate::bundle::run::Run;
use crate::composite::Linearization;
use crate::panics::without_panic;
use crate::report::{Origin, Termination};
use crate::{Polyhedron, Vector};
use std::ops::ControlFlow::{self, Break, Continue};

/// Weights tried, upwards and downwards, for one trial point.
pub(super) const MAX_WEIGHTS: usize = 20;
/// Longest correction from a rejected trial point, in lengths of the rejected step.
const CONTRACTION: f64 = 0.5;
/// Subproblems solved in turn so that the weights of the outputs and the curvature formed with them fit together.
const PASSES: usize = 2;

impl Run<'_, '_> {
    /// A step on from a rejected trial point, if it is short beside the rejected step and promises a value below the center's.
    ///
    /// A step along a curved kink of h leaves the kink by second order in its length, and loses by first order in this distance
    /// (Maratos effect): the model at the end of the step leads back to the kink.
    pub(super) fn correction(&mut self, base: &Base, rejected: &Base) -> ControlFlow<Termination, Option<Proposal>> {
        let Some(composite) = &mut self.composite else { return Continue(None) };
        let weight = composite.weight / FACTOR;
        let origin = &base.point - &rejected.point;
        let Some((proposal, _)) = self.composite_step(rejected, weight, None, Some(&origin))? else {
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
    /// solved, or where h overflows along the step. `set`: the admissible set, if it is not that of the run; `origin`: the vector from
    /// the base to the point that lengths are measured from, if this point is not the base.
    pub(super) fn composite_step(
        &mut self,
        base: &Base,
        weight: f64,
        set: Option<&Polyhedron>,
        origin: Option<&Vector>,
    ) -> ControlFlow<Termination, Option<(Proposal, CompositeStep)>> {
        let before = self.solver.counts();
        let solved = without_panic(|| self.solve_composite(base, weight, set, origin));
        let step = solved.unwrap_or_else(|message| Err(SubproblemError::OuterPanicked { message }));
        self.count_solves(before);
        match step.and_then(|step| Ok((self.composite_proposal(base, &step, weight)?, step))) {
            Err(SubproblemError::Interrupted) => Break(Termination::StoppedByObserver),
            Err(error) if error.blames_outer() => Break(Termination::SubproblemFailed { reason: error.to_string() }),
            Err(_) => Continue(None),
            Ok(found) => Continue(Some(found)),
        }
    }

    /// Solves the subproblem. Once steps have failed without it, the curvature of the outputs is added, for the weights of the solution.
    fn solve_composite(
        &mut self,
        base: &Base,
        weight: f64,
        set: Option<&Polyhedron>,
        origin: Option<&Vector>,
    ) -> Result<CompositeStep, SubproblemError> {
        let (Some(outer), Some(composite)) = (self.outer, &mut self.composite) else {
            return Err(SubproblemError::Unusable);
        };
        let Linearization { outputs, jacobian, .. } = &base.linearization;
        // The number of outputs may change from point to point.
        composite.weights.take_if(|weights| weights.len() != outputs.len());
        let model = CompositeModel {
            outer,
            linearization: &base.linearization,
            value: outer.value(outputs),
            base: &base.point,
            norm: &self.state.norm,
            set: set.unwrap_or(&self.set),
            weight,
            curvature: None,
            origin,
        };
        composite.bent = false;
        if !composite.bends || outer.curvature(outputs, jacobian).is_some() {
            return model.solve(&mut self.solver);
        }
        if composite.weights.is_none() {
            composite.weights = Some(model.solve(&mut self.solver)?.weights());
        }
        let mut step = None;
        for _ in 0..PASSES {
            let Some(weights) = &composite.weights else { break };
            let curvature = composite.memory.curvature((&base.point, jacobian), weights, model.norm);
            let curvature = curvature.map(|curvature| curvature * composite.bend);
            composite.bent = curvature.is_some();
            let model = CompositeModel { curvature: curvature.as_ref(), ..model };
            let found = model.solve(&mut self.solver)?;
            composite.weights = Some(found.weights());
            step = Some(found);
        }
        step.ok_or(SubproblemError::Unusable)
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
        let aggregate_norm =
            state.norm.dual_length(&(&aggregate + self.set.rows().tr_mul(&rows) + &step.bound_multipliers));
        let proposal = Proposal {
            step: &trial - &state.center,
            trial,
            step_length: length,
            predicted_decrease: step.decrease,
            cut_change: 0.0,
            composite_aggregate: Some(aggregate),
            slack_error: slack,
            aggregate_norm,
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

    /// The termination at a center that the model proves stationary; none if it does not.
    pub(super) fn composite_word(&self, proposal: &Proposal) -> Option<Termination> {
        if proposal.predicted_decrease > self.small() {
            return None;
        }
        self.bounded_word(proposal)
    }

    /// The termination at a center where the multipliers of a subproblem bound the decrease within reach by enough; none if they do not.
    fn bounded_word(&self, proposal: &Proposal) -> Option<Termination> {
        self.word_at_point(self.state.decrease_bound(proposal, &self.set))
    }

    /// The proof that a center is stationary from a subproblem with a lower weight and without the curvature of the outputs, if there is one.
    ///
    /// Gᵀw = −(u W + B) d − Aᵀμ − ν: where weight and curvature hold the step, a lower weight lets the multipliers balance. The bound
    /// of the decrease within reach is the same, whatever subproblem the multipliers come from.
    pub(super) fn lighter_proof(&mut self, base: &Base, weight: f64) -> ControlFlow<Termination, Option<Proof>> {
        let bends = self.composite.as_mut().is_some_and(|composite| std::mem::take(&mut composite.bends));
        let found = self.proof_below(base, weight);
        if let Some(composite) = &mut self.composite {
            composite.bends = bends;
        }
        found
    }

    fn proof_below(&mut self, base: &Base, mut weight: f64) -> ControlFlow<Termination, Option<Proof>> {
        let mut least = f64::INFINITY;
        for _ in 0..MAX_WEIGHTS {
            let Some((proposal, step)) = self.composite_step(base, weight, None, None)? else { break };
            if let Some(word) = self.bounded_word(&proposal) {
                return Continue(Some(Proof { word, base: base.clone(), step, proposal }));
            }
            let bound = self.state.decrease_bound(&proposal, &self.set);
            if bound >= least {
                break;
            }
            (least, weight) = (bound, weight / FACTOR);
        }
        Continue(None)
    }
}
