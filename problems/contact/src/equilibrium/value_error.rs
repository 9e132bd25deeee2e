//! The error that the residual of a state brings into a function J of its contact forces and displacements.
//!
//! ```text
//! J − J* = Σ t_i + remainder,    t_i = weight by the adjoint × residual, per node or row
//! bound = |Σ t_i| + ¼ Σ|t_i| + 1e-14 (Σ|∂J/∂λ_i λ_i| + Σ|∂J/∂u_i u_i|)
//! ```
//! The sum is the error to first order. The remainder is of second order: nodes whose status differs between λ and λ*,
//! the curvature of J and of the slip circle. The bound holds whenever the remainder is at most a quarter of Σ|t_i|;
//! the residual has to be so small that few nodes change their status. The last term is rounding.
//!
//! It is an estimate for the peak pressure, whose largest node may change; for the deviation from a wanted pressure
//! near that pressure, where ∂J/∂σ and with it every t_i vanishes but the curvature stays; for the open area where a
//! node has σ = σ₀, a kink of J; and for the compliance, where it was exceeded up to three times (method.md (5.3)).

use crate::linear::vector::dot;
use serde::{Deserialize, Serialize};

/// Estimates of J(λ) − J(λ*), in units of J.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct ValueError {
    /// Σ t_i, with its sign: J less this is more accurate than J.
    pub first_order: f64,
    /// Bound of the absolute error; an estimate for peak pressure, deviation near the wanted pressure, open area where
    /// σ = σ₀ and compliance.
    pub bound: f64,
}

/// Remainder allowed for, as a share of Σ|t_i|.
const REMAINDER: f64 = 0.25;
/// Relative rounding error allowed for in every force and in every displacement.
const ROUNDING: f64 = 1e-14;

impl ValueError {
    /// From the terms t_i, and packed ∂J/∂λ and λ for the level of rounding.
    pub(crate) fn from_terms(terms: &[f64], direction: &[f64], forces: &[f64]) -> Self {
        Self::from_sums(terms.iter().sum(), terms.iter().map(|term| term.abs()).sum(), direction, forces)
    }

    /// With the rounding of ∂J/∂u as well, for a J that depends on displacements: `size` is Σ|∂J/∂u_i u_i|.
    #[must_use]
    pub fn with_displacements(self, size: f64) -> Self {
        Self { bound: self.bound + ROUNDING * size, ..self }
    }

    /// From Σ t_i and Σ|t_i|.
    pub(crate) fn from_sums(first_order: f64, absolute: f64, direction: &[f64], forces: &[f64]) -> Self {
        let sizes = |values: &[f64]| values.iter().map(|value| value.abs()).collect::<Vec<_>>();
        let rounding = ROUNDING * dot(&sizes(direction), &sizes(forces));
        Self { first_order, bound: first_order.abs() + REMAINDER * absolute + rounding }
    }
}
