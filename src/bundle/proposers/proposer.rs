//! What the engine asks of whoever proposes trial points.

use super::cuts::model::Model;
use super::proposal::{Proposal, SubproblemError};
use crate::bundle::config::BundleTrustConfig;
use crate::bundle::state::State;
use crate::qp::EpigraphQpSolver;
use crate::{Polyhedron, Vector};

/// One way to propose trial points.
pub(crate) trait Proposer {
    /// A trial point that should replace the last of those already `proposed`; none to leave it at that. The first entry of
    /// `proposed` comes from the plain cuts; the list is empty when they are asked themselves.
    ///
    /// # Errors
    /// [`SubproblemError`]; only that of the plain cuts matters to the run.
    fn propose(
        &mut self,
        position: &mut Position<'_>,
        proposed: &[Proposal],
    ) -> Result<Option<Proposal>, SubproblemError>;

    /// Takes note that the oracle failed at a trial point, its own or another's: its own next one is shorter, or waits.
    fn shorten(&mut self, state: &mut State, config: &BundleTrustConfig, proposal: &Proposal);

    /// Takes note of a trial point that was evaluated, its own or another's; the center has not moved yet.
    fn learn(&mut self, state: &mut State, config: &BundleTrustConfig, trial: &Trial<'_>);
}

/// What a proposer sees.
pub(crate) struct Position<'a> {
    pub state: &'a State,
    pub set: &'a Polyhedron,
    pub solver: &'a mut EpigraphQpSolver,
    /// The cutting-plane model at the center.
    pub model: &'a Model,
    /// The predicted decrease that counts as small.
    pub small: f64,
}

/// A trial point and what came of it.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Trial<'a> {
    pub proposal: &'a Proposal,
    pub comparison: Comparison,
    /// Whether the value is one of Θ; otherwise it is a lower bound that rules out a serious step.
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

    /// Test SS(i): enough of the predicted decrease came true. Rounding in the difference of the values is not held
    /// against the step only where the values do fall.
    pub(crate) fn is_serious(&self, config: &BundleTrustConfig) -> bool {
        self.change < 0.0 && self.change <= config.serious_fraction * self.model_change
    }
}
