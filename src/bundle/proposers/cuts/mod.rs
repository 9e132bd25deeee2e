//! The plain cuts: every run has this proposer, and its certificate rests on them unless the composite model has a
//! proof.

mod confirmation;
pub(crate) mod model;
pub(crate) mod planes;
mod qualification;
mod stationarity;
mod weight;

use super::curved::{self, Curved};
use super::proposal::Proposal;
use super::proposer::{Answer, Position, Proposer};
use crate::bundle::demand;
use crate::bundle::trial::Trial;
use crate::composite::Linearization;
use crate::report::Origin;
use planes::CuttingPlanes;
use stationarity::{Next, StationarityTest};

/// The cutting-plane model, the curved model that may propose in its place, and the test for the end.
#[derive(Debug)]
pub(crate) struct PlainCuts {
    planes: CuttingPlanes,
    curved: Option<Curved>,
    test: StationarityTest,
}

impl PlainCuts {
    /// The proposer of a run with the first weight given.
    pub(crate) fn new(dimension: usize, weight: f64) -> Self {
        let curved = (dimension <= curved::MAX_DIMENSION).then(|| Curved::new(weight));
        Self { planes: CuttingPlanes::default(), curved, test: StationarityTest::default() }
    }

    /// The proposal worth an evaluation: that of the cuts, unless the curved model has a better one.
    fn choose(&mut self, at: &mut Position<'_>, plain: Proposal) -> Proposal {
        if at.restoring() {
            return plain;
        }
        let Some(curved) = &mut self.curved else { return plain };
        let small = at.resolution().small();
        let model = self.planes.model(at);
        match curved.propose(at, model, &plain, small) {
            // After a failure, the steps of the plain cuts tell whether the oracle fails next to the center.
            Ok(Some(better)) if at.state.longest_step.is_none() => {
                Proposal { cut_change: model.cuts().change(&better.step), ..better }
            }
            _ => plain,
        }
    }

    /// The proposal itself, or its step shortened to the length that a failed evaluation has left. A larger weight
    /// alone leaves the step as it is where cuts meet in a point.
    fn shortened(&mut self, at: &mut Position<'_>, proposal: Proposal) -> Proposal {
        let Some(longest) = at.state.longest_step.filter(|longest| proposal.step_length > *longest) else {
            return proposal;
        };
        let step = &proposal.step * (longest / proposal.step_length);
        let cut_change = self.planes.model(at).cuts().change(&step);
        match proposal.replaced(at.set, at.state, step, proposal.weight, proposal.origin, |_| cut_change) {
            Ok(shorter) => Proposal { cut_change, ..shorter },
            Err(_) => proposal,
        }
    }

    /// The answer of the subproblem at the center; none where it cannot be solved.
    pub(crate) fn answer(&mut self, at: &mut Position<'_>) -> Option<Proposal> {
        match self.planes.answer(at.state) {
            Some(proposal) => Some(proposal.clone()),
            None => self.planes.try_solve(at).ok(),
        }
    }
}

impl Proposer for PlainCuts {
    fn propose(&mut self, at: &mut Position<'_>) -> Answer {
        match self.test.next(at, &mut self.planes) {
            Next::End(ending) => Answer::End(ending),
            Next::Given(proposal) => Answer::trial(proposal),
            Next::Trial(proposal) => {
                let refines = demand::center_is_too_coarse(at.state, at.config, proposal.predicted_decrease);
                let chosen = if refines { proposal } else { self.choose(at, proposal) };
                Answer::trial(self.shortened(at, chosen))
            }
        }
    }

    fn learn(&mut self, at: &mut Position<'_>, trial: &Trial<'_>) {
        if let Some(curved) = &mut self.curved {
            curved.learn(at.state, trial);
        }
        self.test.learn(at, trial);
        self.planes.weight_rule.learn(at.state, trial);
    }

    fn update(&mut self, at: &mut Position<'_>, trial: &Trial<'_>) {
        self.test.update(at, trial);
    }

    fn shorten(&mut self, at: &mut Position<'_>, proposal: &Proposal) {
        if let Some(curved) = &mut self.curved {
            curved.shorten(at.state, proposal);
        }
        self.planes.weight_rule.shorten(at.state, proposal);
    }

    fn recenter(&mut self, _at: &mut Position<'_>, _linearization: Option<&Linearization>) {
        self.test.recenter();
    }

    /// Lengthens the step where noise hides what it promises, and shortens it elsewhere.
    fn leave_known_point(&mut self, at: &mut Position<'_>, proposal: &Proposal) {
        let hidden = at.resolution().hidden_by_noise();
        if proposal.origin == Origin::Cuts && proposal.predicted_decrease <= hidden {
            at.state.set_weight(at.state.weight / 10.0);
        } else {
            self.shorten(at, proposal);
        }
    }
}
