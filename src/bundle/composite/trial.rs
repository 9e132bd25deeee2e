//! The trial point of the composite model, or the end of the run at a point that it proves stationary.

use super::learning::MAX_PAUSE;
use super::proof::Proof;
use super::state::FACTOR;
use super::step::MAX_WEIGHTS;
use crate::bundle::proposers::proposal::Proposal;
use crate::bundle::run::Run;
use crate::report::Termination;
use std::ops::ControlFlow::{self, Continue};

/// A small predicted decrease that grows by less than this factor as the weight falls does not depend on the weight any more.
const LEAST_GAIN: f64 = 1.1;

impl Run<'_, '_> {
    /// The trial point of the composite model, or none where the model is silent. Ends the run at a point that the model proves stationary.
    pub(in crate::bundle) fn composite_trial(&mut self) -> ControlFlow<Termination, Option<Proposal>> {
        let Some(composite) = &mut self.composite else { return Continue(None) };
        if let Some(excursion) = composite.excursion.take() {
            return self.continue_excursion(excursion);
        }
        let Some(base) = composite.base.clone().filter(|_| composite.pause.pass()) else { return Continue(None) };
        let (least, _) = self.state.weight_limits(&self.method.config);
        let mut weight = composite.weight.max(least);
        if let Some(rejected) = composite.rejected.take() {
            if let Some(proposal) = self.correction(&base, &rejected)? {
                return Continue(Some(proposal));
            }
            if let Some(composite) = &mut self.composite {
                composite.bends = true;
            }
        }
        let (mut raised, mut last) = (false, None::<Proposal>);
        for _ in 0..MAX_WEIGHTS {
            let Some((proposal, step)) = self.composite_step(&base, weight, None, None)? else {
                (weight, raised) = (weight * FACTOR, true);
                continue;
            };
            if let Some(word) = self.composite_word(&proposal) {
                return self.leave(Proof { word, base, step, proposal: proposal.clone() }, proposal);
            }
            let longest = self.composite.as_ref().map_or(0.0, |composite| composite.longest);
            if proposal.predicted_decrease > self.small() {
                if proposal.step_length <= longest {
                    return Continue(Some(proposal));
                }
                (weight, raised) = (weight * FACTOR, true);
                continue;
            }
            weight /= FACTOR;
            let exhausted = last.is_some_and(|last| proposal.predicted_decrease < LEAST_GAIN * last.predicted_decrease);
            if raised || exhausted {
                // No step that has not been rejected promises more. What is small already may be proved to be all that is left.
                if let Some(proof) = self.lighter_proof(&base, weight)? {
                    return self.leave(proof, proposal);
                }
                return Continue(self.small_step(proposal).filter(|_| !raised));
            }
            last = Some(proposal);
        }
        Continue(None)
    }

    /// A step that promises little: the model may prove the point at its end stationary. None within a limit of length, where a longer step
    /// has been rejected: the cuts go on.
    fn small_step(&mut self, proposal: Proposal) -> Option<Proposal> {
        let composite = self.composite.as_mut()?;
        if composite.longest < f64::INFINITY {
            composite.pause.fail(MAX_PAUSE);
            return None;
        }
        Some(proposal).filter(|proposal| proposal.predicted_decrease > self.state.rounding())
    }
}
