//! Nonlinear constraints in reports and certificates.

use crate::bundle::norm::ScaledNorm;
use crate::qp::kernels::difference_dot;
use crate::{ConstraintKind, InputError, Vector, plain};
use serde::{Deserialize, Serialize};

/// A nonlinear constraint at the end of a run.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub struct ConstraintReport {
    /// The kind of the constraint.
    pub kind: ConstraintKind,
    /// c_j at the solution, in its own unit.
    pub value: f64,
    /// The violation there (c_j⁺, or |c_j| of an equality) relative to the largest |c_j| at the centers of the run; 0
    /// where there is none.
    pub violation: f64,
    /// Whether the violation is within the tolerance: 1e-10 of the first nonzero |c_j| at a center or, where it is
    /// smaller, of Σ_i |h_i x_i| with the subgradient h there; and rounding.
    pub satisfied: bool,
    /// The multiplier μ_j in the certificate: by how much the objective would fall per unit of c_j that is granted, to
    /// first order. At least 0 for an inequality; of either sign for an equality.
    pub multiplier: f64,
}

/// A linearization of a nonlinear constraint in a certificate.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub struct ConstraintCut {
    /// The constraint j, counted from 0.
    pub constraint: usize,
    /// Where it was taken, y.
    #[serde(with = "plain::vector")]
    pub point: Vector,
    /// The value of the constraint, or of one of its pieces, at y.
    pub value: f64,
    /// The subgradient h there.
    #[serde(with = "plain::vector")]
    pub subgradient: Vector,
    /// The multiplier of the linearization, ≥ 0 for an inequality.
    pub multiplier: f64,
}

impl ConstraintCut {
    /// −t(x̂) ≥ 0: how far the linearization lies below zero at a point where the constraint has the value given. A
    /// linearization above the constraint shows that the constraint is not convex, and counts as far below.
    pub(crate) fn slack(&self, point: &Vector, value: f64) -> f64 {
        let linear = self.value + difference_dot(self.subgradient.as_slice(), point.as_slice(), self.point.as_slice());
        (value - linear).abs() - value
    }

    /// The distance of its point from another one.
    pub(crate) fn distance(&self, point: &Vector, norm: &ScaledNorm) -> f64 {
        norm.length(&(&self.point - point))
    }
}

/// The nonlinear constraints in a certificate.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[non_exhaustive]
pub struct ConstraintProof {
    /// The kinds of the constraints.
    pub kinds: Vec<ConstraintKind>,
    /// c at the point, m entries.
    #[serde(with = "plain::vector")]
    pub values: Vector,
    /// The largest |c_j| at the centers of the run, which violations are compared with.
    #[serde(with = "plain::vector")]
    pub sizes: Vector,
    /// The linearizations with a multiplier.
    pub cuts: Vec<ConstraintCut>,
}

impl ConstraintProof {
    /// The multiplier of every constraint.
    pub fn multipliers(&self) -> Vector {
        let mut sums = Vector::zeros(self.kinds.len());
        for cut in &self.cuts {
            sums[cut.constraint] += cut.multiplier;
        }
        sums
    }

    /// Σ μ h, Σ |μ| slack and the largest multiplier of the wrong sign, at the point of the certificate.
    ///
    /// # Errors
    /// [`InputError::Dimension`] for a linearization of a constraint that does not exist.
    pub(crate) fn sums(&self, point: &Vector) -> Result<(Vector, f64, f64), InputError> {
        let (mut slopes, mut error, mut wrong) = (Vector::zeros(point.len()), 0.0, 0.0_f64);
        for cut in &self.cuts {
            let (expected, found) = (self.values.len(), cut.constraint + 1);
            if found > expected {
                return Err(InputError::Dimension { what: "constraints", expected, found });
            }
            error += cut.multiplier.abs() * cut.slack(point, self.values[cut.constraint]).abs();
            slopes += &cut.subgradient * cut.multiplier;
            if self.kinds[cut.constraint] != ConstraintKind::SmoothEquality {
                wrong = wrong.max(-cut.multiplier);
            }
        }
        Ok((slopes, error, wrong))
    }

    /// The largest violation relative to the size of its constraint.
    pub(crate) fn violation(&self) -> f64 {
        let relative = |j: usize| match self.kinds[j].violation(self.values[j]) {
            0.0 => 0.0,
            violation => violation / self.sizes[j],
        };
        (0..self.kinds.len()).map(relative).fold(0.0, f64::max)
    }
}
