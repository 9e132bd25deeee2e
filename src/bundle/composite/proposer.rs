//! The trial points of the composite model, and the end of the run at a point that it proves stationary.

use super::base::Base;
use super::elastic::elastic;
use super::escape::Escape;
use super::kinks::{Kinks, Seen};
use super::proof::PointProof;
use super::steps::{Changes, Steps, are_curved};
use super::trust::Trust;
use super::weight_fit::WeightFit;
use crate::Vector;
use crate::bundle::constrained::WorkingSet;
use crate::bundle::evidence::Evidence;
use crate::bundle::proof::{Ending, Proof};
use crate::bundle::proposers::proposal::Proposal;
use crate::bundle::proposers::proposer::{Answer, Position, Proposer};
use crate::bundle::state::{LEAST_WEIGHT, OutputScales};
use crate::bundle::trial::Trial;
use crate::bundle::verdict::{Verdict, allowed, verdict};
use crate::composite::{Linearization, OuterFunction};
use crate::panics::without_panic;
use crate::report::{Origin, Termination};

/// Weights tried, upwards and downwards, for one trial point.
const MAX_WEIGHTS: usize = 20;
/// Factor of the promised decrease below which a tenth of the weight has brought nothing beside curvature.
const SAME_DECREASE: f64 = 1.01;
/// Evaluations that a run spends on the bound of a convex problem once its end is confirmed.
const MAX_FOR_BOUND: usize = 4;
/// Each of them promises this many times what rounding hides.
const WORTHWHILE: f64 = 10.0;

/// The composite model of a run.
#[derive(Debug)]
pub(crate) struct Composite {
    trust: Trust,
    steps: Steps,
    kinks: Kinks,
    /// Where the model is built: the center, if its Jacobian is known.
    base: Option<Base>,
    /// A rejected trial point with its Jacobian, and the violation that the step to it was to leave.
    rejected: Option<(Base, Option<f64>)>,
    /// Whether the pending trial point is a correction.
    correcting: bool,
    escape: Option<Escape>,
    /// Bounds of a convex problem that were larger than what may be left, each of which took one more step.
    bounds: Vec<f64>,
    /// The proof that stands while such a step is evaluated.
    confirmed: Option<(Ending, Base)>,
}

impl Composite {
    pub(crate) fn new(first_weight: f64) -> Self {
        Self {
            trust: Trust::new(first_weight),
            steps: Steps::default(),
            kinks: Kinks::default(),
            base: None,
            rejected: None,
            correcting: false,
            escape: None,
            bounds: vec![],
            confirmed: None,
        }
    }

    /// A step on from a rejected trial point, if it is short beside the rejected step and promises a value below the
    /// center's.
    ///
    /// A step along a curved kink of h leaves the kink by second order in its length, and loses by first order in this
    /// distance (Maratos effect): the model at the end of the step leads back to the kink. The same holds along curved
    /// constraints, whose linearizations at the end of the step lead back.
    fn correction(
        &mut self,
        at: &mut Position<'_>,
        base: &Base,
        rejected: &Base,
        leaves: Option<f64>,
    ) -> Result<Option<Proposal>, Termination> {
        let origin = &base.point - &rejected.point;
        let changes = Changes { set: None, origin: Some(&origin) };
        let longest = 0.5 * at.state.norm.length(&origin);
        let constraints = at.state.constraints.as_deref();
        let curved = at.outer.is_some_and(|outer| are_curved(outer, constraints));
        let there = at.working.zip(constraints).filter(|_| curved).and_then(|(working, known)| {
            let left = leaves.unwrap_or(at.state.violation() - working.reduction);
            working.leaving(left).at_rejected(&at.own_set(), known, &rejected.point)
        });
        let mut weight = self.trust.next.weight / 10.0;
        // Along constraints of several pieces that are kept, a correction that is too long is shortened.
        for _ in 0..(if at.of_pieces() && !at.restoring() { MAX_WEIGHTS } else { 1 }) {
            let found = match &there {
                Some(working) => self.steps.step(&mut at.within(working), rejected, weight, changes)?,
                None => self.steps.step(at, rejected, weight, changes)?,
            };
            let Some((proposal, _)) = found else { return Ok(None) };
            if at.state.norm.length(&(&proposal.trial - &rejected.point)) <= longest {
                let predicted_decrease = base.value - rejected.value + proposal.predicted_decrease;
                let worthwhile = at.restoring() || predicted_decrease > at.resolution().small();
                return Ok(Some(Proposal { predicted_decrease, leaves, ..proposal }).filter(|_| worthwhile));
            }
            weight *= 10.0;
        }
        Ok(None)
    }

    /// A step from a base that violates constraints; silent where there is none.
    fn restoring_step(&mut self, at: &mut Position<'_>, base: &Base) -> Result<Answer, Termination> {
        let mut weight = self.trust.next.weight.max(LEAST_WEIGHT);
        let mut fit = WeightFit::new(true);
        for _ in 0..MAX_WEIGHTS {
            if at.of_pieces() {
                let Some(proposal) = elastic(&mut self.steps, at, base, weight)? else { return Ok(Answer::Silent) };
                if let Some(proposal) = fit.next(proposal, self.trust.next.longest, &mut weight) {
                    return Ok(Answer::trial(proposal));
                }
                continue;
            }
            let found = self.steps.step(at, base, weight, Changes::default())?;
            let Some((proposal, _)) = found else { return Ok(Answer::Silent) };
            if at.trusts_restoring(proposal.step_length) {
                return Ok(Answer::trial(proposal));
            }
            weight *= 10.0;
        }
        Ok(fit.step().map_or(Answer::Silent, Answer::trial))
    }

    /// A step from the base that is worth an evaluation, or the proof that the base is stationary; silent where there
    /// is neither.
    fn step(&mut self, at: &mut Position<'_>, base: &Base) -> Result<Answer, Termination> {
        if at.restoring() {
            return self.restoring_step(at, base);
        }
        let small = at.resolution().small();
        let mut weight = self.trust.next.weight.max(LEAST_WEIGHT);
        let (mut raised, mut last) = (false, 0.0);
        let mut fit = WeightFit::new(at.of_pieces());
        for _ in 0..MAX_WEIGHTS {
            let Some((proposal, step)) = self.steps.step(at, base, weight, Changes::default())? else {
                (weight, raised) = (weight * 10.0, true);
                continue;
            };
            let promised = proposal.predicted_decrease;
            if promised > small {
                raised |= proposal.step_length > self.trust.next.longest;
                match fit.next(proposal, self.trust.next.longest, &mut weight) {
                    Some(proposal) => return Ok(Answer::trial(proposal)),
                    None => continue,
                }
            }
            let evidence = Evidence::new(at.state, at.set, &proposal);
            if let Verdict::End(termination) = verdict(at, &evidence) {
                let tightens = self.tightens(at, &termination, &proposal);
                let composite = Some(PointProof { base: base.clone(), step });
                let proof = Some(Proof { proposal: proposal.clone(), composite });
                let ending = Ending { termination, proof };
                if tightens {
                    self.confirmed = Some((ending, base.clone()));
                    return Ok(Answer::trial(proposal));
                }
                return Ok(self.leave(at, ending, base));
            }
            weight /= 10.0;
            let decided = evidence.undecided(allowed(&at.resolution(), false)).is_none();
            // Curvature of the outputs holds a step whatever the weight is. Beside constraints, lighter weights may
            // lead to others of them.
            let held = self.steps.needs_curvature && at.state.constraints.is_none();
            let same = if held { SAME_DECREASE } else { 1.0 };
            if raised || decided && promised <= same * last {
                // No step that has not been rejected promises more. What is small already may be proved to be all that
                // is left.
                return Ok(match self.lighter_proof(at, base, weight)? {
                    Some(ending) => self.leave(at, ending, base),
                    None if raised => Answer::Silent,
                    None => self.small_step(at, proposal),
                });
            }
            last = promised;
        }
        Ok(fit.step().map_or(Answer::Silent, Answer::trial))
    }

    /// Whether one more step is taken to tighten the bound of a convex problem: the aggregate subgradient at a center
    /// is of the order of the square root of its error, and the model converges fast.
    fn tightens(&mut self, at: &Position<'_>, end: &Termination, proposal: &Proposal) -> bool {
        let Termination::Stationary { gap: Some(gap), .. } = *end else { return false };
        let falls = self.bounds.last().is_none_or(|last| gap <= 0.5 * last);
        let large = gap > allowed(&at.resolution(), true);
        let tightens = large
            && falls
            && self.bounds.len() < MAX_FOR_BOUND
            && proposal.predicted_decrease > WORTHWHILE * at.state.rounding();
        if tightens {
            self.bounds.push(gap);
        }
        tightens
    }

    /// A step that promises little: the model may prove the point at its end stationary. Silent within a limit of
    /// length, where a longer step has been rejected: the cuts go on.
    fn small_step(&mut self, at: &Position<'_>, proposal: Proposal) -> Answer {
        if self.trust.next.longest < f64::INFINITY {
            self.trust.pause();
            Answer::Silent
        } else if proposal.predicted_decrease > at.state.rounding() {
            Answer::trial(proposal)
        } else {
            Answer::Silent
        }
    }

    /// The proof that a center is stationary from a subproblem with a lower weight and without the curvature of the
    /// outputs, if there is one.
    ///
    /// Gᵀw = −(u W + B) d − Aᵀμ − ν: where weight and curvature hold the step, a lower weight lets the multipliers
    /// balance. The bound of the decrease within reach is the same, whatever subproblem the multipliers come from.
    fn lighter_proof(
        &mut self,
        at: &mut Position<'_>,
        base: &Base,
        mut weight: f64,
    ) -> Result<Option<Ending>, Termination> {
        let needed = std::mem::take(&mut self.steps.needs_curvature);
        let mut least = f64::INFINITY;
        let mut found = Ok(None);
        for _ in 0..MAX_WEIGHTS {
            let (proposal, step) = match self.steps.step(at, base, weight, Changes::default()) {
                Ok(Some(solved)) => solved,
                Ok(None) => break,
                Err(termination) => {
                    found = Err(termination);
                    break;
                }
            };
            let evidence = Evidence::new(at.state, at.set, &proposal);
            if let Verdict::End(termination) = verdict(at, &evidence) {
                let composite = Some(PointProof { base: base.clone(), step });
                found = Ok(Some(Ending { termination, proof: Some(Proof { proposal, composite }) }));
                break;
            }
            let bound = evidence.remaining();
            let decided = evidence.undecided(allowed(&at.resolution(), false)).is_none();
            if decided && bound >= least {
                break;
            }
            (least, weight) = (bound, weight / 10.0);
        }
        self.steps.needs_curvature = needed;
        found
    }

    /// The end of the run with a proof, or a step that looks for something lower first.
    fn leave(&mut self, at: &mut Position<'_>, ending: Ending, base: &Base) -> Answer {
        let (escape, answer) = Escape::begin(at, &mut self.steps, ending, base);
        self.escape = escape;
        answer
    }

    fn answer(&mut self, at: &mut Position<'_>) -> Result<Answer, Termination> {
        if let Some(escape) = self.escape.take() {
            let (escape, answer) = escape.next(at, &mut self.steps);
            self.escape = escape;
            return Ok(answer);
        }
        if let Some((ending, base)) = self.confirmed.take() {
            return Ok(self.leave(at, ending, &base));
        }
        let Some(base) = self.base.clone().filter(|_| self.trust.pass()) else { return Ok(Answer::Silent) };
        if let Some((rejected, leaves)) = self.rejected.take() {
            if let Some(proposal) = self.correction(at, &base, &rejected, leaves)? {
                self.correcting = true;
                return Ok(Answer::trial(proposal));
            }
            self.steps.needs_curvature = true;
        }
        self.step(at, &base)
    }

    /// Builds the model at the center from now on. Without a Jacobian there, the model is silent until the center moves
    /// again.
    fn rebase(&mut self, at: &mut Position<'_>, linearization: Option<&Linearization>) {
        let (point, value) = (at.state.center.clone(), at.state.center_value);
        let known = at.outer.zip(linearization);
        let reach = at.state.reaches();
        at.state.output_scales = known.and_then(|(outer, known)| output_scales(outer, known, &reach));
        self.rejected = None;
        self.base = linearization.map(|known| Base { point, value, linearization: known.clone() });
    }

    /// Learns from a step whether the outputs have met kinks.
    fn watch_kinks(&mut self, outer: &dyn OuterFunction, trial: &Trial<'_>) {
        let Some(base) = &self.base else { return };
        let Trial { proposal, comparison, linearization, .. } = trial;
        let seen =
            Seen { outer, base, point: &proposal.trial, change: comparison.objective_change, end: *linearization };
        if proposal.origin != Origin::CompositeModel {
            if self.kinks.remain(&seen) {
                self.trust.prolong();
            }
        } else if self.kinks.met(&seen, proposal.predicted_decrease, trial.serious.then_some(-comparison.change)) {
            self.trust.pause();
        }
    }
}

/// Without linearizations at other points of curved constraints that give all their pieces at the center: such a
/// linearization is one of the same piece, and cuts off where the piece curves away from it. None where nothing is to
/// be left out, and where the violation determines the steps.
fn with_own_pieces(at: &Position<'_>) -> Option<WorkingSet> {
    let curved = at.outer.is_some_and(|outer| are_curved(outer, at.state.constraints.as_deref()));
    let working = at.working.filter(|working| curved && working.of_pieces && !working.restoring())?;
    let center = &at.state.center;
    let mut pieces = vec![0; working.kinds.len()];
    working.tangents.iter().filter(|own| *own.point == *center).for_each(|own| pieces[own.constraint] += 1);
    Some(working.filtered(|own| *own.point == *center || pieces[own.constraint] < 2))
}

/// A base at a trial point, where its Jacobian is known.
fn base_at(trial: &Trial<'_>) -> Option<Base> {
    let (point, value) = (trial.proposal.trial.clone(), trial.value);
    trial.linearization.map(|known| Base { point, value, linearization: known.clone() })
}

impl Proposer for Composite {
    fn propose(&mut self, at: &mut Position<'_>) -> Answer {
        let end = |termination: Termination| Answer::end(termination.into());
        match with_own_pieces(at) {
            Some(working) => self.answer(&mut at.within(&working)).unwrap_or_else(end),
            None => self.answer(at).unwrap_or_else(end),
        }
    }

    fn learn(&mut self, at: &mut Position<'_>, trial: &Trial<'_>) {
        let Some(outer) = at.outer else { return };
        if let Some(known) = trial.linearization {
            let curved = are_curved(outer, at.state.constraints.as_deref());
            self.steps.remember(outer, &trial.proposal.trial, known, trial.constraints, curved);
        }
        if self.escape.is_some() || self.confirmed.is_some() && !trial.serious {
            return;
        }
        if !trial.proposal.restores {
            self.watch_kinks(outer, trial);
        }
        let own = trial.proposal.origin == Origin::CompositeModel;
        let correcting = std::mem::take(&mut self.correcting);
        if !own {
            return;
        }
        let ratio = trial.comparison.change / trial.comparison.model_change;
        if trial.serious {
            self.trust.accept(trial.proposal, ratio);
        } else if correcting {
            self.steps.needs_curvature = true;
        } else {
            let forced = at.working.is_some_and(|working| working.forces(trial.proposal.step_length));
            if !forced || trial.proposal.leaves.is_some() {
                self.trust.reject(trial.proposal);
            }
            self.rejected = base_at(trial).map(|base| (base, trial.proposal.leaves));
        }
    }

    fn update(&mut self, at: &mut Position<'_>, trial: &Trial<'_>) {
        if let Some(mut escape) = self.escape.take() {
            if trial.serious {
                self.trust.next.weight = escape.weight;
            } else {
                escape.learn(trial.value, base_at(trial));
                self.escape = Some(escape);
            }
        }
        if trial.serious {
            self.confirmed = None;
            self.rebase(at, trial.linearization);
        }
    }

    fn shorten(&mut self, _at: &mut Position<'_>, proposal: &Proposal) {
        if let Some(escape) = &mut self.escape {
            escape.give_up();
        } else if proposal.origin == Origin::CompositeModel {
            self.correcting = false;
            self.trust.reject(proposal);
        }
    }

    fn recenter(&mut self, at: &mut Position<'_>, linearization: Option<&Linearization>) {
        // The center evaluated anew has outdated the proof.
        (self.escape, self.confirmed) = (None, None);
        if let (Some(outer), Some(known)) = (at.outer, linearization) {
            let constraints = at.state.constraints.as_deref();
            let curved = are_curved(outer, constraints);
            let found = constraints.map(|constraints| constraints.center_evaluation());
            self.steps.remember(outer, &at.state.center, known, found, curved);
        }
        self.rebase(at, linearization);
    }

    fn standing_proof(&mut self) -> Option<Ending> {
        let escape = self.escape.take().map(|escape| escape.ending);
        escape.or_else(|| self.confirmed.take().map(|(ending, _)| ending))
    }
}

/// The scale of Θ from outputs, their Jacobian and h; none where h gives no subgradient of the right size.
fn output_scales(outer: &dyn OuterFunction, known: &Linearization, reach: &Vector) -> Option<OutputScales> {
    let Linearization { outputs, jacobian, .. } = known;
    let weights = without_panic(|| outer.subgradient(outputs)).ok().filter(|w| w.len() == outputs.len())?;
    let sizes = jacobian.abs();
    let change = &sizes * reach;
    let rise = |sign: f64| outer.value(&(outputs + &change * sign)) - outer.value(outputs);
    // h need not be defined, or finite, on both sides.
    let known_rise = |sign: f64| without_panic(|| rise(sign)).ok().filter(|rise| rise.is_finite());
    let within_reach = [1.0, -1.0].into_iter().filter_map(known_rise).fold(0.0, f64::max);
    Some(OutputScales { slopes: sizes.tr_mul(&weights.abs()), within_reach })
}
