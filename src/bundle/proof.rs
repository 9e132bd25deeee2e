//! What a run ends with: the termination, and the multipliers that justify it.

use super::composite::PointProof;
use super::proposers::proposal::Proposal;
use crate::report::{Certificate, Termination};

/// The end of a run.
#[derive(Debug, Clone)]
pub(crate) struct Ending {
    pub termination: Termination,
    /// The multipliers that prove it; none where the run ends for another reason.
    pub proof: Option<Proof>,
}

impl Ending {
    /// The end that a subproblem of the cuts justifies.
    pub(crate) fn by_cuts(termination: Termination, proposal: Proposal) -> Self {
        Self { termination, proof: Some(Proof { proposal, composite: None }) }
    }
}

impl From<Termination> for Ending {
    fn from(termination: Termination) -> Self {
        Self { termination, proof: None }
    }
}

/// The multipliers of a subproblem at the center.
#[derive(Debug, Clone)]
pub(crate) struct Proof {
    pub proposal: Proposal,
    /// Outputs, Jacobian and cuts of the outer function, where the composite model gave the multipliers.
    pub composite: Option<PointProof>,
}

impl Proof {
    /// The certificate with the cuts that the proof rests on.
    pub(crate) fn certificate(&self, of_bundle: Certificate) -> Certificate {
        match &self.composite {
            Some(composite) => composite.certificate(of_bundle),
            None => of_bundle,
        }
    }
}
