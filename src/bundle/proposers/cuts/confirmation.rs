//! Evaluations next to the center, for the proof of an end.
//!
//! ```text
//! points of the active cuts, drawn towards the center on the straight line
//! x̂ + d for the step d of the cuts next to the center alone, shortened          until they prove the center stationary, or Θ falls
//! ```
//! Where Θ need not be convex, active cuts away from the center prove nothing, although their pieces may meet at the
//! center. At most one evaluation more than there are variables is spent on pieces next to it. A point that is clearly
//! lower becomes the center and ends the confirmation.

use super::planes::{CuttingPlanes, MAX_DECREASES};
use crate::Vector;
use crate::bundle::constrained::Tangent;
use crate::bundle::cut::Cut;
use crate::bundle::evidence::{Distances, Evidence, active_cuts};
use crate::bundle::kept_cuts::Bundle;
use crate::bundle::proof::Ending;
use crate::bundle::proposers::proposal::{Proposal, SERIOUS_FRACTION};
use crate::bundle::proposers::proposer::Position;
use crate::bundle::resolution::Resolution;
use crate::bundle::verdict::{Near, confirmed, near, near_verdict};
use crate::report::{Origin, Termination};

/// The confirmation of an end.
#[derive(Debug)]
pub(super) struct Confirmation {
    /// Drawn points left to evaluate.
    points: Vec<Vector>,
    /// The cuts next to the center.
    near: Vec<Cut>,
    /// The levels of small decreases at the center, from all cuts.
    resolution: Resolution,
    /// The answer of the subproblem with all cuts.
    of: Proposal,
    /// The end of the run if the cuts next to the center do not suffice.
    unconfirmed: Termination,
    /// The weight at which they are asked.
    weight: f64,
    /// Number of evaluations that the confirmation may still spend.
    left: usize,
    /// Whether a step has been evaluated that promises more than may be left.
    probed: bool,
}

/// The next step of a confirmation: a trial point, or the end of the run.
pub(super) enum Confirmed {
    Trial(Box<Proposal>),
    End(Box<Ending>),
}

impl Confirmation {
    /// The confirmation of a center whose active cuts lie away from it.
    pub(super) fn new(at: &Position<'_>, of: Proposal, unconfirmed: Termination) -> Self {
        let state = &*at.state;
        let resolution = at.resolution();
        let (distances, near) = (Distances::new(state), near(&resolution));
        let cuts = active_cuts(state, &of).map(|cut| (distances.of(cut), cut));
        // A trial point often lies on a kink, where the last bit chooses the subgradient: a share of the way leads
        // along the subgradient itself.
        let toward = |point: &Vector, subgradient: &Vector| {
            let (line, aside) = (point - &state.center, distances.raise(subgradient));
            let share = |step: &Vector, part: f64| part * near / distances.length(step);
            &state.center + &line * share(&line, 0.5) + &aside * share(&aside, 0.05)
        };
        let of_cuts =
            cuts.filter(|(distance, _)| *distance > near).map(|(_, cut)| toward(&cut.point, &cut.subgradient));
        let far = |tangent: &&Tangent| distances.length(&(&*tangent.point - &state.center)) > near;
        let tangents = of.active_tangents().map(|(tangent, _)| tangent).filter(far);
        let points = of_cuts.chain(tangents.map(|tangent| toward(&tangent.point, &tangent.slope))).collect();
        let kept = state.bundle.cuts().iter().filter(|cut| cut.id == state.center_id || distances.of(cut) <= near);
        let left = state.center.len() + 1;
        Self {
            points,
            near: kept.cloned().collect(),
            resolution,
            of,
            unconfirmed,
            weight: state.weight,
            left,
            probed: false,
        }
    }

    /// The next point to evaluate, or the end of the run.
    pub(super) fn next(&mut self, at: &mut Position<'_>) -> Confirmed {
        while let Some(point) = self.points.pop().filter(|_| self.left > 0) {
            if let Some(proposal) = self.trial(at, point) {
                return Confirmed::Trial(Box::new(proposal));
            }
        }
        let all = self.look_near(at);
        let found = self.ask_near(at);
        at.state.weight = self.weight;
        let point = match found {
            // The certificate is that of the cuts next to the center: they stay in the bundle.
            Some((Near::Confirmed, evidence, proposal)) => {
                return ended(Ending::by_cuts(confirmed(&evidence), proposal));
            }
            Some((Near::Falls, evidence, proposal)) if self.probed => {
                return ended(Ending::by_cuts(confirmed(&evidence), proposal));
            }
            Some((near, _, proposal)) if self.left > 0 => Some(self.toward(at, &near, &proposal)),
            _ => None,
        };
        at.state.bundle = all;
        match point.and_then(|point| self.trial(at, point)) {
            Some(proposal) => Confirmed::Trial(Box::new(proposal)),
            None => ended(self.unconfirmed.clone().into()),
        }
    }

    /// The point to evaluate on the step of the cuts next to the center: where they promise more than may be left, or
    /// next to the center where their subgradients do not cancel.
    fn toward(&mut self, at: &Position<'_>, near_cuts: &Near, proposal: &Proposal) -> Vector {
        let share = if matches!(near_cuts, Near::Falls) {
            self.probed = true;
            10.0 * self.resolution.small() / proposal.predicted_decrease
        } else {
            let length = Distances::new(at.state).length(&proposal.step);
            (0.5 * near(&self.resolution) / length).min(1.0)
        };
        &at.state.center + &proposal.step * share
    }

    /// What the cuts next to the center say at the largest weight that confirms, or at which their promise is not
    /// small. A large weight asks for small errors, a small one for subgradients that cancel.
    fn ask_near(&self, at: &mut Position<'_>) -> Option<(Near, Evidence, Proposal)> {
        let Some(working) = at.working else { return self.ask_within(at) };
        let (distances, near) = (Distances::new(at.state), near(&self.resolution));
        let center = &at.state.center;
        let working = working.filtered(|tangent| distances.length(&(&*tangent.point - center)) <= near);
        self.ask_within(&mut at.within(&working))
    }

    /// The answer of the cuts next to the center in the set given.
    fn ask_within(&self, at: &mut Position<'_>) -> Option<(Near, Evidence, Proposal)> {
        let mut planes = CuttingPlanes::default();
        let mut proposal = planes.try_solve(at).ok()?;
        let mut decreases = 0;
        loop {
            let evidence = Evidence::new(at.state, at.set, &proposal);
            let found = near_verdict(at.state.center_value, &self.resolution, &evidence, &proposal);
            let done = matches!(found, Near::Confirmed)
                || proposal.predicted_decrease > near(&self.resolution)
                || decreases == MAX_DECREASES;
            decreases += 1;
            match planes.lower_weight(at).filter(|_| !done) {
                Some(lower) => proposal = lower,
                None => return Some((found, evidence, proposal)),
            }
        }
    }

    /// Puts the cuts next to the center in the place of all cuts, which are returned.
    fn look_near(&self, at: &mut Position<'_>) -> Bundle {
        let mut local = Bundle::default();
        self.near.iter().for_each(|cut| local.push(cut.clone(), &at.state.norm));
        at.state.weight = self.weight;
        std::mem::replace(&mut at.state.bundle, local)
    }

    /// Takes in the newest cut.
    pub(super) fn learn(&mut self, newest: Option<&Cut>) {
        self.near.extend(newest.cloned());
    }

    /// The evaluation of a point, which counts as clearly lower if it brings a small decrease.
    fn trial(&mut self, at: &Position<'_>, point: Vector) -> Option<Proposal> {
        let predicted_decrease = self.resolution.small() / SERIOUS_FRACTION;
        let proposal = self.of.moved_to(point, &at.own_set(), at.state).ok()?;
        let new = !proposal.is_too_short(&at.state.center) && !at.state.bundle.knows(&proposal.trial, f64::INFINITY);
        self.left -= usize::from(new);
        new.then_some(Proposal { origin: Origin::Confirmation, predicted_decrease, ..proposal })
    }
}

fn ended(ending: Ending) -> Confirmed {
    Confirmed::End(Box::new(ending))
}
