//! Steps of the composite model from a base, with or without the curvature of the outputs.

use super::base::Base;
use super::curvature::Memory;
use super::model::{CompositeModel, CompositeStep, OuterCut};
use crate::bundle::constrained::{Constraints, WorkingSet};
use crate::bundle::proposers::aggregate::slack_error;
use crate::bundle::proposers::proposal::{Proposal, SubproblemError};
use crate::bundle::proposers::proposer::Position;
use crate::composite::{Linearization, OuterFunction};
use crate::panics::without_panic;
use crate::report::{Origin, Termination};
use crate::{ConstraintEvaluation, ConstraintKind, Matrix, Polyhedron, Vector};
use std::rc::Rc;

/// A solved subproblem and the trial point that it leads to; none where the subproblem cannot be solved, or where h
/// overflows along the step.
pub(super) type Found = Option<(Proposal, CompositeStep)>;

/// Where a subproblem differs from that of the run.
#[derive(Clone, Copy, Default)]
pub(super) struct Changes<'a> {
    /// The admissible set, if it is not that of the run.
    pub set: Option<&'a Polyhedron>,
    /// The vector from the base to the point that lengths are measured from, if this point is not the base.
    pub origin: Option<&'a Vector>,
}

/// The subproblems of a run, with what they learn about the curvature of the outputs.
#[derive(Debug, Default)]
pub(super) struct Steps {
    /// Whether the curvature of the outputs counts: once a step and its correction have failed without it.
    pub needs_curvature: bool,
    memory: Memory,
    /// Weights of the outputs at the last subproblem's solution.
    weights: Option<Vector>,
}

impl Steps {
    /// The step of the model at a base with a weight.
    ///
    /// # Errors
    /// The end of the run: the outer function is not what it should be, or nobody waits for the answer.
    pub(super) fn step(
        &mut self,
        at: &mut Position<'_>,
        base: &Base,
        weight: f64,
        changes: Changes<'_>,
    ) -> Result<Found, Termination> {
        let solved = without_panic(|| self.solve(at, base, weight, changes));
        let step = solved.unwrap_or_else(|message| Err(SubproblemError::OuterPanicked { message }));
        match step.and_then(|step| Ok((proposal(at, base, &step, weight)?, step))) {
            Err(SubproblemError::Interrupted) => Err(Termination::StoppedByObserver),
            Err(error) if error.blames_outer() => Err(Termination::SubproblemFailed { reason: error.to_string() }),
            Err(_) => Ok(None),
            Ok(found) => Ok(Some(found)),
        }
    }

    /// Remembers a Jacobian, unless h has a curvature of its own and no constraints are [`curved`](are_curved): the
    /// model then uses no curvature of the outputs.
    pub(super) fn remember(
        &mut self,
        outer: &dyn OuterFunction,
        point: &Vector,
        known: &Linearization,
        constraints: Option<&ConstraintEvaluation>,
        curved: bool,
    ) {
        let Linearization { outputs, jacobian, .. } = known;
        let own = || without_panic(|| outer.curvature(outputs, jacobian).is_some()).unwrap_or(true);
        if curved || !own() {
            self.memory.remember(point, &stacked(jacobian, constraints.map(|found| &found.jacobian)));
        }
    }

    /// Solves the subproblem. Once steps have failed without it, the curvature of the outputs is added, for the weights
    /// of the solution. Beside constraints of known curvature, it is added at once, with theirs: along a curved
    /// constraint every step meets it.
    fn solve(
        &mut self,
        at: &mut Position<'_>,
        base: &Base,
        weight: f64,
        changes: Changes<'_>,
    ) -> Result<CompositeStep, SubproblemError> {
        let Some(outer) = at.outer else { return Err(SubproblemError::Unusable) };
        let Linearization { outputs, jacobian, .. } = &base.linearization;
        let model = CompositeModel {
            outer,
            linearization: &base.linearization,
            value: outer.value(outputs),
            base: &base.point,
            norm: &at.state.norm,
            set: changes.set.unwrap_or(at.set),
            weight,
            curvature: None,
            origin: changes.origin,
        };
        let constraints = at.state.constraints.as_deref();
        let curved = are_curved(outer, constraints);
        if !curved && (!self.needs_curvature || outer.curvature(outputs, jacobian).is_some()) {
            return model.solve(at.solver);
        }
        let all = stacked(jacobian, constraints.and_then(|found| found.jacobian_at(&base.point)));
        if all.nrows() < jacobian.nrows() + constraints.map_or(0, |found| found.kinds().len()) {
            return model.solve(at.solver);
        }
        let working = at.working;
        let weights_of = |step: &CompositeStep| all_weights(step, working, &all, base);
        if self.weights.is_none() {
            self.weights = Some(weights_of(&model.solve(at.solver)?));
        }
        // Twice in turn, so that the weights of the outputs and the curvature formed with them fit together.
        let kind = (constraints.is_none(), at.of_pieces() && !at.restoring());
        let mut step = None;
        for _ in 0..2 {
            let Some(weights) = &self.weights else { break };
            let curvature = self.memory.curvature(&base.point, &all, weights, kind, model.norm);
            let found = CompositeModel { curvature: curvature.as_ref(), ..model }.solve(at.solver)?;
            self.weights = Some(weights_of(&found));
            step = Some(found);
        }
        step.ok_or(SubproblemError::Unusable)
    }
}

/// The Jacobian of the outputs above that of the constraints.
fn stacked(outputs: &Matrix, constraints: Option<&Matrix>) -> Matrix {
    let Some(constraints) = constraints else { return outputs.clone() };
    let mut all = outputs.clone().resize_vertically(outputs.nrows() + constraints.nrows(), 0.0);
    all.rows_mut(outputs.nrows(), constraints.nrows()).copy_from(constraints);
    all
}

/// Whether Jacobians at other points tell the curvature of some constraints: of smooth ones, and of functions of the
/// outputs.
pub(super) fn are_curved(outer: &dyn OuterFunction, constraints: Option<&Constraints>) -> bool {
    let is_smooth = |kind: &ConstraintKind| *kind != ConstraintKind::Nonsmooth;
    constraints.is_some_and(|found| found.kinds().iter().any(is_smooth) || !outer.constraint_kinds().is_empty())
}

/// The weights of the outputs above the multipliers of the constraints, in the units of the constraints. A piece of a
/// nonsmooth constraint that is an output, ±c_i less a bound, counts as this output.
fn all_weights(step: &CompositeStep, working: Option<&WorkingSet>, rows: &Matrix, base: &Base) -> Vector {
    let weights = step.weights();
    let Some(working) = working else { return weights };
    let first = weights.len();
    let mut all = weights.resize_vertically(rows.nrows(), 0.0);
    let multipliers = step.row_multipliers.iter().skip(working.own_rows);
    for (tangent, multiplier) in working.tangents.iter().zip(multipliers).filter(|(_, multiplier)| **multiplier != 0.0)
    {
        let share = multiplier / working.units[tangent.constraint];
        if working.kinds[tangent.constraint] != ConstraintKind::Nonsmooth {
            all[first + tangent.constraint] += share;
        } else if *tangent.point == base.point {
            let is_row =
                |sign: f64, row: usize| tangent.slope.iter().zip(rows.row(row).iter()).all(|(a, b)| *a == sign * b);
            let found = (0..first)
                .find_map(|row| [1.0, -1.0].into_iter().find(|sign| is_row(*sign, row)).map(|sign| (row, sign)));
            found.into_iter().for_each(|(row, sign)| all[row] += sign * share);
        }
    }
    all
}

fn proposal(at: &Position<'_>, base: &Base, step: &CompositeStep, weight: f64) -> Result<Proposal, SubproblemError> {
    let (state, set) = (&*at.state, at.set);
    let outputs = &base.linearization.outputs;
    let largest = |cut: &OuterCut| cut.error(outputs, base.value).max(0.0) + cut.rounding(outputs, base.value);
    let errors = step.cuts.iter().map(|cut| cut.multiplier * largest(cut));
    let (error, length) = (errors.sum::<f64>(), state.norm.length(&step.step));
    let rows = step.row_multipliers.rows(0, set.rows().nrows()).into_owned();
    let slack = slack_error(&rows, &step.bound_multipliers, &base.point, set);
    let aggregate = base.linearization.jacobian.tr_mul(&step.weights());
    let trial = &base.point + &step.step;
    let aggregate_norm = state.norm.dual_length(&(&aggregate + set.rows().tr_mul(&rows) + &step.bound_multipliers));
    let proposal = Proposal {
        step: &trial - &state.center,
        trial,
        step_length: length,
        predicted_decrease: if at.restoring() && !at.of_pieces() { step.outer_decrease } else { step.decrease },
        cut_change: 0.0,
        composite_aggregate: Some(aggregate),
        slack_error: slack,
        aggregate_norm,
        aggregate_error: error + slack,
        cut_error: error,
        cut_multipliers: vec![0.0; state.bundle.cuts().len()],
        bound_multipliers: step.bound_multipliers.clone(),
        row_multipliers: rows,
        tangents: at.working.map(|working| Rc::clone(&working.tangents)),
        convexification: 0.0,
        weight,
        violation: 0.0,
        origin: Origin::CompositeModel,
        restores: false,
        leaves: None,
    };
    proposal.admissible(set, state)
}
