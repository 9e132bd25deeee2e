//! Classifies an evaluated trial point as a serious or a null step.

use super::proposers::proposal::{Proposal, SERIOUS_FRACTION};
use super::state::BundleState;
use crate::composite::Linearization;
use crate::{ConstraintEvaluation, Evaluation, Vector};

/// A trial point and what came of it.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Trial<'a> {
    pub proposal: &'a Proposal,
    pub comparison: Comparison,
    /// Θ at the point.
    pub value: f64,
    /// Whether the value is that of Θ; otherwise it is a lower bound of Θ that rules out a serious step.
    pub accurate: bool,
    pub serious: bool,
    /// Outputs and Jacobian at the point, where the oracle returned them.
    pub linearization: Option<&'a Linearization>,
    /// The constraints at the point.
    pub constraints: Option<&'a ConstraintEvaluation>,
}

impl<'a> Trial<'a> {
    pub(super) fn new(
        state: &BundleState,
        proposal: &'a Proposal,
        evaluation: &'a Evaluation<()>,
        accurate: bool,
        linearization: Option<&'a Linearization>,
    ) -> Self {
        let mut comparison = Comparison::new(state, proposal, evaluation.value, &evaluation.subgradient);
        if let (Some(constraints), Some(found)) = (&state.constraints, &evaluation.constraints) {
            let change = constraints.violation(&found.values) - constraints.center_violation();
            comparison.change += constraints.penalty * change;
        }
        let serious = accurate && comparison.is_serious();
        Self {
            proposal,
            comparison,
            value: evaluation.value,
            accurate,
            serious,
            linearization,
            constraints: evaluation.constraints.as_ref(),
        }
    }
}

/// The value below which a trial point is a serious step.
pub(super) fn descent_target(state: &BundleState, proposal: &Proposal) -> f64 {
    state.merit() - SERIOUS_FRACTION * proposal.predicted_decrease
}

/// Comparison of a trial point with what the model said.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Comparison {
    /// Θ(y) − Θ(x̂), of the merit where there are constraints.
    pub change: f64,
    /// Θ(y) − Θ(x̂).
    pub objective_change: f64,
    /// ⟨g, d⟩ with the subgradient at the trial point.
    pub slope: f64,
    /// v = −predicted decrease.
    pub model_change: f64,
}

impl Comparison {
    pub(crate) fn new(state: &BundleState, proposal: &Proposal, value: f64, subgradient: &Vector) -> Self {
        Self {
            change: value - state.center_value,
            objective_change: value - state.center_value,
            slope: subgradient.dot(&proposal.step),
            model_change: -proposal.predicted_decrease,
        }
    }

    /// Test SS(i) of \[SchrammZowe1992\]: Θ has fallen by enough of the predicted decrease. The values themselves must
    /// fall, because a predicted decrease can be so small that no change at all would be enough.
    fn is_serious(&self) -> bool {
        self.change < 0.0 && self.change <= SERIOUS_FRACTION * self.model_change
    }

    /// Whether so much of the predicted decrease was found, m_R = ½ of it, that the next step may be longer.
    pub(crate) fn is_good(&self) -> bool {
        self.change <= 0.5 * self.model_change
    }
}
