//! The weight with which a step of the composite model is about as long as it may be.

use crate::bundle::proposers::proposal::Proposal;

/// Weights tried between one whose step is too long and one whose step is short.
const MAX_BETWEEN: usize = 6;

/// The lightest weight with a step within the limit so far, and the heaviest with a step beyond it.
#[derive(Debug)]
pub(super) struct WeightFit {
    /// Whether weights between two others are tried.
    fine: bool,
    beyond: Option<f64>,
    within: Option<(f64, Proposal)>,
    between: usize,
}

impl WeightFit {
    /// Beside constraints, long steps along them are worth more subproblems.
    pub(super) fn new(fine: bool) -> Self {
        Self { fine, beyond: None, within: None, between: 0 }
    }

    /// The step to take, once the weight of a proposal fits; until then, the next weight. A tenfold weight after a step
    /// that was too long overshoots: weights in between give steps of at least half of the allowed length.
    pub(super) fn next(&mut self, proposal: Proposal, longest: f64, weight: &mut f64) -> Option<Proposal> {
        if proposal.step_length <= longest {
            let fits = !self.fine || proposal.step_length >= 0.5 * longest || self.between >= MAX_BETWEEN;
            let Some(beyond) = self.beyond.filter(|_| !fits) else { return Some(proposal) };
            self.within = Some((*weight, proposal));
            self.between += 1;
            *weight = (beyond * *weight).sqrt();
            return None;
        }
        self.beyond = Some(*weight);
        let Some((within, short)) = &self.within else {
            *weight *= 10.0;
            return None;
        };
        if self.between >= MAX_BETWEEN {
            return Some(short.clone());
        }
        self.between += 1;
        *weight = (within * *weight).sqrt();
        None
    }

    /// The longest step within the limit so far.
    pub(super) fn step(self) -> Option<Proposal> {
        self.within.map(|(_, proposal)| proposal)
    }
}
