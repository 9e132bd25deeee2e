//! A smooth function plus a convex function of outputs.
//!
//! ```text
//! Θ(x) = s(x) + μ h(c(x)),    outputs (s, c_1, …, c_m),    outer function (s, c) ↦ s + μ h(c)
//! ```
//! The smooth part is an output like the others: the model linearizes it, and learns its curvature from gradients at
//! other points once steps fail without it. Where h is built from cones, so is the sum.

use super::{Epigraph, OuterFunction};
use crate::{Matrix, Vector};

/// (s, c) ↦ s + μ h(c): the value of a smooth function is the first output, those of h follow.
///
/// ```
/// use nonsmooth::composite::{SmoothPlus, SumOfPowers};
/// use nonsmooth::{BundleTrust, BundleTrustConfig, CompositeFunction, Matrix, Vector};
/// // The lasso ½|x − b|² + ½|x|₁, whose minimiser is b with every entry moved by ½ towards zero.
/// let b = Vector::from_vec(vec![2.0, 0.3, -1.0]);
/// let outer = SmoothPlus { weight: 0.5, outer: SumOfPowers { exponent: 1.0 } };
/// let theta = CompositeFunction::new(3, outer, |x: &Vector| {
///     let residual = x - &b;
///     SmoothPlus::stack((0.5 * residual.norm_squared(), &residual), (x, &Matrix::identity(3, 3)))
/// });
/// let report = BundleTrust::new(BundleTrustConfig::default())?.minimize(&theta, Vector::zeros(3))?;
/// assert!(report.termination.is_confirmed(), "{report}");
/// // To second order in the error of x, the value is that of the minimum.
/// assert!(report.value - 1.295 < 1e-9);
/// assert!((report.solution - Vector::from_vec(vec![1.5, 0.0, -0.5])).amax() < 1e-4);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, Copy)]
pub struct SmoothPlus<H> {
    /// The factor μ > 0 of h.
    pub weight: f64,
    /// The convex function h of the other outputs.
    pub outer: H,
}

impl SmoothPlus<()> {
    /// The outputs (s, c), m + 1 entries, and their Jacobian, from value and gradient of the smooth part (n entries),
    /// and from m outputs with their m × n Jacobian.
    ///
    /// # Panics
    /// If gradient and Jacobian have different numbers of variables.
    pub fn stack((value, gradient): (f64, &Vector), (outputs, jacobian): (&Vector, &Matrix)) -> (Vector, Matrix) {
        let mut stacked = jacobian.clone().insert_row(0, 0.0);
        stacked.set_row(0, &gradient.transpose());
        (outputs.clone().insert_row(0, value), stacked)
    }
}

impl<H: OuterFunction> OuterFunction for SmoothPlus<H> {
    fn value(&self, outputs: &Vector) -> f64 {
        outputs[0] + self.weight * self.outer.value(&others(outputs))
    }

    fn subgradient(&self, outputs: &Vector) -> Vector {
        (self.outer.subgradient(&others(outputs)) * self.weight).insert_row(0, 1.0)
    }

    fn epigraph(&self, outputs: usize) -> Option<Epigraph> {
        let of_others = self.outer.epigraph(outputs.checked_sub(1)?)?;
        (self.weight > 0.0).then(|| of_others.after_linear(self.weight))
    }

    fn is_homogeneous(&self) -> bool {
        self.outer.is_homogeneous()
    }
}

/// The outputs without the first.
fn others(outputs: &Vector) -> Vector {
    outputs.rows(1, outputs.len() - 1).into_owned()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::composite::{EuclideanNorm, GroupNorms, Maximum, PositiveParts, SumOfPowers};
    use crate::verify::seeded_direction;

    #[test]
    fn subgradients_of_sums_lie_below_the_sums() {
        let groups = GroupNorms { sizes: vec![2, 3] };
        let functions: [&dyn OuterFunction; 5] =
            [&Maximum, &SumOfPowers { exponent: 1.0 }, &EuclideanNorm, &PositiveParts, &groups];
        for outer in functions {
            let h = SmoothPlus { weight: 0.3, outer };
            for seed in 0..50 {
                let (a, b) = (seeded_direction(6, seed), seeded_direction(6, seed + 1000));
                let cut = h.value(&a) + h.subgradient(&a).dot(&(&b - &a));
                assert!(cut <= h.value(&b) + 1e-14);
            }
        }
    }
}
