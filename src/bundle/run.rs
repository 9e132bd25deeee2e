//! A run, driven step by step with at most one evaluation per step.

use super::builder::BundleTrust;
use super::composite::{Composite, Proof};
use super::config::AccuracyPolicy;
use super::cut::{Cut, MAX_RELATIVE_SLOPE};
use super::event::Event;
use super::oracle::{Oracle, Outcome, evaluate};
use super::proposers::cuts::{self, model::Model};
use super::proposers::list::Proposers;
use super::proposers::proposal::{Proposal, SubproblemError};
use super::proposers::proposer::Position;
use super::state::State;
use crate::composite::OuterFunction;
use crate::interruption::{interrupted, until};
use crate::qp::{EpigraphQpSolver, QpCounts};
use crate::report::{IterationRecord, Origin, StepKind, Termination};
use crate::{Accuracy, Answer, OracleError, Polyhedron, Request, Vector};
use std::ops::ControlFlow::{self, Break, Continue};
use std::time::{Duration, Instant};

/// A center that is evaluated again is asked for this share of the accuracy that would just do.
const REFINEMENT_SHARE: f64 = 0.03;
/// A trial point that differs from the center by less than this share of every variable cannot be told from it.
const SHORTEST_MOVE: f64 = 4.0 * f64::EPSILON;
/// Failures end the run only where the oracle fails next to the center: within this share of the length scale.
const CLOSE: f64 = 1e-6;
/// Known trial points in a row after which no weight leads away from them.
const MAX_KNOWN_TRIALS: usize = 100;
/// Weights tried before a subproblem counts as unsolvable.
const MAX_SUBPROBLEM_TRIALS: usize = 4;

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
    /// The convex function of a composite objective.
    pub(super) outer: Option<&'r dyn OuterFunction>,
    pub(super) set: Polyhedron,
    pub(super) state: State,
    pub(super) solver: EpigraphQpSolver,
    pub(super) proposers: Proposers,
    /// The model of center and bundle, as long as they stay.
    pub(super) model: Option<Model>,
    /// The model before: the next one takes over the slopes that stay.
    pub(super) former_model: Option<Model>,
    /// The answer of the last plain subproblem, as long as center and bundle are those it was solved for.
    pub(super) proposal: Option<Proposal>,
    pub(super) termination: Option<Termination>,
    /// The composite model, if the objective has its structure.
    pub(super) composite: Option<Composite>,
    /// The proof of the composite model that the center is stationary, once this proof has ended the run.
    pub(super) proof: Option<Proof>,
    pub(super) clock: Instant,
}

impl Run<'_, '_> {
    /// One step with at most one evaluation: of a trial point, or of the center once more where its accuracy no longer suffices.
    /// `Break` when the run has ended; further calls repeat the reason.
    pub fn step(&mut self) -> ControlFlow<Termination> {
        if let Some(termination) = &self.termination {
            return Break(termination.clone());
        }
        let flow = self.advance().map_break(|word| self.after_second_look(word));
        if let Break(termination) = &flow {
            self.termination = Some(termination.clone());
        }
        flow
    }

    fn advance(&mut self) -> ControlFlow<Termination> {
        if let Break(limit) = self.check_limits() {
            return Break(self.end_excursion().unwrap_or(limit));
        }
        // A step depends on the state of the run alone, not on what the solver remembers of earlier subproblems.
        self.solver.forget();
        let proposal = self.propose_in_time()?;
        if self.center_is_too_coarse(&proposal) {
            return self.refine_center(&proposal);
        }
        if let Break(word) = self.check_length(&proposal) {
            return Break(self.end_excursion().unwrap_or(word));
        }
        if self.is_known(&proposal) {
            return self.leave_known_point(&proposal);
        }
        let accuracy = self.wanted_accuracy(proposal.predicted_decrease);
        let target = self.state.center_value - self.method.config.serious_fraction * proposal.predicted_decrease;
        // The correction of a rejected step of the composite model needs the Jacobian at the rejected point.
        let below = if proposal.origin == Origin::CompositeModel { f64::INFINITY } else { target };
        match self.evaluate(&proposal.trial, accuracy, Some(target), below) {
            Outcome::MinusInfinity => return Break(Termination::UnboundedBelow),
            Outcome::Failure(OracleError::Interrupted) => return self.interrupted(),
            Outcome::Failure(error) => self.shorten(&proposal, accuracy, &error)?,
            Outcome::Answer(answer) => self.accept_or_reject(proposal, accuracy, answer),
        }
        self.after_evaluation()
    }

    /// The next trial point, unless the time of the run passes before it is found.
    fn propose_in_time(&mut self) -> ControlFlow<Termination, Proposal> {
        let seconds = self.method.config.max_seconds.and_then(|limit| Duration::try_from_secs_f64(limit).ok());
        let deadline = seconds.and_then(|limit| self.clock.checked_add(limit));
        match until(deadline, || self.propose()) {
            // What a subproblem that ended early leaves says nothing about the objective.
            (Continue(_) | Break(Termination::StoppedByObserver | Termination::SubproblemFailed { .. }), true) => {
                Break(self.end_excursion().unwrap_or(Termination::TimeLimit))
            }
            (flow, _) => flow,
        }
    }

    fn propose(&mut self) -> ControlFlow<Termination, Proposal> {
        if let Some(proposal) = self.composite_trial()? {
            return Continue(proposal);
        }
        let plain = self.next_trial()?;
        let chosen = self.choose_trial(plain);
        Continue(self.shortened(chosen))
    }

    fn check_limits(&mut self) -> ControlFlow<Termination> {
        self.state.counts.iterations += 1;
        let config = &self.method.config;
        if self.state.counts.evaluations >= config.max_evaluations {
            Break(Termination::EvaluationLimit)
        } else if self.state.counts.iterations > config.max_iterations {
            Break(Termination::IterationLimit)
        } else if config.max_seconds.is_some_and(|limit| self.seconds() >= limit) {
            Break(Termination::TimeLimit)
        } else {
            Continue(())
        }
    }

    /// Ends the run when the trial point cannot be told from the center.
    fn check_length(&self, proposal: &Proposal) -> ControlFlow<Termination> {
        let moved = proposal.trial.iter().zip(self.state.center.iter());
        if moved.into_iter().any(|(y, x)| (y - x).abs() > SHORTEST_MOVE * x.abs()) {
            return Continue(());
        }
        Break(self.too_short(proposal))
    }

    /// Why the run ends at a step that brings nothing although the model promises a decrease.
    fn too_short(&self, proposal: &Proposal) -> Termination {
        if self.noise_level() > 0.0 {
            Termination::NoiseLimit { estimate: self.noise_level().max(self.state.gap_bound(proposal, &self.set)) }
        } else {
            Termination::StepTooShort { predicted_decrease: proposal.predicted_decrease }
        }
    }

    /// Whether a cut knows the trial point as accurately as it would be asked for: an evaluation would tell nothing new.
    fn is_known(&self, proposal: &Proposal) -> bool {
        let accurate = |cut: &Cut| match self.method.config.accuracy {
            AccuracyPolicy::Tightest => true,
            AccuracyPolicy::OnDemand { factor, .. } => cut.error_bound <= factor * proposal.predicted_decrease,
        };
        let cuts = self.state.bundle.cuts().iter().filter(|cut| !cut.certified);
        cuts.into_iter().any(|cut| cut.point == proposal.trial && accurate(cut))
    }

    /// Shortens the step to a known point without an evaluation, or lengthens it where noise hides what it promises. The run ends where
    /// the weight cannot change any more, or does not lead away: values and subgradients contradict each other, since the cuts of exact
    /// ones would predict what is known.
    fn leave_known_point(&mut self, proposal: &Proposal) -> ControlFlow<Termination> {
        let before = self.state.weight;
        self.state.known_trials += 1;
        if proposal.origin == Origin::Cuts && self.is_hidden_by_noise(proposal) {
            self.state.set_weight(before / 10.0, &self.method.config);
        } else {
            self.proposers.shorten(&mut self.state, &self.method.config, proposal);
            self.shorten_composite(proposal);
        }
        self.proposal = None;
        let stuck = proposal.origin == Origin::Cuts && self.state.weight == before;
        if stuck || self.state.known_trials >= MAX_KNOWN_TRIALS {
            return Break(self.end_excursion().unwrap_or_else(|| self.too_short(proposal)));
        }
        Continue(())
    }

    /// Evaluates Θ, with a descent target if there is one; `below` is the value of Θ up to which a Jacobian is wanted.
    fn evaluate(&mut self, point: &Vector, accuracy: Accuracy, target: Option<f64>, below: f64) -> Outcome {
        self.state.counts.evaluations += 1;
        self.state.known_trials = 0;
        let linearization = self.composite.is_some().then(|| Composite::request(below));
        let request = Request { point, warm_start: None, accuracy, descent_target: target, linearization };
        match evaluate(self.oracle.as_mut(), &request) {
            Outcome::Answer(answer) => self.check_slope(answer),
            other => other,
        }
    }

    /// Turns an answer into a failure if its subgradient is so long that all others would drown in its rounding.
    fn check_slope(&self, answer: Answer<()>) -> Outcome {
        let state = &self.state;
        let allowed =
            MAX_RELATIVE_SLOPE * state.bundle.dual_lengths().fold(state.first_weight * state.first_step, f64::max);
        let size = state.norm.dual_length(&answer.evaluation().subgradient);
        if size <= allowed || allowed == 0.0 {
            Outcome::Answer(answer)
        } else {
            Outcome::Failure(OracleError::TooLarge { what: "subgradient", size, allowed })
        }
    }

    /// Solves the subproblem; where this fails, larger weights are tried before the run ends.
    pub(super) fn solve_subproblem(&mut self) -> ControlFlow<Termination, Proposal> {
        let mut last = SubproblemError::Unusable;
        for _ in 0..MAX_SUBPROBLEM_TRIALS {
            match self.try_subproblem() {
                // What an interrupted subproblem leaves says nothing about the objective.
                _ if interrupted() => return Break(Termination::StoppedByObserver),
                Ok(proposal) => return Continue(proposal),
                Err(error) => last = error,
            }
            let weight = self.state.weight * self.method.config.weight_increase;
            self.state.set_weight(weight, &self.method.config);
        }
        Break(Termination::SubproblemFailed { reason: last.to_string() })
    }

    /// Solves the plain subproblem at the weight of the run.
    pub(super) fn try_subproblem(&mut self) -> Result<Proposal, SubproblemError> {
        let proposal = self.ask(|_, position| cuts::propose(position))?;
        self.state.bundle.set_multipliers(&proposal.cut_multipliers);
        self.proposal = Some(proposal.clone());
        Ok(proposal)
    }

    /// The proposal worth an evaluation: that of the plain cuts or of a rival.
    fn choose_trial(&mut self, plain: Proposal) -> Proposal {
        if !self.proposers.has_rivals() {
            return plain;
        }
        let small = self.small();
        self.ask(|proposers, position| proposers.choose(position, plain, small))
    }

    /// Asks the proposers at the present position and counts the subproblems they solve.
    fn ask<T>(&mut self, question: impl FnOnce(&mut Proposers, &mut Position<'_>) -> T) -> T {
        let before = self.solver.counts();
        let config = &self.method.config;
        let former = &mut self.former_model;
        let model = self.model.take().unwrap_or_else(|| Model::new(&mut self.state, config, former.take()));
        let (state, set, solver) = (&self.state, &self.set, &mut self.solver);
        let answer = question(&mut self.proposers, &mut Position { state, set, solver, model: &model });
        self.model = Some(model);
        self.count_solves(before);
        answer
    }

    /// Drops the model and the answer of its subproblem, because the center or the bundle has changed.
    pub(super) fn forget_model(&mut self) {
        self.former_model = self.model.take().or(self.former_model.take());
        self.proposal = None;
    }

    /// Adds the subproblems solved since `before` to the report.
    pub(super) fn count_solves(&mut self, before: QpCounts) {
        let after = self.solver.counts();
        self.state.counts.qp_solves += after.solves - before.solves;
        self.state.counts.qp_fallbacks += after.fallbacks - before.fallbacks;
    }

    fn wanted_accuracy(&self, predicted_decrease: f64) -> Accuracy {
        let AccuracyPolicy::OnDemand { tightest, coarsest, factor } = self.method.config.accuracy else {
            return Accuracy::TIGHTEST;
        };
        let size = self.state.center_value.abs().max(f64::MIN_POSITIVE);
        let tolerance = (factor * predicted_decrease / size).clamp(tightest, coarsest);
        Accuracy::relative(tolerance).unwrap_or(Accuracy::TIGHTEST)
    }

    /// Whether the center's promised error hides the predicted decrease and a better value can be asked for.
    pub(super) fn center_is_too_coarse(&self, proposal: &Proposal) -> bool {
        let AccuracyPolicy::OnDemand { factor, .. } = self.method.config.accuracy else { return false };
        let wanted = self.wanted_accuracy(REFINEMENT_SHARE * proposal.predicted_decrease).tolerance();
        self.state.center_error_bound() > factor * proposal.predicted_decrease
            && wanted < 0.5 * self.state.center_accuracy
    }

    /// Evaluates the center again, to [`REFINEMENT_SHARE`] of the accuracy that the predicted decrease asks for.
    fn refine_center(&mut self, proposal: &Proposal) -> ControlFlow<Termination> {
        let accuracy = self.wanted_accuracy(REFINEMENT_SHARE * proposal.predicted_decrease);
        let center = self.state.center.clone();
        self.state.center_accuracy = accuracy.tolerance();
        let mut event = Event { kind: StepKind::Refinement, value: None, failure: None, linearized: None, work: 0 };
        match self.evaluate(&center, accuracy, None, f64::INFINITY) {
            Outcome::Answer(Answer::Accurate(mut evaluation)) => {
                let old = self.state.center_id;
                (event.value, event.work) = (Some(evaluation.value), evaluation.work);
                if let Some((known, noted)) = self.note(&center, evaluation.linearization.take()) {
                    event.linearized = noted;
                    self.forget_excursion();
                    self.rebase(&center, evaluation.value, known);
                }
                self.add_cut(center.clone(), &evaluation, false);
                self.move_center(center, evaluation.value, accuracy);
                self.state.bundle.retain(|cut| cut.id != old);
            }
            Outcome::Failure(OracleError::Interrupted) => return self.interrupted(),
            Outcome::Failure(error) => event.failure = Some(error.to_string()),
            _ => event.failure = Some("no accurate value at the center".to_owned()),
        }
        self.state.counts.refined += 1;
        self.record(proposal, accuracy, event);
        self.after_evaluation()
    }

    /// The proposal itself, or its step shortened to the length that a failed evaluation has left. A larger weight alone leaves the step as
    /// it is where cuts meet in a point.
    fn shortened(&mut self, proposal: Proposal) -> Proposal {
        let Some(longest) = self.state.longest_step.filter(|longest| proposal.step_length > *longest) else {
            return proposal;
        };
        let step = &proposal.step * (longest / proposal.step_length);
        let cut_change = self.ask(|_, position| position.model.cuts().change(&step));
        let (weight, origin) = (proposal.weight, proposal.origin);
        match proposal.replaced((step, weight, origin), (&self.set, &self.state), |_| cut_change) {
            Ok(shorter) => Proposal { cut_change, ..shorter },
            Err(_) => proposal,
        }
    }

    /// Takes a failed evaluation, which gives no cut: the proposer of the point shortens its next step. Proposers that fail pause, so
    /// that after repeated failures the steps of the plain cuts tell whether the oracle fails next to the center.
    fn shorten(&mut self, proposal: &Proposal, accuracy: Accuracy, error: &OracleError) -> ControlFlow<Termination> {
        let state = &mut self.state;
        state.counts.failed += 1;
        state.failures += 1;
        state.longest_step = Some(0.5 * proposal.step_length);
        let failures = state.failures;
        // The first step from a start at zero is no length of the variables: it follows from Θ, shifts included.
        let close = proposal.step_length <= (CLOSE * state.length_scale()).max(f64::EPSILON * state.first_step);
        self.proposers.shorten(state, &self.method.config, proposal);
        self.shorten_composite(proposal);
        let failure = Some(error.to_string());
        let event = Event { kind: StepKind::Failed, value: None, failure, linearized: None, work: 0 };
        self.record(proposal, accuracy, event);
        if failures >= self.method.config.max_failures && proposal.origin == Origin::Cuts && close {
            return Break(Termination::OracleFailing { failures, last: error.to_string() });
        }
        Continue(())
    }

    /// Ends the run because the oracle was interrupted; the evaluation that was under way does not count.
    fn interrupted(&mut self) -> ControlFlow<Termination> {
        self.state.counts.evaluations -= 1;
        Break(Termination::StoppedByObserver)
    }

    /// Seconds since the start.
    pub(super) fn seconds(&self) -> f64 {
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
