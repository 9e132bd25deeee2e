//! Outputs that are constraints: an outer function of the first outputs, with the last ones as constraints.

use super::epigraph::{ConeFunction, Epigraph};
use super::outer::{OuterFunction, OuterPart};
use crate::nonlinear::OutputPiece;
use crate::{ConstraintKind, Matrix, Vector};

/// h of the first outputs; the last outputs are nonlinear constraints, one per kind.
///
/// ```
/// use nonsmooth::composite::{Maximum, WithConstraints};
/// use nonsmooth::{BundleTrust, BundleTrustConfig, CompositeFunction, ConstraintKind, Matrix, Vector};
/// // max(x, y) over the unit disc: outputs x, y, and the constraint x² + y² − 1 ≤ 0.
/// let outer = WithConstraints::new(Maximum, vec![ConstraintKind::Smooth]);
/// let theta = CompositeFunction::new(2, outer, |p: &Vector| {
///     let outputs = Vector::from_vec(vec![p[0], p[1], p.norm_squared() - 1.0]);
///     (outputs, Matrix::from_row_slice(3, 2, &[1.0, 0.0, 0.0, 1.0, 2.0 * p[0], 2.0 * p[1]]))
/// });
/// let report = BundleTrust::new(BundleTrustConfig::default())?.minimize(&theta, Vector::from_vec(vec![2.0, 1.0]))?;
/// assert!((report.value + 0.5_f64.sqrt()).abs() < 1e-7 && report.is_feasible(), "{report}");
/// assert!((report.constraints[0].multiplier - 0.125_f64.sqrt()).abs() < 1e-4, "{report}");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct WithConstraints<H> {
    outer: H,
    kinds: Vec<ConstraintKind>,
}

impl<H: OuterFunction> WithConstraints<H> {
    /// h with constraints of these kinds.
    pub fn new(outer: H, kinds: Vec<ConstraintKind>) -> Self {
        Self { outer, kinds }
    }

    /// Number of outputs of h.
    fn own(&self, outputs: &Vector) -> usize {
        outputs.len().saturating_sub(self.kinds.len())
    }

    fn outputs(&self, outputs: &Vector) -> Vector {
        outputs.rows(0, self.own(outputs)).into_owned()
    }
}

impl<H: OuterFunction> OuterFunction for WithConstraints<H> {
    fn value(&self, outputs: &Vector) -> f64 {
        self.outer.value(&self.outputs(outputs))
    }

    fn subgradient(&self, outputs: &Vector) -> Vector {
        let weights = self.outer.subgradient(&self.outputs(outputs));
        let missing = outputs.len().saturating_sub(self.own(outputs));
        let count = weights.len() + missing;
        weights.resize_vertically(count, 0.0)
    }

    fn curvature(&self, outputs: &Vector, jacobian: &Matrix) -> Option<Matrix> {
        let own = self.own(outputs);
        self.outer.curvature(&self.outputs(outputs), &jacobian.rows(0, own).into_owned())
    }

    fn parts(&self, outputs: &Vector) -> Vec<OuterPart> {
        let mut parts = self.outer.parts(&self.outputs(outputs));
        parts.iter_mut().for_each(|part| part.gradient.resize_vertically_mut(outputs.len(), 0.0));
        parts
    }

    fn parts_curvature(&self, outputs: &Vector, jacobian: &Matrix, weights: &[f64]) -> Option<Matrix> {
        let own = self.own(outputs);
        self.outer.parts_curvature(&self.outputs(outputs), &jacobian.rows(0, own).into_owned(), weights)
    }

    /// The constraints' outputs count nothing in h.
    fn epigraph(&self, outputs: usize) -> Option<Epigraph> {
        let limits = self.kinds.len();
        let of_outer = self.outer.epigraph(outputs.checked_sub(limits)?)?;
        Some(of_outer.and(ConeFunction::Linear, 0.0, limits))
    }

    fn constraint_kinds(&self) -> &[ConstraintKind] {
        &self.kinds
    }

    fn constraint_pieces(&self, outputs: &Vector) -> Vec<OutputPiece> {
        let own = self.own(outputs);
        let unit = |j: usize| Vector::from_fn(outputs.len(), |i, _| f64::from(u8::from(i == own + j)));
        let piece = |j: usize| OutputPiece { constraint: j, value: outputs[own + j], weights: unit(j) };
        (0..self.kinds.len().min(outputs.len())).map(piece).collect()
    }

    fn is_homogeneous(&self) -> bool {
        self.outer.is_homogeneous()
    }
}
