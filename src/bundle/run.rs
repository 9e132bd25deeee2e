//! A run, driven step by step with at most one evaluation per step.

use super::builder::BundleTrust;
use super::constrained::WorkingSet;
use super::oracle::{Oracle, OracleResult, evaluate};
use super::proof::{Ending, Proof};
use super::proposers::list::Proposers;
use super::proposers::proposal::Proposal;
use super::proposers::proposer::{Answer as Proposed, Position, Proposer};
use super::record::{Event, record};
use super::resolution::Resolution;
use super::state::BundleState;
use super::trial::{Trial, descent_target};
use super::{demand, limits, noise, verdict};
use crate::composite::{Linearization, LinearizationRequest, Linearized, OuterFunction};
use crate::interruption::until;
use crate::qp::{EpigraphQpSolver, IndependentRows, nearest};
use crate::report::{IterationRecord, Noted, Origin, StepKind, Termination};
use crate::{Accuracy, Answer, Evaluation, OracleError, Request, Vector};
use std::ops::ControlFlow::{self, Break, Continue};
use std::rc::Rc;
use std::time::Instant;

/// Failures end the run only where the oracle fails next to the center: within this share of the length scale.
const CLOSE: f64 = 1e-6;
/// Share of a stationary violation up to which another point violates the constraints less.
const LESS_VIOLATED: f64 = 0.99;
/// Known trial points in a row after which no weight leads away from them.
const MAX_KNOWN_TRIALS: usize = 100;

/// A run of [`BundleTrust`], driven by hand.
///
/// ```
/// use nonsmooth::{BundleTrust, BundleTrustConfig, FnObjective, Vector};
/// let theta = FnObjective::new(1, |x: &Vector| (x[0].abs(), Vector::from_element(1, x[0].signum())));
/// let mut method = BundleTrust::new(BundleTrustConfig::default())?;
/// let mut run = method.start(&theta, Vector::from_element(1, 2.5))?;
/// while run.step().is_continue() && run.value() > 1.0 {}
/// assert!(run.value() <= 1.0);
/// while run.step().is_continue() {}
/// assert!(run.finish().value < 1e-9);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct Run<'r, 'o> {
    pub(super) method: &'r mut BundleTrust<'o>,
    pub(super) oracle: Box<dyn Oracle + 'r>,
    /// The convex function of a composite objective, if its model is wanted.
    pub(super) outer: Option<&'r dyn OuterFunction>,
    /// The admissible set without equality rows that depend on others.
    pub(super) rows: IndependentRows,
    /// The set of the subproblems where there are nonlinear constraints, with the center and the linearizations that it
    /// belongs to.
    pub(super) working: Option<((u64, u64), Rc<WorkingSet>)>,
    pub(super) state: BundleState,
    pub(super) solver: EpigraphQpSolver,
    pub(super) proposers: Proposers,
    pub(super) termination: Option<Termination>,
    /// The proof that has ended the run.
    pub(super) proof: Option<Proof>,
    pub(super) clock: Instant,
    /// The center at which ways out of a stationary violation were last tried, and how many.
    pub(super) ways_out: (u64, usize),
}

impl Run<'_, '_> {
    /// One step with at most one evaluation: of a trial point, or of the center once more where its accuracy no longer
    /// suffices. `Break` when the run has ended; further calls repeat the reason.
    pub fn step(&mut self) -> ControlFlow<Termination> {
        if let Some(termination) = &self.termination {
            return Break(termination.clone());
        }
        let Break(Ending { termination, proof }) = self.advance() else { return Continue(()) };
        self.proof = proof;
        self.termination = Some(termination.clone());
        Break(termination)
    }

    /// One round of the method: a trial point and its evaluation, or the end of the run.
    fn advance(&mut self) -> ControlFlow<Ending> {
        self.state.counts.iterations += 1;
        if let Break(limit) = limits::check(&self.state, self.method, self.seconds()) {
            return Break(self.standing_proof(limit));
        }
        if self.working_set().is_some_and(|working| working.stationary) {
            return self.lead_out();
        }
        let proposal = self.propose()?;
        let (state, config) = (&self.state, &self.method.config);
        if demand::center_is_too_coarse(state, config, proposal.predicted_decrease) {
            return self.refine_center(&proposal);
        }
        if proposal.is_too_short(&state.center) {
            return Break(self.too_short(proposal));
        }
        let accuracy = demand::for_trial(state, config, proposal.least_decrease());
        if state.bundle.knows(&proposal.trial, demand::largest_error(config, proposal.predicted_decrease)) {
            return self.leave_known_point(proposal);
        }
        let target = descent_target(state, &proposal);
        // The correction of a rejected step of the composite model needs the Jacobian at the rejected point.
        let everywhere = proposal.origin == Origin::CompositeModel || self.state.constraints.is_some();
        let below = if everywhere { f64::INFINITY } else { target };
        match self.evaluate(&proposal.trial, accuracy, Some(target), below) {
            OracleResult::MinusInfinity => return Break(Termination::UnboundedBelow.into()),
            OracleResult::Failure(OracleError::Interrupted) => return self.interrupted(),
            OracleResult::Failure(error) => self.shorten(&proposal, accuracy, &error)?,
            OracleResult::Answer(answer) => self.accept_or_reject(&proposal, accuracy, *answer),
        }
        limits::after_evaluation(&self.state, self.method).map_break(Into::into)
    }

    /// A point a first step away from a center at which the violation is stationary: along the objective, then both
    /// ways along a direction without pattern, where the violation may fall to second order. One that violates the
    /// constraints less becomes the center; the run ends where none does.
    fn lead_out(&mut self) -> ControlFlow<Ending> {
        let violation = self.state.violation();
        let end = || Break(Termination::Infeasible { violation }.into());
        let Some((trial, number)) = self.way_out() else { return end() };
        self.ways_out = (self.state.center_id, number + 1);
        let Some(proof) = self.ask(|proposers, at| proposers.plain_proof(at)) else { return end() };
        let Ok(proposal) = proof.proposal.moved_to(trial, &self.rows.set, &self.state) else { return Continue(()) };
        let accuracy = demand::for_trial(&self.state, &self.method.config, self.state.center_value.abs());
        match self.evaluate(&proposal.trial, accuracy, None, f64::INFINITY) {
            OracleResult::MinusInfinity => return Break(Termination::UnboundedBelow.into()),
            OracleResult::Failure(OracleError::Interrupted) => return self.interrupted(),
            OracleResult::Failure(error) => self.shorten(&proposal, accuracy, &error)?,
            OracleResult::Answer(answer) => {
                let mut evaluation = answer.into_evaluation();
                let (known, noted) = self.take_linearization(std::mem::take(&mut evaluation.linearization));
                self.learn_slope(&evaluation);
                let (known_before, found) = (&self.state.constraints, &evaluation.constraints);
                let left = known_before.as_ref().zip(found.as_ref()).map(|(own, found)| own.violation(&found.values));
                self.state.add_cut(&self.method.config, &proposal.trial, &evaluation, false);
                let kind = if left.is_some_and(|left| left <= LESS_VIOLATED * violation) {
                    self.state.move_center(accuracy);
                    self.oracle.keep_warm_start();
                    self.tell(|proposer, at| proposer.recenter(at, known.as_ref()));
                    StepKind::Serious
                } else {
                    self.state.reject_constraints();
                    StepKind::Null
                };
                let event = Event { kind, value: Some(evaluation.value), failure: None, noted, work: evaluation.work };
                record(&mut self.state, &proposal, accuracy, event, self.clock);
            }
        }
        limits::after_evaluation(&self.state, self.method).map_break(Into::into)
    }

    /// The next point to be tried where the violation is stationary, with its number; none after the last one.
    fn way_out(&self) -> Option<(Vector, usize)> {
        let (state, n) = (&self.state, self.state.center.len());
        let tried = if self.ways_out.0 == state.center_id { self.ways_out.1 } else { 0 };
        let objective = state.bundle.cut(state.center_id).map(|cut| -state.norm.raise_index(&cut.subgradient));
        let aside = Vector::from_fn(n, |i, _| without_pattern(i) * state.norm.unit(i));
        let ways = [objective.unwrap_or_else(|| Vector::zeros(n)), aside.clone(), -aside];
        ways.into_iter().enumerate().skip(tried).find_map(|(number, way)| {
            let length = state.norm.length(&way);
            let trial = &state.center + way * (state.first_step / length);
            (length > 0.0).then(|| nearest(&self.rows.set, &trial).ok()).flatten().map(|trial| (trial, number))
        })
    }

    /// The next trial point, or the end: by a proof, or because the time of the run passes before either is found.
    fn propose(&mut self) -> ControlFlow<Ending, Proposal> {
        let deadline = limits::deadline(&self.method.config, self.clock);
        match until(deadline, || self.ask(|proposers, at| proposers.propose(at))) {
            // What a subproblem that ended early leaves says nothing about the objective.
            (Proposed::Trial(_), true) => Break(self.standing_proof(Termination::TimeLimit)),
            (Proposed::End(ending), true) if ending.proof.is_none() => {
                Break(self.standing_proof(Termination::TimeLimit))
            }
            (Proposed::Trial(proposal), false) => Continue(self.steered(*proposal)),
            (Proposed::End(ending), _) => Break(*ending),
            (Proposed::Silent, _) => unreachable!("the plain cuts have an answer"),
        }
    }

    /// Asks the proposers at the present center and counts the subproblems that they solve.
    pub(super) fn ask<T>(&mut self, question: impl FnOnce(&mut Proposers, &mut Position<'_>) -> T) -> T {
        // An answer depends on the state of the run alone, not on what the solver remembers of earlier subproblems.
        self.solver.forget();
        let before = self.solver.counts();
        let working = self.working_set();
        let set = working.as_ref().map_or(&self.rows.set, |working| &working.set);
        let (config, outer, working) = (&self.method.config, self.outer, working.as_deref());
        let mut at = Position { state: &mut self.state, set, working, config, solver: &mut self.solver, outer };
        let answer = question(&mut self.proposers, &mut at);
        let (after, counts) = (self.solver.counts(), &mut self.state.counts);
        counts.qp_solves += after.solves - before.solves;
        counts.qp_fallbacks += after.fallbacks - before.fallbacks;
        answer
    }

    /// Tells all proposers something about the run.
    pub(super) fn tell(&mut self, news: impl Fn(&mut dyn Proposer, &mut Position<'_>)) {
        self.ask(|proposers, at| proposers.all().for_each(|proposer| news(proposer, at)));
    }

    /// The set of the subproblems at the present center, where there are nonlinear constraints.
    fn working_set(&mut self) -> Option<Rc<WorkingSet>> {
        let constraints = self.state.constraints.as_deref()?;
        let wanted = (self.state.center_id, constraints.revision());
        match &self.working {
            Some((known, working)) if *known == wanted => Some(Rc::clone(working)),
            _ => {
                let negligible = Resolution::new(&self.state, &self.method.config).tolerance();
                let reach = self.state.length_scale().max(self.state.first_step);
                let (center, norm) = (&self.state.center, &self.state.norm);
                let working =
                    WorkingSet::new(&self.rows.set, constraints, center, norm, negligible, reach, &mut self.solver);
                let working = Rc::new(working);
                self.working = Some((wanted, Rc::clone(&working)));
                Some(working)
            }
        }
    }

    /// A trial point with the decrease of the merit that its model predicts. The penalty exceeds the multipliers of its
    /// subproblem, and away from feasible points it lets the merit fall by at least half of what the violation
    /// promises.
    fn steered(&mut self, mut proposal: Proposal) -> Proposal {
        let Some(working) = self.working_set() else { return proposal };
        let Some(constraints) = &mut self.state.constraints else { return proposal };
        let sum = working.multipliers(&proposal);
        if let Some(left) = proposal.leaves {
            constraints.sensitivity = sum;
            proposal.predicted_decrease += constraints.penalty * (constraints.center_violation() - left);
            return proposal;
        }
        if working.restoring() && working.of_pieces && constraints.penalty > 0.0 {
            // The multipliers of rows that leave hardly any violation say little about what the violation is worth.
            constraints.sensitivity = sum;
        } else {
            constraints.raise_penalty(sum, proposal.aggregate_norm);
        }
        if working.restoring() {
            // Far cuts of a nonconvex objective say nothing about what the violation is worth: the center's own does.
            let center = self.state.bundle.cut(self.state.center_id);
            let risen = center.map_or(0.0, |cut| cut.subgradient.dot(&proposal.step));
            if 0.5 * constraints.penalty * working.reduction < risen {
                constraints.penalty = (4.0 * risen / working.reduction).min(10.0 * constraints.penalty);
            }
            let (objective, gained) = (proposal.predicted_decrease, constraints.penalty * working.reduction);
            proposal.predicted_decrease = (objective + gained).max(0.1 * gained);
            proposal.restores =
                objective <= constraints.penalty * working.reduction && working.forces(proposal.step_length);
        }
        proposal
    }

    /// The end by a limit, unless the center has been confirmed before.
    fn standing_proof(&mut self, limit: Termination) -> Ending {
        self.proposers.standing_proof().unwrap_or_else(|| limit.into())
    }

    /// The end at a step that brings nothing although the model promises a decrease.
    fn too_short(&mut self, proposal: Proposal) -> Ending {
        let termination = self.ask(|_, at| verdict::too_short(at, &proposal));
        let standing = self.proposers.standing_proof();
        standing.unwrap_or(Ending { termination, proof: None })
    }

    /// Changes the step to a known point without an evaluation. The run ends where the weight cannot change any more,
    /// or does not lead away: values and subgradients contradict each other, since the cuts of exact ones would predict
    /// what is known.
    fn leave_known_point(&mut self, proposal: Proposal) -> ControlFlow<Ending> {
        let before = self.state.weight;
        self.state.known_trials += 1;
        self.tell(|proposer, at| proposer.leave_known_point(at, &proposal));
        let stuck = proposal.origin == Origin::Cuts && self.state.weight == before;
        if stuck || self.state.known_trials >= MAX_KNOWN_TRIALS {
            return Break(self.too_short(proposal));
        }
        Continue(())
    }

    /// Evaluates Θ, with a descent target if there is one; `below` is the value of Θ up to which a Jacobian is wanted.
    pub(super) fn evaluate(
        &mut self,
        point: &Vector,
        accuracy: Accuracy,
        target: Option<f64>,
        below: f64,
    ) -> OracleResult {
        self.state.counts.evaluations += 1;
        self.state.known_trials = 0;
        let linearization = self.outer.map(|_| LinearizationRequest::below(below));
        let request = Request { point, warm_start: None, accuracy, descent_target: target, linearization };
        let longest = self.state.longest_slope().map(|longest| (longest, &self.state.norm));
        let constraints = self.state.constraints.as_ref().map_or(0, |constraints| constraints.kinds().len());
        evaluate(self.oracle.as_mut(), &request, constraints, longest)
    }

    /// Decides between serious and null step, and updates proposers, bundle and center.
    fn accept_or_reject(&mut self, proposal: &Proposal, accuracy: Accuracy, answer: Answer<()>) {
        let accurate = matches!(answer, Answer::Accurate(_));
        let mut evaluation = answer.into_evaluation();
        let (known, noted) = self.take_linearization(std::mem::take(&mut evaluation.linearization));
        self.state.failures = 0;
        self.state.longest_step = None;
        if accurate {
            noise::watch(&mut self.state, self.method.config.convexity, proposal, &evaluation);
            self.learn_slope(&evaluation);
        }
        let trial = Trial::new(&self.state, proposal, &evaluation, accurate, known.as_ref());
        self.tell(|proposer, at| proposer.learn(at, &trial));
        let violated = self.working.as_ref().zip(self.state.constraints.as_deref_mut());
        if let (Some(((_, working), constraints)), Some(found)) =
            (violated, trial.constraints.filter(|_| accurate && proposal.leaves.is_none()))
        {
            working.learn(constraints, proposal.step_length, trial.serious, &found.values);
        }
        self.state.add_cut(&self.method.config, &proposal.trial, &evaluation, !accurate);
        let kind = if trial.serious {
            self.state.move_center(accuracy);
            self.oracle.keep_warm_start();
            StepKind::Serious
        } else if accurate {
            self.state.remember_lowest();
            self.state.reject_constraints();
            StepKind::Null
        } else {
            StepKind::NoDescent
        };
        self.tell(|proposer, at| proposer.update(at, &trial));
        let event = Event { kind, value: Some(evaluation.value), failure: None, noted, work: evaluation.work };
        record(&mut self.state, proposal, accuracy, event, self.clock);
    }

    /// Takes the first subgradient of the objective that is not 0 as the unit of weights and penalty, where that of the
    /// start is 0.
    fn learn_slope(&mut self, evaluation: &Evaluation<()>) {
        let state = &mut self.state;
        let (Some(constraints), Some(found)) = (&mut state.constraints, &evaluation.constraints) else { return };
        if constraints.objective_slope > 0.0 {
            return;
        }
        let slope = state.norm.dual_length(&evaluation.subgradient);
        constraints.learn_slope(slope, evaluation.value - state.center_value, &found.values);
        if slope > 0.0 {
            state.weight = slope / state.first_step;
        }
    }

    /// Counts a Jacobian; returns the linearization, if there is one, and what the record says about it.
    pub(super) fn take_linearization(&mut self, linearized: Linearized) -> (Option<Linearization>, Noted) {
        match linearized {
            Linearized::NotAsked => (None, Noted::Nothing),
            Linearized::Unavailable(reason) => (None, Noted::NoJacobian(reason)),
            Linearized::Known(known) => {
                self.state.counts.jacobians += 1;
                (Some(known), Noted::Jacobian)
            }
        }
    }

    /// Evaluates the center again, more accurately.
    fn refine_center(&mut self, proposal: &Proposal) -> ControlFlow<Ending> {
        let accuracy = demand::for_center(&self.state, &self.method.config, proposal.predicted_decrease);
        let center = self.state.center.clone();
        self.state.center_accuracy = accuracy.tolerance();
        let mut contradiction = Continue(());
        let mut event =
            Event { kind: StepKind::Refinement, value: None, failure: None, noted: Noted::Nothing, work: 0 };
        match self.evaluate(&center, accuracy, None, f64::INFINITY) {
            OracleResult::Answer(answer) if matches!(*answer, Answer::Accurate(_)) => {
                let mut evaluation = answer.into_evaluation();
                let old = self.state.center_id;
                (event.value, event.work) = (Some(evaluation.value), evaluation.work);
                let (known, noted) = self.take_linearization(std::mem::take(&mut evaluation.linearization));
                event.noted = noted;
                self.state.add_cut(&self.method.config, &center, &evaluation, false);
                self.state.move_center(accuracy);
                self.oracle.keep_warm_start();
                self.state.bundle.retain(|cut| cut.id != old);
                self.tell(|proposer, at| proposer.recenter(at, known.as_ref()));
            }
            OracleResult::Failure(OracleError::Interrupted) => return self.interrupted(),
            OracleResult::Failure(error) => {
                event.failure = Some(error.to_string());
                contradiction = refuse_contradiction(&error);
            }
            _ => event.failure = Some("no accurate value at the center".to_owned()),
        }
        record(&mut self.state, proposal, accuracy, event, self.clock);
        contradiction?;
        limits::after_evaluation(&self.state, self.method).map_break(Into::into)
    }

    /// Takes a failed evaluation, which gives no cut: the proposer of the point shortens its next step. Proposers that
    /// fail pause, so that after repeated failures the steps of the plain cuts tell whether the oracle fails next to
    /// the center.
    fn shorten(&mut self, proposal: &Proposal, accuracy: Accuracy, error: &OracleError) -> ControlFlow<Ending> {
        let state = &mut self.state;
        state.failures += 1;
        state.longest_step = Some(0.5 * proposal.step_length);
        let failures = state.failures;
        // The first step from a start at zero is no length of the variables: it follows from Θ, shifts included.
        let close = proposal.step_length <= (CLOSE * state.length_scale()).max(f64::EPSILON * state.first_step);
        self.tell(|proposer, at| proposer.shorten(at, proposal));
        let failure = Some(error.to_string());
        let event = Event { kind: StepKind::Failed, value: None, failure, noted: Noted::Nothing, work: 0 };
        record(&mut self.state, proposal, accuracy, event, self.clock);
        refuse_contradiction(error)?;
        // Each failure halves the step.
        if failures >= 10 && proposal.origin == Origin::Cuts && close {
            return Break(Termination::OracleFailing { failures, last: error.to_string() }.into());
        }
        Continue(())
    }

    /// Ends the run because the oracle was interrupted; the evaluation that was under way does not count.
    fn interrupted(&mut self) -> ControlFlow<Ending> {
        self.state.counts.evaluations -= 1;
        Break(Termination::StoppedByObserver.into())
    }

    /// Seconds since the start.
    fn seconds(&self) -> f64 {
        self.clock.elapsed().as_secs_f64()
    }

    /// The stability center: the trial point of the last serious step, or the start.
    pub fn center(&self) -> &Vector {
        &self.state.center
    }

    /// Θ at the center, as it was last evaluated there.
    pub fn value(&self) -> f64 {
        self.state.center_value
    }

    /// One record per evaluation so far; one that ended the run with Θ = −∞ has none.
    pub fn history(&self) -> &[IterationRecord] {
        &self.state.history
    }
}

/// Entry i of a direction without pattern.
pub(super) fn without_pattern(i: usize) -> f64 {
    (1.7 * i as f64 + 0.5).cos()
}

/// Ends the run if an answer of the oracle contradicts an earlier one: whatever the model has learned may be of another
/// function.
fn refuse_contradiction(error: &OracleError) -> ControlFlow<Ending> {
    let OracleError::Contradiction(reason) = error else { return Continue(()) };
    Break(Termination::OracleContradiction { reason: reason.to_string() }.into())
}
