//! The cones behind the built-in outer functions, and their conjugates.
//!
//! ```text
//! h(c) = Σ_k μ_k h_k(c of term k),    h*(w) = Σ_k μ_k h_k*(w/μ_k)
//! c_i:          no cone                                                             w_i = 1
//! Σ|c_i|:       two half-spaces each                                                |w_i| ≤ 1
//! Σ max(0, c_i): two half-spaces each                                               0 ≤ w_i ≤ 1
//! max c_i:      one half-space each                                                 w_i ≥ 0, Σ w_i = 1
//! |c|₂:         (t, c) in the second-order cone                                     |w|₂ ≤ 1
//! Σ|c_i|^p:     t_i^(1/p) ≥ |c_i|  (power cones)                  h*(w) = Σ (p − 1)(|w_i|/p)^(p/(p−1))
//! error of w at c:  h(c) − ⟨w, c⟩ + h*(w) ≥ 0,   0 where w ∈ ∂h(c)
//! ```

use crate::Vector;
use std::ops::Range;

/// A convex function of the outputs as a sum of terms of consecutive outputs, whose epigraphs are cones; by default the
/// function 0 of no outputs.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Epigraph {
    terms: Vec<EpigraphTerm>,
}

/// One term of a sum: μ h_k of some outputs.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct EpigraphTerm {
    /// The outputs of the term.
    pub outputs: Range<usize>,
    /// The factor μ: > 0, or of any sign where the function is linear.
    pub weight: f64,
    /// The function h_k.
    pub function: ConeFunction,
}

/// A function whose epigraph is a cone, or a product of cones.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum ConeFunction {
    /// Σ c_i.
    Linear,
    /// Σ |c_i|.
    AbsoluteValues,
    /// Σ max(0, c_i).
    PositiveParts,
    /// max c_i.
    Largest,
    /// |c|₂.
    Norm,
    /// Σ |c_i|^p.
    Powers {
        /// The exponent p > 1.
        exponent: f64,
    },
}

impl Epigraph {
    /// A function of `count` outputs.
    pub fn of(function: ConeFunction, count: usize) -> Self {
        Self::default().and(function, 1.0, count)
    }

    /// The sum with a factor times a function of `count` further outputs. The factor `weight` must be > 0, unless the
    /// function is linear.
    #[must_use]
    pub fn and(mut self, function: ConeFunction, weight: f64, count: usize) -> Self {
        let first = self.count();
        self.terms.push(EpigraphTerm { outputs: first..first + count, weight, function });
        self
    }

    /// The sum of one more output, before all others, with this function times a factor > 0.
    #[must_use]
    pub fn after_linear(mut self, factor: f64) -> Self {
        for term in &mut self.terms {
            term.outputs = term.outputs.start + 1..term.outputs.end + 1;
            term.weight *= factor;
        }
        self.terms.insert(0, EpigraphTerm { outputs: 0..1, weight: 1.0, function: ConeFunction::Linear });
        self
    }

    /// The terms, in the order of their outputs.
    #[cfg(feature = "interior-point")]
    pub(crate) fn terms(&self) -> &[EpigraphTerm] {
        &self.terms
    }

    /// Whether h is a maximum of outputs: a cut is one of them, and few of them count.
    #[cfg(feature = "interior-point")]
    pub(crate) fn is_maximum(&self) -> bool {
        let counting = self.terms.iter().filter(|term| term.weight != 0.0);
        counting.map(|term| term.function).eq([ConeFunction::Largest])
    }

    /// The number of outputs.
    fn count(&self) -> usize {
        self.terms.last().map_or(0, |term| term.outputs.end)
    }

    /// h*(w) = sup ⟨w, c⟩ − h(c) over c, in units of h, for w with one entry per output; ∞ where w is no subgradient of
    /// h anywhere.
    pub fn conjugate(&self, weights: &Vector) -> f64 {
        if weights.len() != self.count() {
            return f64::INFINITY;
        }
        let of_term = |term: &EpigraphTerm| {
            let own = weights.rows(term.outputs.start, term.outputs.len());
            term.function.conjugate(&own.into_owned(), term.weight)
        };
        self.terms.iter().map(of_term).sum()
    }

    /// The nearest w at which h* is finite.
    #[cfg(any(test, feature = "interior-point"))]
    pub(crate) fn within_domain(&self, mut weights: Vector) -> Vector {
        for EpigraphTerm { outputs, weight, function } in &self.terms {
            let mut own = weights.rows_mut(outputs.start, outputs.len());
            let inside = function.within_domain(own.clone_owned(), *weight);
            own.copy_from(&inside);
        }
        weights
    }
}

impl ConeFunction {
    /// The conjugate of μ h, at w.
    fn conjugate(self, weights: &Vector, factor: f64) -> f64 {
        let unit = factor.abs() * (1.0 + (4.0 + weights.len() as f64) * f64::EPSILON);
        let inside = match self {
            Self::Linear => weights.iter().all(|w| *w == factor),
            Self::AbsoluteValues => weights.amax() <= factor,
            Self::PositiveParts => weights.iter().all(|w| (0.0..=factor).contains(w)),
            Self::Largest => weights.iter().all(|w| *w >= 0.0) && (weights.sum() - factor).abs() <= unit - factor,
            Self::Norm => weights.norm() <= unit,
            Self::Powers { exponent: p } => {
                let of_entry = |w: &f64| factor * (p - 1.0) * (w.abs() / (p * factor)).powf(p / (p - 1.0));
                return weights.iter().map(of_entry).sum();
            }
        };
        if inside { 0.0 } else { f64::INFINITY }
    }

    #[cfg(any(test, feature = "interior-point"))]
    fn within_domain(self, weights: Vector, factor: f64) -> Vector {
        match self {
            Self::Linear => Vector::from_element(weights.len(), factor),
            Self::AbsoluteValues => weights.map(|w| w.clamp(-factor, factor)),
            Self::PositiveParts => weights.map(|w| w.clamp(0.0, factor)),
            Self::Largest => {
                let positive = weights.map(|w| w.max(0.0));
                let sum = positive.sum();
                if sum > 0.0 { positive * (factor / sum) } else { weights.map(|_| factor / weights.len() as f64) }
            }
            Self::Norm => {
                let size = (weights.norm() / factor).max(1.0);
                weights / size
            }
            Self::Powers { .. } => weights,
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::composite::{
        EuclideanNorm, GroupNorms, Maximum, OuterFunction, PositiveParts, SmoothPlus, SumOfPowers, WithConstraints,
    };
    use crate::verify::seeded_direction;
    use crate::{ConstraintKind, Vector};

    #[test]
    fn subgradients_have_error_zero_and_other_weights_a_positive_one() {
        let powers = [1.0, 1.2, 1.5, 2.0, 3.0].map(|exponent| SumOfPowers { exponent });
        let groups = GroupNorms { sizes: vec![2, 4] };
        let plus = |weight| SmoothPlus { weight, outer: GroupNorms { sizes: vec![4, 1] } };
        let with_hinges = SmoothPlus { weight: 0.3, outer: PositiveParts };
        let with_maximum = SmoothPlus { weight: 2.0, outer: Maximum };
        let limited = WithConstraints::new(SumOfPowers { exponent: 1.0 }, vec![ConstraintKind::Smooth; 2]);
        let others: [&dyn OuterFunction; 7] =
            [&EuclideanNorm, &groups, &PositiveParts, &plus(0.7), &with_hinges, &with_maximum, &limited];
        for h in powers.iter().map(|h| h as &dyn OuterFunction).chain(others) {
            for seed in 0..50 {
                let (c, other) = (seeded_direction(6, seed) * 2.0, seeded_direction(6, seed + 100));
                let count = h.subgradient(&c).len();
                let Some(epigraph) = h.epigraph(count) else { panic!("built from cones") };
                let error = |w: &Vector| h.value(&c) - w.dot(&c) + epigraph.conjugate(w);
                assert!(error(&h.subgradient(&c)).abs() <= 1e-13);
                assert!(error(&epigraph.within_domain(other * 3.0)) >= -1e-13);
            }
        }
    }
}
