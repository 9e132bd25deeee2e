//! The cones behind the built-in outer functions, and their conjugates.
//!
//! ```text
//! Σ|c_i|^p:  t_i^(1/p) ≥ |c_i|  (power cones; two half-spaces each for p = 1)      h*(w) = Σ (p − 1)(|w_i|/p)^(p/(p−1))
//! |c|₂:      (t, c) in the second-order cone                                       h*(w) = 0 where |w| ≤ 1, else ∞
//! error of w at c:  h(c) − ⟨w, c⟩ + h*(w) ≥ 0,   0 where w ∈ ∂h(c)
//! ```

use crate::Vector;

/// A convex function of the outputs whose epigraph is built from cones.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum Epigraph {
    /// Σ |c_i|^p.
    SumOfPowers {
        /// The exponent p ≥ 1.
        exponent: f64,
    },
    /// |c|₂.
    EuclideanNorm,
}

impl Epigraph {
    /// h*(w) = sup ⟨w, c⟩ − h(c) over c, in units of h, for w with one entry per output; ∞ where w is no subgradient of
    /// h anywhere.
    pub fn conjugate(&self, weights: &Vector) -> f64 {
        match *self {
            Self::EuclideanNorm if weights.norm() <= unit(weights.len()) => 0.0,
            Self::SumOfPowers { exponent: 1.0 } if weights.amax() <= 1.0 => 0.0,
            Self::EuclideanNorm | Self::SumOfPowers { exponent: 1.0 } => f64::INFINITY,
            Self::SumOfPowers { exponent: p } => {
                weights.iter().map(|w| (p - 1.0) * (w.abs() / p).powf(p / (p - 1.0))).sum()
            }
        }
    }

    /// The nearest w at which h* is finite.
    #[cfg(any(test, feature = "interior-point"))]
    pub(crate) fn within_domain(&self, weights: Vector) -> Vector {
        match self {
            Self::EuclideanNorm => {
                let size = weights.norm().max(1.0);
                weights / size
            }
            Self::SumOfPowers { exponent: 1.0 } => weights.map(|w| w.clamp(-1.0, 1.0)),
            Self::SumOfPowers { .. } => weights,
        }
    }
}

/// One plus the rounding that the length of a vector with so many entries can have after division by this length.
fn unit(entries: usize) -> f64 {
    1.0 + (4.0 + entries as f64) * f64::EPSILON
}

#[cfg(test)]
mod tests {
    use crate::composite::{EuclideanNorm, OuterFunction, SumOfPowers};
    use crate::verify::seeded_direction;

    #[test]
    fn subgradients_have_error_zero_and_other_weights_a_positive_one() {
        let powers = [1.0, 1.2, 1.5, 2.0, 3.0].map(|exponent| SumOfPowers { exponent });
        let functions = powers.iter().map(|h| h as &dyn OuterFunction).chain([&EuclideanNorm as &dyn OuterFunction]);
        for h in functions {
            let epigraph = h.epigraph().expect("built from cones");
            for seed in 0..50 {
                let (c, other) = (seeded_direction(6, seed) * 2.0, seeded_direction(6, seed + 100));
                let error = |w: &crate::Vector| h.value(&c) - w.dot(&c) + epigraph.conjugate(w);
                assert!(error(&h.subgradient(&c)).abs() <= 1e-13);
                assert!(error(&epigraph.within_domain(other * 3.0)) >= -1e-13);
            }
        }
    }
}
