//! The test for the end: what to do when the cutting-plane model promises almost nothing.
//!
//! ```text
//! lower the weight, without evaluations, until the evidence suffices or the predicted decrease is not small
//! active cuts away from the center:   restart from the cuts next to the center, then evaluate next to it (confirmation.rs)
//! ```
//! A small predicted decrease at a large weight is not stationarity (a flat valley, a variable whose unit hides it),
//! and one that rests on cuts far from the center is none either where Θ is not convex: both are checked before a run
//! ends. For a function declared convex the cuts bound Θ(x̂) − Θ(y) within reach, wherever they lie.

use super::confirmation::{Confirmation, Confirmed};
use super::planes::{CuttingPlanes, MAX_DECREASES};
use super::weight::WeightRule;
use crate::bundle::demand;
use crate::bundle::evidence::{Evidence, active_cuts};
use crate::bundle::proof::Ending;
use crate::bundle::proposers::proposal::Proposal;
use crate::bundle::proposers::proposer::Position;
use crate::bundle::trial::Trial;
use crate::bundle::verdict::{Verdict, allowed, unconfirmed, verdict};
use crate::report::Origin;
use std::ops::ControlFlow::{self, Break, Continue};

/// The weight is lowered until the step has this relative length. Ten times as short steps leave ten times as much
/// within reach.
const LEAST_STEP_LENGTH: f64 = 1e-2;
/// Restarts without progress between them once Θ is known to be nonconvex; one before.
const MAX_RESTARTS: usize = 5;
/// The outcome of the test of a subproblem.
pub(super) enum Next {
    /// A trial point of the cuts.
    Trial(Proposal),
    /// A trial point next to the center.
    Given(Proposal),
    End(Box<Ending>),
}

/// The test for the end of a run.
#[derive(Debug, Default)]
pub(super) struct StationarityTest {
    /// Restarts since the last serious step that fell by more than the tolerance.
    restarts: usize,
    /// The confirmation of the center that is under way.
    confirmation: Option<Confirmation>,
}

impl StationarityTest {
    /// A trial point worth an evaluation, or the end.
    pub(super) fn next(&mut self, at: &mut Position<'_>, planes: &mut CuttingPlanes) -> Next {
        if self.confirmation.is_some() {
            return self.confirm(at);
        }
        loop {
            let proposal = match planes.solve(at) {
                Ok(proposal) => proposal,
                Err(termination) => return Next::End(Box::new(termination.into())),
            };
            if at.restoring() {
                return Next::Trial(proposal);
            }
            let convex = at.is_convex();
            let resolution = at.resolution();
            let limit =
                if convex { allowed(&resolution, true).max(resolution.hidden_by_noise()) } else { resolution.small() };
            let promised = proposal.predicted_decrease;
            if promised > limit || demand::center_is_too_coarse(at.state, at.config, promised) {
                return Next::Trial(proposal);
            }
            let kept = at.state.weight;
            let (evidence, proposal) = match look_closer(at, planes, proposal) {
                Break(next) => return next,
                Continue(found) => found,
            };
            at.state.weight = kept;
            if self.may_restart(at) && self.restart(at, planes, &proposal) {
                continue;
            }
            let termination = unconfirmed(at, &evidence);
            if !at.config.confirm || evidence.undecided(allowed(&resolution, false)).is_some() {
                return Next::End(Box::new(Ending::by_cuts(termination, proposal)));
            }
            self.confirmation = Some(Confirmation::new(at, proposal, termination));
            return self.confirm(at);
        }
    }

    /// Goes on with the confirmation.
    fn confirm(&mut self, at: &mut Position<'_>) -> Next {
        match self.confirmation.as_mut().map(|confirmation| confirmation.next(at)) {
            Some(Confirmed::Trial(proposal)) => Next::Given(*proposal),
            Some(Confirmed::End(ending)) => Next::End(ending),
            None => unreachable!("a confirmation is under way"),
        }
    }

    /// Takes note that the center has been evaluated anew.
    pub(super) fn recenter(&mut self) {
        self.confirmation = None;
    }

    /// Takes note of the newest cut.
    pub(super) fn update(&mut self, at: &Position<'_>, trial: &Trial<'_>) {
        if let Some(confirmation) = self.confirmation.as_mut().filter(|_| trial.proposal.origin == Origin::Confirmation)
        {
            confirmation.learn(at.state.bundle.cuts().last());
        }
    }

    /// Takes note of an evaluated trial point.
    pub(super) fn learn(&mut self, at: &Position<'_>, trial: &Trial<'_>) {
        if trial.serious && -trial.comparison.change > at.resolution().tolerance() {
            *self = Self::default();
        }
    }

    fn may_restart(&self, at: &Position<'_>) -> bool {
        self.restarts < if at.state.nonconvex { MAX_RESTARTS } else { 1 }
    }

    /// Forgets the cuts beyond a tenth of the radius of the active ones and raises the weight for a short next step;
    /// false if there was nothing to forget.
    fn restart(&mut self, at: &mut Position<'_>, planes: &mut CuttingPlanes, proposal: &Proposal) -> bool {
        self.restarts += 1;
        at.state.counts.restarts += 1;
        let state = &mut *at.state;
        let farthest = active_cuts(state, proposal).map(|cut| cut.farthest_from(&state.center, &state.norm));
        let radius = farthest.fold(0.0, f64::max) / 10.0;
        let before = state.bundle.cuts().len();
        let (center, center_id, norm) = (&state.center, state.center_id, &state.norm);
        state.bundle.retain(|cut| cut.id == center_id || cut.farthest_from(center, norm) <= radius);
        if state.bundle.cuts().len() == before {
            return false;
        }
        let slope = state.bundle.cut(center_id).map_or(0.0, |cut| norm.dual_length(&cut.subgradient));
        let weight = state.weight.max(10.0 * slope / radius);
        state.set_weight(weight);
        planes.weight_rule = WeightRule::default();
        true
    }
}

/// Lowers the weight, without evaluations, until the evidence suffices, the predicted decrease is not small, or the
/// step is long enough to tell. Breaks with a trial point or the end; goes on with the last evidence where the cuts do
/// not suffice.
fn look_closer(
    at: &mut Position<'_>,
    planes: &mut CuttingPlanes,
    mut proposal: Proposal,
) -> ControlFlow<Next, (Evidence, Proposal)> {
    let convex = at.is_convex();
    let small = at.resolution().small();
    let (mut worthwhile, mut hidden) = (None, None);
    let mut decreases = 0;
    loop {
        if proposal.predicted_decrease > small {
            if !convex {
                return Break(Next::Trial(proposal));
            }
            worthwhile = worthwhile.or(Some(proposal.weight));
        }
        let evidence = Evidence::new(at.state, at.set, &proposal);
        let found = verdict(at, &evidence);
        let undecided = evidence.undecided(allowed(&at.resolution(), convex)).is_some();
        let long = !undecided && proposal.step_length >= LEAST_STEP_LENGTH * at.state.length_scale();
        let next = if long && !convex || decreases == MAX_DECREASES { None } else { planes.lower_weight(at) };
        match found {
            Verdict::End(termination)
                if next.is_none() || convex && termination.is_confirmed() || evidence.is_exact(0.0) =>
            {
                return Break(Next::End(Box::new(Ending::by_cuts(termination, proposal))));
            }
            // A lower weight may have multipliers of cuts that rounding or noise hides less.
            Verdict::End(termination) if convex => {
                hidden = hidden.or(Some(Ending::by_cuts(termination, proposal.clone())))
            }
            _ => {}
        }
        let Some(next) = next else {
            if let Some(ending) = hidden {
                return Break(Next::End(Box::new(ending)));
            }
            return if convex { Break(last_trial(at, planes, worthwhile)) } else { Continue((evidence, proposal)) };
        };
        (proposal, decreases) = (next, decreases + 1);
    }
}

/// The trial point of the largest weight at which the predicted decrease is not small, or of the last one tried.
fn last_trial(at: &mut Position<'_>, planes: &mut CuttingPlanes, worthwhile: Option<f64>) -> Next {
    at.state.weight = worthwhile.unwrap_or(at.state.weight);
    planes.solve(at).map_or_else(|termination| Next::End(Box::new(termination.into())), Next::Trial)
}
