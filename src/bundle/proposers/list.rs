//! The proposers of a run, in the order in which they are asked.

use super::cuts::PlainCuts;
use super::proposer::{Answer, Position, Proposer};
use crate::bundle::composite::Composite;
use crate::bundle::proof::{Ending, Proof};

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

    /// All proposers, in the order in which they are asked.
    pub(crate) fn all(&mut self) -> impl Iterator<Item = &mut dyn Proposer> {
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

    /// The proof of the present center that a proposer has found before.
    pub(crate) fn standing_proof(&mut self) -> Option<Ending> {
        self.all().find_map(Proposer::standing_proof)
    }

    /// The proof of the center by the plain cuts.
    pub(crate) fn plain_proof(&mut self, at: &mut Position<'_>) -> Option<Proof> {
        self.cuts.answer(at).map(|proposal| Proof { proposal, composite: None })
    }
}
