//! The composite model around a base point.
//!
//! ```text
//! h(c + G d) + dᵀBd/2 + u‖d − o‖²/2,   x + d ∈ U
//! ```
//! B is the curvature of the outputs, u the weight, and o leads from the base x to the point that lengths are measured
//! from.

use crate::bundle::norm::{ScaledNorm, WeightedMetric};
use crate::bundle::proposers::proposal::SubproblemError;
use crate::composite::{Linearization, OuterFunction, OuterPart};
use crate::{Matrix, Polyhedron, Vector, plain};
use serde::{Deserialize, Serialize};

/// A cut above h by more than this share of the sizes of its terms is no rounding: h is not convex.
pub(super) const MAX_EXCESS: f64 = 1e-9;

/// A subgradient of the outer function at some outputs, with its multiplier in an aggregate.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub struct OuterCut {
    /// Outputs c_j, m entries.
    #[serde(with = "plain::vector")]
    pub outputs: Vector,
    /// h(c_j), or ⟨w_j, c_j⟩ − h*(w_j) ≤ h(c_j).
    pub value: f64,
    /// w_j ∈ ∂h(c_j), m entries; where h is built from cones, any w_j with a finite conjugate h*(w_j).
    #[serde(with = "plain::vector")]
    pub subgradient: Vector,
    /// λ_j ≥ 0; Σ λ_j = 1.
    pub multiplier: f64,
}

impl OuterCut {
    pub(super) fn at(outer: &dyn OuterFunction, outputs: Vector) -> Result<Self, SubproblemError> {
        let part = OuterPart { value: outer.value(&outputs), gradient: outer.subgradient(&outputs) };
        Self::of_part(part, outputs)
    }

    /// The cut of one of the functions whose maximum h is.
    pub(super) fn of_part(part: OuterPart, outputs: Vector) -> Result<Self, SubproblemError> {
        let OuterPart { value, gradient: subgradient } = part;
        let (expected, found) = (outputs.len(), subgradient.len());
        if expected != found {
            return Err(SubproblemError::OuterSize { expected, found });
        }
        if !(value.is_finite() && subgradient.iter().all(|entry| entry.is_finite())) {
            return Err(SubproblemError::OuterNotFinite { at_base: false });
        }
        Ok(Self { value, subgradient, outputs, multiplier: 0.0 })
    }

    /// Moves a cut of a positively homogeneous h to outputs that are no larger than a size: the error of the cut at
    /// outputs of this size then carries no rounding of larger numbers.
    pub(super) fn shrunk(self, outer: &dyn OuterFunction, size: f64) -> Self {
        let own = self.outputs.amax();
        if !(outer.is_homogeneous() && own > size && size > 0.0) {
            return self;
        }
        let share = size / own;
        Self { outputs: self.outputs * share, value: self.value * share, ..self }
    }

    /// What rounding of its terms can hide of the error at outputs where h has the value given.
    pub(super) fn rounding(&self, outputs: &Vector, value: f64) -> f64 {
        let terms = self.subgradient.abs().dot(&(outputs.abs() + self.outputs.abs()));
        f64::EPSILON * (value.abs() + self.value.abs() + terms)
    }

    /// The linearization error h(c) − h(c_j) − ⟨w_j, c − c_j⟩ ≥ 0 at outputs c where h has the value given.
    pub fn error(&self, outputs: &Vector, value: f64) -> f64 {
        value - self.value - self.subgradient.dot(&(outputs - &self.outputs))
    }
}

/// The model at a base point.
pub(crate) struct CompositeModel<'a> {
    pub outer: &'a dyn OuterFunction,
    pub linearization: &'a Linearization,
    /// h(c) at the base.
    pub value: f64,
    pub base: &'a Vector,
    pub norm: &'a ScaledNorm,
    pub set: &'a Polyhedron,
    /// The weight u.
    pub weight: f64,
    /// B, the curvature of the outputs; none: 0.
    pub curvature: Option<&'a Matrix>,
    /// x̂ − x from the base to the point that ‖·‖ measures from; none: 0.
    pub origin: Option<&'a Vector>,
}

/// A solution of the subproblem of the composite model.
#[derive(Debug, Clone)]
pub(crate) struct CompositeStep {
    pub step: Vector,
    /// h(c) − h(c + G d) − dᵀBd/2.
    pub decrease: f64,
    /// h(c) − h(c + G d).
    pub outer_decrease: f64,
    /// Cuts of h with a positive multiplier.
    pub cuts: Vec<OuterCut>,
    pub row_multipliers: Vector,
    pub bound_multipliers: Vector,
}

impl CompositeStep {
    /// w = Σ λ_j w_j.
    pub(crate) fn weights(&self) -> Vector {
        let mut cuts = self.cuts.iter();
        let first = cuts.next().map_or_else(|| Vector::zeros(0), |cut| &cut.subgradient * cut.multiplier);
        cuts.fold(first, |sum, cut| sum + &cut.subgradient * cut.multiplier)
    }
}

impl CompositeModel<'_> {
    /// B + u W.
    pub(super) fn metric(&self) -> WeightedMetric {
        match self.curvature {
            Some(_) => WeightedMetric::Dense(self.with_metric(Matrix::zeros(self.base.len(), self.base.len()))),
            None => self.norm.weighted(self.weight),
        }
    }

    /// A matrix, and B + u W added to it.
    pub(super) fn with_metric(&self, mut matrix: Matrix) -> Matrix {
        self.norm.add_to(&mut matrix, self.weight);
        if let Some(curvature) = self.curvature {
            matrix += curvature;
        }
        matrix
    }

    /// c + G d.
    pub(super) fn outputs(&self, step: &Vector) -> Vector {
        &self.linearization.outputs + &self.linearization.jacobian * step
    }

    /// h(c + G d) − h(c) + dᵀBd/2 + u(‖d − o‖² − ‖o‖²)/2 with the origin o.
    pub(super) fn merit(&self, step: &Vector) -> f64 {
        let quadratic = self.curvature_term(step) + self.weight * self.norm.squared(step);
        self.outer.value(&self.outputs(step)) - self.value + 0.5 * quadratic + self.pull_to_origin().dot(step)
    }

    /// −u W o.
    pub(super) fn pull_to_origin(&self) -> Vector {
        self.origin
            .map_or_else(|| Vector::zeros(self.base.len()), |origin| self.norm.lower_index(origin) * -self.weight)
    }

    /// dᵀBd.
    fn curvature_term(&self, step: &Vector) -> f64 {
        self.curvature.map_or(0.0, |curvature| step.dot(&(curvature * step)))
    }

    /// (B + u W) d − u W o.
    pub(super) fn pull(&self, step: &Vector) -> Vector {
        let pull = self.norm.lower_index(step) * self.weight + self.pull_to_origin();
        self.curvature.map_or(pull.clone(), |curvature| pull + curvature * step)
    }

    /// The linearization error of a cut of h at the base. Fails if the cut lies above h at the base by more than
    /// rounding.
    pub(super) fn error(&self, cut: &OuterCut) -> Result<f64, SubproblemError> {
        let outputs = &self.linearization.outputs;
        let error = cut.error(outputs, self.value);
        let terms = cut.subgradient.abs().dot(&(outputs.abs() + cut.outputs.abs()));
        let lies_below = error >= -MAX_EXCESS * (self.value.abs() + cut.value.abs() + terms);
        if !lies_below {
            return Err(SubproblemError::NotConvex { excess: -error });
        }
        Ok(error.max(0.0))
    }

    /// The solution at a step; `sides` are the multipliers of the rows and of the bounds.
    pub(super) fn solved(&self, step: Vector, cuts: Vec<OuterCut>, sides: (Vector, Vector)) -> CompositeStep {
        let outer_decrease = self.value - self.outer.value(&self.outputs(&step));
        let decrease = outer_decrease - 0.5 * self.curvature_term(&step);
        CompositeStep { decrease, outer_decrease, step, cuts, row_multipliers: sides.0, bound_multipliers: sides.1 }
    }
}
