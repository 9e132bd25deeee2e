//! How far the composite model is trusted: weight, longest step, pauses.

use crate::bundle::proposers::pause::Pause;
use crate::bundle::proposers::proposal::Proposal;
use crate::bundle::step_trust::StepTrust;

/// The first weight, relative to the first weight of the cuts: h is exact, so that first steps ten times as long as
/// those of the cuts pay.
const FIRST_WEIGHT: f64 = 1e-2;

/// Weight and limits of the next step.
#[derive(Debug)]
pub(super) struct Trust {
    pub next: StepTrust,
    failures: usize,
    pause: Pause,
}

impl Trust {
    pub(super) fn new(first_weight: f64) -> Self {
        Self { next: StepTrust::new(FIRST_WEIGHT * first_weight), failures: 0, pause: Pause::default() }
    }

    /// Whether no pause is left. Counts one evaluation of the pause.
    pub(super) fn pass(&mut self) -> bool {
        self.pause.pass()
    }

    pub(super) fn pause(&mut self) {
        self.pause.fail();
    }

    /// Lengthens the pause by one evaluation.
    pub(super) fn prolong(&mut self) {
        self.pause.prolong();
    }

    /// A step has been accepted that brought `ratio` times the predicted decrease: half of it lets the weight fall.
    pub(super) fn accept(&mut self, proposal: &Proposal, ratio: f64) {
        self.next = StepTrust::accepted(proposal.weight, ratio >= 0.5 && !proposal.restores);
        self.failures = 0;
        self.pause.succeed();
    }

    /// A step has been rejected, or the oracle has failed at its end.
    pub(super) fn reject(&mut self, proposal: &Proposal) {
        self.next = StepTrust::rejected(proposal.weight, proposal.step_length);
        self.failures += 1;
        if self.failures > 2 {
            self.pause();
        }
    }
}
