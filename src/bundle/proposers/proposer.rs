//! What the engine asks of whoever proposes trial points beside the plain cuts.

use super::cuts::model::Model;
use super::proposal::{Proposal, SubproblemError};
use crate::bundle::config::BundleTrustConfig;
use crate::bundle::state::State;
use crate::qp::EpigraphQpSolver;
use crate::{Polyhedron, Vector};

/// A rival of the plain cuts.
pub(crate) trait Proposer {
    /// A trial point that should replace the last of those `proposed` so far; none if that one should stay. The first entry of
    /// `proposed` comes from the plain cuts. A predicted decrease up to `small` is not worth an evaluation.
    ///
    /// # Errors
    /// [`SubproblemError`]: the rival proposes nothing.
    fn propose(
        &mut self,
        position: &mut Position<'_>,
        proposed: &[Proposal],
        small: f64,
    ) -> Result<Option<Proposal>, SubproblemError>;

    /// Takes note that the oracle failed at a trial point of any proposer. Where the point was its own, a proposer takes a shorter step
    /// next, or pauses.
    fn shorten(&mut self, state: &mut State, config: &BundleTrustConfig, proposal: &Proposal);

    /// Takes note of an evaluated trial point of any proposer; the center has not moved yet.
    fn learn(&mut self, state: &mut State, config: &BundleTrustConfig, trial: &Trial<'_>);
}

/// What a proposer sees.
pub(crate) struct Position<'a> {
    pub state: &'a State,
    pub set: &'a Polyhedron,
    pub solver: &'a mut EpigraphQpSolver,
    /// The cutting-plane model at the center.
    pub model: &'a Model,
}

/// A trial point and what came of it.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Trial<'a> {
    pub proposal: &'a Proposal,
    pub comparison: Comparison,
    /// Whether the value is that of Θ; otherwise it is a lower bound of Θ that rules out a serious step.
    pub accurate: bool,
    pub serious: bool,
}

/// Comparison of a trial point with what the model said.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Comparison {
    /// Θ(y) − Θ(x̂).
    pub change: f64,
    /// ⟨g, d⟩ with the subgradient at the trial point.
    pub slope: f64,
    /// v = −predicted decrease.
    pub model_change: f64,
}

impl Comparison {
    pub(crate) fn new(state: &State, proposal: &Proposal, value: f64, subgradient: &Vector) -> Self {
        Self {
            change: value - state.center_value,
            slope: subgradient.dot(&proposal.step),
            model_change: -proposal.predicted_decrease,
        }
    }

    /// Test SS(i) of \[SchrammZowe1992\]: Θ has fallen by enough of the predicted decrease. The values themselves must fall, because a
    /// predicted decrease can be so small that no change at all would be enough.
    pub(crate) fn is_serious(&self, config: &BundleTrustConfig) -> bool {
        self.change < 0.0 && self.change <= config.serious_fraction * self.model_change
    }

    /// Whether so much of the predicted decrease was found that the next step may be longer.
    pub(crate) fn is_good(&self, config: &BundleTrustConfig) -> bool {
        self.change <= config.good_fraction * self.model_change
    }
}
