//! The proof that a point is stationary, as the certificate of a run.

use super::base::Base;
use super::model::{CompositeStep, OuterCut};
use crate::bundle::cut::Cut;
use crate::bundle::proposers::proposal::Proposal;
use crate::report::{Certificate, CompositeProof, Termination};

/// What proves that a point is stationary.
#[derive(Debug, Clone)]
pub(crate) struct Proof {
    /// The termination that the proof justifies.
    pub word: Termination,
    pub base: Base,
    pub step: CompositeStep,
    /// The step with what it says about the base.
    pub proposal: Proposal,
}

impl Proof {
    /// The certificate with the cuts of the outer function, seen in the variables, in place of the bundle.
    pub(crate) fn certificate(&self, of_proposal: Certificate) -> Certificate {
        let Base { point, value, linearization } = &self.base;
        let cut = |(index, cut): (usize, &OuterCut)| Cut {
            id: index as u64 + 1,
            point: point.clone(),
            radius: 0.0,
            value: value - cut.error(&linearization.outputs, *value),
            subgradient: linearization.jacobian.tr_mul(&cut.subgradient),
            error_bound: 0.0,
            certified: false,
            multiplier: cut.multiplier,
            idle: 0,
        };
        let proof = CompositeProof {
            outputs: linearization.outputs.clone(),
            jacobian: linearization.jacobian.clone(),
            accuracy: linearization.accuracy,
            cuts: self.step.cuts.clone(),
        };
        let cuts = self.step.cuts.iter().enumerate().map(cut).collect();
        Certificate { cuts, composite: Some(proof), active_radius: 0.0, ..of_proposal }
    }
}
