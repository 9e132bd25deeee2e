//! The certificate of stationarity and its offline check.
//!
//! ```text
//! z̃ = Σ λ_i h_i + Aᵀμ + ν,   ẽ = Σ λ_i a_i + Σ slack·|multiplier|,
//! Θ(y) ≥ Θ(x̂) − ‖z̃‖*‖y − x̂‖ − ẽ   for all y ∈ U     (Θ convex; otherwise for the convexified model)
//! ```

use super::{CompositeProof, ConstraintProof};
use crate::bundle::cut::{Cut, offset};
use crate::bundle::norm::ScaledNorm;
use crate::{Polyhedron, Vector, plain};
use serde::{Deserialize, Serialize};
use std::fmt;

/// How stationary a point is, with all that is needed to compute it again.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub struct Certificate {
    /// The center x̂.
    #[serde(with = "plain::vector")]
    pub point: Vector,
    /// Θ(x̂).
    pub value: f64,
    /// Error that the oracle promised for the value.
    pub error_bound: f64,
    /// ‖z̃‖* of the aggregate subgradient, constraints included, in the dual of `norm`.
    pub aggregate_norm: f64,
    /// ẽ ≥ 0, in units of Θ.
    pub aggregate_error: f64,
    /// Decrease that the model predicts at `weight`, in units of Θ.
    pub predicted_decrease: f64,
    /// The weight u of the subproblem.
    pub weight: f64,
    /// Curvature c added to make the model convex; 0 if Θ looks convex.
    pub convexification: f64,
    /// Whether Θ was declared convex: errors of cuts then count with their signs.
    #[serde(default)]
    pub convex: bool,
    /// The norm of the run.
    pub norm: ScaledNorm,
    /// All cuts of the subproblem, with their points, values, subgradients and multipliers.
    pub cuts: Vec<Cut>,
    /// Multipliers μ of the rows, > 0 at the upper and < 0 at the lower side.
    #[serde(with = "plain::vector")]
    pub row_multipliers: Vector,
    /// Multipliers ν of the bounds, signed likewise.
    #[serde(with = "plain::vector")]
    pub bound_multipliers: Vector,
    /// Largest distance from x̂ of a cut with a positive multiplier, in the run's norm.
    pub active_radius: f64,
    /// Noise promised by the oracle or seen in its values, in units of Θ.
    pub noise: f64,
    /// Nonlinear constraints with the linearizations that have a multiplier, where there are any.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub constraints: Option<ConstraintProof>,
    /// Outputs and Jacobian behind the cuts, where the composite model confirmed the point.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub composite: Option<CompositeProof>,
}

/// The numbers of a certificate computed again from its cuts and multipliers.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub struct CertificateCheck {
    /// ‖z̃‖* computed from cuts and multipliers.
    pub aggregate_norm: f64,
    /// ẽ computed from cuts and multipliers.
    pub aggregate_error: f64,
    /// The larger of |Σ λ − 1| and the largest −λ_i.
    pub multiplier_defect: f64,
    /// Relative violation of the set and of the nonlinear constraints at the point.
    pub violation: f64,
    /// Largest multiplier of an open (infinite) side; 0 in a valid certificate.
    pub open_side_multiplier: f64,
}

impl CertificateCheck {
    /// Whether the point is stationary up to the tolerances: aggregate norm and error as given, multipliers and
    /// feasibility to 1e-9.
    pub fn confirms(&self, norm_tolerance: f64, error_tolerance: f64) -> bool {
        self.aggregate_norm <= norm_tolerance
            && self.aggregate_error <= error_tolerance
            && self.multiplier_defect <= 1e-9
            && self.violation <= 1e-9
            && self.open_side_multiplier == 0.0
    }
}

impl Certificate {
    /// The cuts with a positive multiplier.
    pub fn active_cuts(&self) -> impl Iterator<Item = &Cut> {
        self.cuts.iter().filter(|cut| cut.is_active())
    }

    /// Computes aggregate norm and error again, from the cuts, the multipliers and the admissible set alone.
    ///
    /// # Errors
    /// [`InputError::Dimension`](crate::InputError::Dimension) if the set has another size than the certificate.
    pub fn recheck(&self, set: &Polyhedron) -> Result<CertificateCheck, crate::InputError> {
        for (what, expected, found) in [
            ("certificate point", set.dimension(), self.point.len()),
            ("row multipliers", set.rows().nrows(), self.row_multipliers.len()),
            ("bound multipliers", set.dimension(), self.bound_multipliers.len()),
        ] {
            if expected != found {
                return Err(crate::InputError::Dimension { what, expected, found });
            }
        }
        let mut aggregate = set.rows().tr_mul(&self.row_multipliers) + &self.bound_multipliers;
        let (mut error, mut total, mut negative) = (0.0, 0.0, 0.0_f64);
        for cut in &self.cuts {
            let way = &self.point - &cut.point;
            let linear = cut.linearization_error(&self.point, self.value);
            let promised = if cut.point == self.point { 0.0 } else { cut.excess() + self.error_bound };
            let convexified = self.convexification * self.norm.squared(&way);
            error += cut.multiplier * offset(linear, convexified, promised, self.convex);
            let tilt = self.norm.lower_index(&way) * (2.0 * self.convexification);
            aggregate += (&cut.subgradient - tilt) * cut.multiplier;
            total += cut.multiplier;
            negative = negative.max(-cut.multiplier);
        }
        let mut violation = set.violation(&self.point);
        if let Some(constraints) = &self.constraints {
            let (slopes, slack, wrong_sign) = constraints.sums(&self.point)?;
            aggregate += slopes;
            error += slack;
            negative = negative.max(wrong_sign);
            violation = violation.max(constraints.violation());
        }
        let mut open = 0.0_f64;
        let at_point = set.rows() * &self.point;
        let sides =
            set.row_lower().iter().zip(set.row_upper().iter()).zip(at_point.iter().zip(self.row_multipliers.iter()));
        let bounds =
            set.lower().iter().zip(set.upper().iter()).zip(self.point.iter().zip(self.bound_multipliers.iter()));
        for ((lower, upper), (value, multiplier)) in sides.chain(bounds) {
            let slack = if *multiplier > 0.0 { upper - value } else { value - lower };
            if slack.is_finite() {
                error += multiplier.abs() * slack.max(0.0);
            } else {
                open = open.max(multiplier.abs());
            }
        }
        Ok(CertificateCheck {
            aggregate_norm: self.norm.dual_length(&aggregate),
            aggregate_error: error,
            multiplier_defect: (total - 1.0_f64).abs().max(negative),
            violation,
            open_side_multiplier: open,
        })
    }
}

impl fmt::Display for Certificate {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        // An objective that has reached zero up to rounding is no scale.
        match self.predicted_decrease <= self.value.abs() && self.value != 0.0 {
            false => write!(f, "predicted decrease {:.1e}", self.predicted_decrease)?,
            true => {
                write!(f, "predicted decrease {:.1e} of the objective", self.predicted_decrease / self.value.abs())?;
            }
        }
        write!(
            f,
            ", |aggregate subgradient| {:.2e}, aggregate error {:.2e}, {} active cuts within {:.1e}, noise {:.1e}",
            self.aggregate_norm,
            self.aggregate_error,
            self.active_cuts().count(),
            self.active_radius,
            self.noise
        )
    }
}
