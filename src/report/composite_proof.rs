//! What the composite model proves at a point, with all that is needed to compute it again.
//!
//! ```text
//! z̃ = Gᵀ Σ λ_j w_j + Aᵀμ + ν,   w_j ∈ ∂h(c_j),     e_j = h(c) − h(c_j) − ⟨w_j, c − c_j⟩ ≥ 0,   Σ λ_j e_j = h(c) − ⟨w, c⟩ + h*(w)
//! ```
//! The last equation holds where Σ λ_j w_j is a subgradient at all c_j with a multiplier, as it is for one c_j;
//! otherwise the sum is an upper bound of the right side. Where h is built from cones, w_j may be any w with a
//! conjugate, and ⟨w, c_j⟩ − h*(w) stands for h(c_j).

use crate::bundle::OuterCut;
use crate::{Matrix, Vector, plain};
use serde::{Deserialize, Serialize};

/// Outputs, Jacobian and cuts of the outer function behind a certificate. The certificate's own cuts are these, seen in
/// the variables: subgradient Gᵀw_j, linearization error e_j, multiplier λ_j.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub struct CompositeProof {
    /// c at the point, m entries.
    #[serde(with = "plain::vector")]
    pub outputs: Vector,
    /// G there, m × n.
    #[serde(with = "plain::matrix")]
    pub jacobian: Matrix,
    /// Relative error of the columns of G that the oracle promised.
    pub accuracy: f64,
    /// The cuts of h, in the order of the certificate's cuts.
    pub cuts: Vec<OuterCut>,
}
