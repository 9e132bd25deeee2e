//! The proposers of a run, in the order in which they are asked.

use super::cuts::PlainCuts;
use super::proposal::Proposal;
use super::proposer::{Answer, Position, Proposer};
use crate::bundle::composite::Composite;
use crate::bundle::proof::{Ending, Proof};
use crate::bundle::trial::Trial;
use crate::composite::Linearization;

/// The proposers before the plain cuts, and the plain cuts, which always have an answer.
pub(crate) struct Proposers {
    first: Vec<Box<dyn Proposer>>,
    cuts: PlainCuts,
}

impl Proposers {
    /// The proposers of an objective with or without a known outer function; `weight` is the first weight of the run.
    pub(crate) fn new(composite: bool, dimension: usize, weight: f64) -> Self {
        let mut first: Vec<Box<dyn Proposer>> = vec![];
        if composite {
            first.push(Box::new(Composite::new(weight)));
        }
        Self { first, cuts: PlainCuts::new(dimension, weight) }
    }

    fn all(&mut self) -> impl Iterator<Item = &mut dyn Proposer> {
        let first = self.first.iter_mut().map(|proposer| &mut **proposer as &mut dyn Proposer);
        first.chain(std::iter::once(&mut self.cuts as &mut dyn Proposer))
    }

    /// The answer of the first proposer that has one.
    pub(crate) fn propose(&mut self, at: &mut Position<'_>) -> Answer {
        for proposer in self.all() {
            match proposer.propose(at) {
                Answer::Silent => {}
                answer => return answer,
            }
        }
        Answer::Silent
    }

    /// Tells all proposers what came of a trial point; the center has not moved yet.
    pub(crate) fn learn(&mut self, at: &mut Position<'_>, trial: &Trial<'_>) {
        self.all().for_each(|proposer| proposer.learn(at, trial));
    }

    /// Tells all proposers that bundle and center have been updated.
    pub(crate) fn update(&mut self, at: &mut Position<'_>, trial: &Trial<'_>) {
        self.all().for_each(|proposer| proposer.update(at, trial));
    }

    /// Tells all proposers that the oracle failed at a trial point.
    pub(crate) fn shorten(&mut self, at: &mut Position<'_>, proposal: &Proposal) {
        self.all().for_each(|proposer| proposer.shorten(at, proposal));
    }

    /// Tells all proposers that a trial point is known.
    pub(crate) fn leave_known_point(&mut self, at: &mut Position<'_>, proposal: &Proposal) {
        self.all().for_each(|proposer| proposer.leave_known_point(at, proposal));
    }

    /// Tells all proposers that the center has been evaluated, for the first time or anew.
    pub(crate) fn recenter(&mut self, at: &mut Position<'_>, linearization: Option<&Linearization>) {
        self.all().for_each(|proposer| proposer.recenter(at, linearization));
    }

    /// The proof of the present center that a proposer has found before.
    pub(crate) fn standing_proof(&mut self) -> Option<Ending> {
        self.all().find_map(Proposer::standing_proof)
    }

    /// What the plain cuts say about the center.
    pub(crate) fn plain_proof(&mut self, at: &mut Position<'_>) -> Option<Proof> {
        self.cuts.answer(at).map(|proposal| Proof { proposal, composite: None })
    }
}
