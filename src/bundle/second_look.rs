//! A second look at ends that rest on cuts not quite near.
//!
//! Cuts on both sides of a curved kink cancel at a point where Θ still falls along the kink, the more so the farther they lie. Before an end
//! with active cuts beyond 1e-6 is confirmed, the run restarts once from the nearest of them, as it does after an unconfirmed end. If
//! nothing lower is found, the cuts of the first proof come back, and the end is confirmed by them if they still prove it. A limit that ends
//! the look keeps its word: the run can be continued.

use super::run::Run;
use super::state::FirstProof;
use crate::report::Termination;

/// Active cuts within this relative distance need no second look.
const NEAR: f64 = 1e-6;

impl Run<'_, '_> {
    /// Whether a confirmed end with active cuts within `radius` waits for a restart; its cuts, and the weight at which they prove it, are kept.
    pub(super) fn asks_for_second_look(&mut self, radius: f64, weight: f64) -> bool {
        let looked = self.state.first_proof.as_ref().is_some_and(|proof| !self.fell_since(proof));
        if radius <= NEAR || looked || !self.may_restart() {
            return false;
        }
        let (value, cuts) = (self.state.center_value, self.state.bundle.cuts().to_vec());
        self.state.first_proof = Some(FirstProof { value, weight, cuts });
        true
    }

    /// The word for the end of a run: that of the first proof if nothing lower has been found since.
    pub(super) fn after_second_look(&mut self, word: Termination) -> Termination {
        let settled = matches!(
            word,
            Termination::Stationary { .. }
                | Termination::StoppedByObserver
                | Termination::StopRule { .. }
                | Termination::UnboundedBelow
                | Termination::OracleContradiction { .. }
                | Termination::EvaluationLimit
                | Termination::IterationLimit
                | Termination::TimeLimit
        );
        let Some(proof) = self.state.first_proof.take().filter(|proof| !settled && !self.fell_since(proof)) else {
            return word;
        };
        // The center keeps its cut. The others that came since stay away: pairs so close together overestimate how far Θ is from convex.
        let state = &mut self.state;
        state.bundle.retain(|cut| cut.id == state.center_id);
        for cut in proof.cuts.into_iter().filter(|cut| cut.id != state.center_id) {
            state.bundle.push(cut, &state.norm);
        }
        self.forget_model();
        self.state.weight = proof.weight;
        self.try_subproblem().ok().and_then(|proposal| self.confirmed(&proposal)).unwrap_or(word)
    }

    fn fell_since(&self, proof: &FirstProof) -> bool {
        proof.value - self.state.center_value > self.tolerance()
    }
}
