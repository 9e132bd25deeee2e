//! The proof that a point is stationary, as the certificate of a run.

use super::base::Base;
use super::model::{CompositeStep, OuterCut};
use crate::bundle::cut::Cut;
use crate::report::{Certificate, CompositeProof, ConstraintProof};

/// Outputs, Jacobian and cuts of the outer function that prove a point stationary.
#[derive(Debug, Clone)]
pub(crate) struct PointProof {
    pub base: Base,
    pub step: CompositeStep,
}

impl PointProof {
    /// The certificate with the cuts of the outer function, seen in the variables, in place of the bundle.
    pub(crate) fn certificate(&self, of_bundle: Certificate) -> Certificate {
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
        let radius = |proof: &ConstraintProof| {
            proof.cuts.iter().map(|cut| cut.distance(&of_bundle.point, &of_bundle.norm)).fold(0.0, f64::max)
        };
        let active_radius = of_bundle.constraints.as_ref().map_or(0.0, radius);
        Certificate { cuts, composite: Some(proof), active_radius, ..of_bundle }
    }
}
