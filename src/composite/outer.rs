//! Convex functions of the outputs.

use super::epigraph::{ConeFunction, Epigraph};
use crate::nonlinear::OutputPiece;
use crate::{ConstraintKind, Matrix, Vector};

/// One of the functions whose maximum an outer function is, at some outputs.
#[derive(Debug, Clone, PartialEq)]
pub struct OuterPart {
    /// h_k(c).
    pub value: f64,
    /// ∇h_k(c), m entries.
    pub gradient: Vector,
}

/// A convex function h: Rᵐ → R with one subgradient, and its curvature where it has one.
pub trait OuterFunction {
    /// h(c), in units of Θ.
    fn value(&self, outputs: &Vector) -> f64;

    /// One w ∈ ∂h(c), m entries.
    fn subgradient(&self, outputs: &Vector) -> Vector;

    /// Gᵀ∇²h(c) G, n × n, for G of shape m × n, if h is smooth: the subproblem is then solved by Newton's method. None
    /// (the default): h may have kinks, and the subproblem is solved by cuts of h. The answer must not be a matrix for
    /// some outputs and none for others.
    fn curvature(&self, _outputs: &Vector, _jacobian: &Matrix) -> Option<Matrix> {
        None
    }

    /// The smooth convex functions h_k whose maximum h is, always as many; none (the default): h is no such maximum.
    fn parts(&self, _outputs: &Vector) -> Vec<OuterPart> {
        vec![]
    }

    /// Σ λ_k Gᵀ∇²h_k G, n × n, for one weight λ_k ≥ 0 per [part](Self::parts): the subproblem is then solved by
    /// Newton's method, with all parts at once. None (the default): it is solved by cuts of h. The answer must not be a
    /// matrix for some outputs and none for others.
    fn parts_curvature(&self, _outputs: &Vector, _jacobian: &Matrix, _weights: &[f64]) -> Option<Matrix> {
        None
    }

    /// The cones that the epigraph of h of so many outputs is built from, if there are any: where h has no curvature,
    /// the subproblem is then solved by an interior-point method (feature `interior-point`; by cuts without it), and
    /// errors of subgradients are taken from the conjugate h*.
    fn epigraph(&self, _outputs: usize) -> Option<Epigraph> {
        None
    }

    /// The kinds of the nonlinear constraints that go with h, which are functions of the outputs too; none by default.
    fn constraint_kinds(&self) -> &[ConstraintKind] {
        &[]
    }

    /// The constraints at outputs: pieces of which each constraint is the largest, at least one per constraint.
    fn constraint_pieces(&self, _outputs: &Vector) -> Vec<OutputPiece> {
        vec![]
    }

    /// Whether h(t c) = t h(c) for all t > 0, as for maxima and norms; false by default. A subgradient at outputs far
    /// away then says as much about h here as if it had been taken nearby, without the rounding of large numbers.
    fn is_homogeneous(&self) -> bool {
        false
    }
}

impl<H: OuterFunction + ?Sized> OuterFunction for &H {
    fn value(&self, outputs: &Vector) -> f64 {
        (**self).value(outputs)
    }

    fn subgradient(&self, outputs: &Vector) -> Vector {
        (**self).subgradient(outputs)
    }

    fn curvature(&self, outputs: &Vector, jacobian: &Matrix) -> Option<Matrix> {
        (**self).curvature(outputs, jacobian)
    }

    fn parts(&self, outputs: &Vector) -> Vec<OuterPart> {
        (**self).parts(outputs)
    }

    fn parts_curvature(&self, outputs: &Vector, jacobian: &Matrix, weights: &[f64]) -> Option<Matrix> {
        (**self).parts_curvature(outputs, jacobian, weights)
    }

    fn epigraph(&self, outputs: usize) -> Option<Epigraph> {
        (**self).epigraph(outputs)
    }

    fn constraint_kinds(&self) -> &[ConstraintKind] {
        (**self).constraint_kinds()
    }

    fn constraint_pieces(&self, outputs: &Vector) -> Vec<OutputPiece> {
        (**self).constraint_pieces(outputs)
    }

    fn is_homogeneous(&self) -> bool {
        (**self).is_homogeneous()
    }
}

/// h(c) = max_i c_i: minimax problems; NaN if one of the outputs is.
#[derive(Debug, Clone, Copy, Default)]
pub struct Maximum;

impl OuterFunction for Maximum {
    fn value(&self, outputs: &Vector) -> f64 {
        // `f64::max` would leave out what is NaN.
        outputs
            .iter()
            .copied()
            .fold(f64::NEG_INFINITY, |most, next| if most.is_nan() || most > next { most } else { next })
    }

    /// The unit vector of the first largest output.
    fn subgradient(&self, outputs: &Vector) -> Vector {
        let largest = self.value(outputs);
        let first = outputs.iter().position(|output| *output == largest).unwrap_or(0);
        Vector::from_fn(outputs.len(), |i, _| f64::from(u8::from(i == first)))
    }

    fn epigraph(&self, outputs: usize) -> Option<Epigraph> {
        Some(Epigraph::of(ConeFunction::Largest, outputs))
    }

    fn is_homogeneous(&self) -> bool {
        true
    }
}

/// h(c) = Σ |c_i|^p, p ≥ 1: sums of absolute values (p = 1), of squares, of powers.
#[derive(Debug, Clone, Copy)]
pub struct SumOfPowers {
    /// The exponent p ≥ 1.
    pub exponent: f64,
}

impl OuterFunction for SumOfPowers {
    fn value(&self, outputs: &Vector) -> f64 {
        outputs.iter().map(|output| output.abs().powf(self.exponent)).sum()
    }

    fn subgradient(&self, outputs: &Vector) -> Vector {
        let p = self.exponent;
        outputs.map(|output| if output == 0.0 { 0.0 } else { p * output.abs().powf(p - 1.0) * output.signum() })
    }

    /// None below p = 2, where the curvature grows without bound at 0.
    fn curvature(&self, outputs: &Vector, jacobian: &Matrix) -> Option<Matrix> {
        let p = self.exponent;
        (p >= 2.0).then(|| weighted_gram(jacobian, &outputs.map(|output| p * (p - 1.0) * output.abs().powf(p - 2.0))))
    }

    /// None below p = 1, where h is not convex.
    fn epigraph(&self, outputs: usize) -> Option<Epigraph> {
        let function = match self.exponent {
            1.0 => ConeFunction::AbsoluteValues,
            exponent => ConeFunction::Powers { exponent },
        };
        let convex = self.exponent >= 1.0 && self.exponent.is_finite();
        convex.then(|| Epigraph::of(function, outputs))
    }

    fn is_homogeneous(&self) -> bool {
        self.exponent == 1.0
    }
}

/// h(c) = |c|₂.
#[derive(Debug, Clone, Copy, Default)]
pub struct EuclideanNorm;

impl OuterFunction for EuclideanNorm {
    fn value(&self, outputs: &Vector) -> f64 {
        outputs.norm()
    }

    fn subgradient(&self, outputs: &Vector) -> Vector {
        let size = outputs.norm();
        if size > 0.0 { outputs / size } else { Vector::zeros(outputs.len()) }
    }

    fn epigraph(&self, outputs: usize) -> Option<Epigraph> {
        Some(Epigraph::of(ConeFunction::Norm, outputs))
    }

    fn is_homogeneous(&self) -> bool {
        true
    }
}

/// h(c) = Σ max(0, c_i): hinge losses, and exact penalties of constraints c_i ≤ 0.
#[derive(Debug, Clone, Copy, Default)]
pub struct PositiveParts;

impl OuterFunction for PositiveParts {
    fn value(&self, outputs: &Vector) -> f64 {
        // `f64::max` would take NaN for 0.
        outputs.iter().map(|&output| if output <= 0.0 { 0.0 } else { output }).sum()
    }

    fn subgradient(&self, outputs: &Vector) -> Vector {
        outputs.map(|output| if output <= 0.0 { 0.0 } else { 1.0 })
    }

    fn epigraph(&self, outputs: usize) -> Option<Epigraph> {
        Some(Epigraph::of(ConeFunction::PositiveParts, outputs))
    }

    fn is_homogeneous(&self) -> bool {
        true
    }
}

/// h(c) = Σ |c_g|₂ over consecutive groups c_g of outputs: penalties that let whole groups vanish.
#[derive(Debug, Clone, Default)]
pub struct GroupNorms {
    /// Numbers of outputs in the groups, with the number of all outputs as their sum; for any other number of outputs h
    /// is NaN.
    pub sizes: Vec<usize>,
}

impl GroupNorms {
    /// First output and size of every group.
    fn groups(&self) -> impl Iterator<Item = (usize, usize)> {
        self.sizes.iter().scan(0, |end, &size| {
            *end += size;
            Some((*end - size, size))
        })
    }

    fn fits(&self, outputs: &Vector) -> bool {
        self.sizes.iter().sum::<usize>() == outputs.len()
    }
}

impl OuterFunction for GroupNorms {
    fn value(&self, outputs: &Vector) -> f64 {
        if !self.fits(outputs) {
            return f64::NAN;
        }
        self.groups().map(|(first, size)| outputs.rows(first, size).norm()).sum()
    }

    fn subgradient(&self, outputs: &Vector) -> Vector {
        if !self.fits(outputs) {
            return Vector::from_element(outputs.len(), f64::NAN);
        }
        let mut subgradient = Vector::zeros(outputs.len());
        for (first, size) in self.groups() {
            let group = outputs.rows(first, size);
            let length = group.norm();
            if length > 0.0 {
                subgradient.rows_mut(first, size).copy_from(&(group / length));
            }
        }
        subgradient
    }

    fn epigraph(&self, outputs: usize) -> Option<Epigraph> {
        let of_groups = |sum: Epigraph, &size: &usize| sum.and(ConeFunction::Norm, 1.0, size);
        (self.sizes.iter().sum::<usize>() == outputs).then(|| self.sizes.iter().fold(Epigraph::default(), of_groups))
    }

    fn is_homogeneous(&self) -> bool {
        true
    }
}

/// A closure `c ↦ (h(c), one subgradient)` as an outer function without a curvature: its subproblems are solved by cuts
/// of h.
///
/// ```
/// use nonsmooth::{Vector, composite::{FnOuter, OuterFunction}};
/// // An exact penalty: c₀ + 10 Σ max(c_i, 0).
/// let penalty = FnOuter::new(|c: &Vector| {
///     let violated = |i: usize| i > 0 && c[i] > 0.0;
///     let value = c[0] + (1..c.len()).filter(|&i| violated(i)).map(|i| 10.0 * c[i]).sum::<f64>();
///     let slope = |i: usize| if i == 0 { 1.0 } else if violated(i) { 10.0 } else { 0.0 };
///     (value, Vector::from_fn(c.len(), |i, _| slope(i)))
/// });
/// assert_eq!(penalty.value(&Vector::from_vec(vec![1.0, -3.0, 2.0])), 21.0);
/// ```
#[derive(Debug, Clone)]
pub struct FnOuter<F>(F);

impl<F: Fn(&Vector) -> (f64, Vector)> FnOuter<F> {
    /// The function of a closure; h must be convex.
    pub fn new(function: F) -> Self {
        Self(function)
    }
}

impl<F: Fn(&Vector) -> (f64, Vector)> OuterFunction for FnOuter<F> {
    fn value(&self, outputs: &Vector) -> f64 {
        (self.0)(outputs).0
    }

    fn subgradient(&self, outputs: &Vector) -> Vector {
        (self.0)(outputs).1
    }
}

/// Gᵀ diag(weights) G, n × n, for G of shape m × n and m weights: the curvature of a sum of functions of single
/// outputs, whose second derivatives are the weights.
pub fn weighted_gram(jacobian: &Matrix, weights: &Vector) -> Matrix {
    let mut scaled = jacobian.clone();
    for (mut row, weight) in scaled.row_iter_mut().zip(weights.iter()) {
        row *= *weight;
    }
    let product = jacobian.tr_mul(&scaled);
    (&product + product.transpose()) * 0.5
}
