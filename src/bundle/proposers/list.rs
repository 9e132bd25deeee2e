//! The proposers of a run: the plain cuts, which need no memory, and their rivals.

use super::curved::{self, Curved};
use super::cuts;
use super::exploration::Exploration;
use super::proposal::Proposal;
use super::proposer::{Position, Proposer, Trial};
use crate::bundle::config::BundleTrustConfig;
use crate::bundle::state::State;

/// The plain cuts and their rivals, in the order in which they are asked.
pub(crate) struct Proposers {
    rivals: Vec<Box<dyn Proposer>>,
}

impl Proposers {
    /// The proposers that the settings ask for; `weight` is the first weight of the run.
    pub(crate) fn new(config: &BundleTrustConfig, dimension: usize, weight: f64) -> Self {
        let mut rivals: Vec<Box<dyn Proposer>> = vec![];
        if config.curved_model && dimension <= curved::MAX_DIMENSION {
            rivals.push(Box::new(Curved::new(weight)));
        }
        if let Some(settings) = config.exploration.filter(|settings| dimension <= settings.max_dimension) {
            rivals.push(Box::new(Exploration::new(settings, weight)));
        }
        Self { rivals }
    }

    /// Whether anybody proposes trial points beside the plain cuts.
    pub(crate) fn has_rivals(&self) -> bool {
        !self.rivals.is_empty()
    }

    /// The proposal worth an evaluation: that of the cuts, unless a rival has a better one, which must promise more than `small`.
    pub(crate) fn choose(&mut self, position: &mut Position<'_>, plain: Proposal, small: f64) -> Proposal {
        let mut proposed = vec![plain.clone()];
        for rival in &mut self.rivals {
            if let Ok(Some(better)) = rival.propose(position, &proposed, small) {
                proposed.push(better);
            }
        }
        let mut chosen = proposed.pop().unwrap_or(plain);
        chosen.cut_change = position.model.cuts().change(&chosen.step);
        chosen
    }

    /// Tells all proposers that the oracle failed at a trial point.
    pub(crate) fn shorten(&mut self, state: &mut State, config: &BundleTrustConfig, proposal: &Proposal) {
        for rival in &mut self.rivals {
            rival.shorten(state, config, proposal);
        }
        cuts::shorten(state, config, proposal);
    }

    /// Tells all proposers what came of a trial point.
    pub(crate) fn learn(&mut self, state: &mut State, config: &BundleTrustConfig, trial: &Trial<'_>) {
        for rival in &mut self.rivals {
            rival.learn(state, config, trial);
        }
        cuts::learn(state, config, trial);
    }
}
