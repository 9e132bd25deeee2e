//! Clamped uniform B-spline bases on [0, 1]; with degree = count − 1 the Bernstein (Bézier) basis.
//!
//! ```text
//! N_{i,0}(t) = 1 on [t_i, t_{i+1}),   N_{i,p}(t) = (t − t_i)/(t_{i+p} − t_i) N_{i,p−1} + (t_{i+p+1} − t)/(t_{i+p+1} − t_{i+1}) N_{i+1,p−1}
//! ∫N_{i,p} = (t_{i+p+1} − t_i)/(p + 1)
//! ```

use crate::error::SceneError;
use crate::scalar::Scalar;

/// A spline basis of `count` functions of one degree.
#[derive(Debug, Clone, PartialEq)]
pub struct Basis {
    degree: usize,
    count: usize,
    knots: Vec<f64>,
}

impl Basis {
    /// The clamped uniform basis of `count` functions.
    ///
    /// # Errors
    /// [`SceneError::OutOfRange`] unless 1 ≤ degree < count.
    pub fn clamped_uniform(degree: usize, count: usize) -> Result<Self, SceneError> {
        let allowed = format!("1 ≤ degree ≤ {} for {count} control points along an axis", count.saturating_sub(1));
        SceneError::require((1..count).contains(&degree), "lattice.degrees", degree, allowed)?;
        Self::clamped(degree, count, "lattice.degrees")
    }

    /// A clamped uniform basis, or the one constant function for one of degree 0; `field` stands in messages.
    ///
    /// # Errors
    /// [`SceneError::OutOfRange`] unless degree < count.
    pub fn clamped(degree: usize, count: usize, field: &str) -> Result<Self, SceneError> {
        let allowed = format!("less than the {count} control points along the axis");
        SceneError::require(degree < count, field, degree, allowed)?;
        let valid = degree > 0 || count == 1;
        SceneError::require(valid, field, degree, format!("at least 1 for {count} control points"))?;
        let spans = count - degree;
        let knots =
            (0..count + degree + 1).map(|index| (index.clamp(degree, count) - degree) as f64 / spans as f64).collect();
        Ok(Self { degree, count, knots })
    }

    /// A clamped basis of this degree with inner knots in (0, 1), ascending.
    pub(crate) fn clamped_at(degree: usize, inner: impl Iterator<Item = f64>) -> Self {
        let mut knots = vec![0.0; degree + 1];
        knots.extend(inner);
        let count = knots.len();
        knots.extend(vec![1.0; degree + 1]);
        Self { degree, count, knots }
    }

    pub fn degree(&self) -> usize {
        self.degree
    }

    /// The means of p neighbouring knots, one per function, with which Σ t_i N_i = t.
    pub fn greville(&self) -> Vec<f64> {
        let degree = self.degree.max(1);
        let mean = |index: usize| self.knots[index + 1..=index + degree].iter().sum::<f64>() / degree as f64;
        (0..self.count).map(mean).collect()
    }

    /// All knots, repetitions listed.
    pub fn knots(&self) -> &[f64] {
        &self.knots
    }

    /// Number of basis functions.
    pub fn count(&self) -> usize {
        self.count
    }

    /// Values of all basis functions at t ∈ [0, 1].
    pub fn values<T: Scalar>(&self, t: T) -> Vec<T> {
        let span = (self.degree..self.count).rev().find(|&span| self.knots[span] <= t.value()).unwrap_or(self.degree);
        let mut values = vec![T::constant(0.0); self.count];
        values[span] = T::constant(1.0);
        for degree in 1..=self.degree {
            for index in span - degree..=span {
                let mut value = T::constant(0.0);
                let (left, right) = (self.knots[index], self.knots[index + degree]);
                if right > left {
                    value += (t - T::constant(left)) / T::constant(right - left) * values[index];
                }
                if index < span {
                    let (left, right) = (self.knots[index + 1], self.knots[index + degree + 1]);
                    if right > left {
                        value += (T::constant(right) - t) / T::constant(right - left) * values[index + 1];
                    }
                }
                values[index] = value;
            }
        }
        values
    }

    /// ∫₀¹ of every basis function.
    pub fn integrals(&self) -> Vec<f64> {
        (0..self.count).map(|i| (self.knots[i + self.degree + 1] - self.knots[i]) / (self.degree + 1) as f64).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scalar::Dual;
    use proptest::prelude::*;

    #[test]
    fn bezier_is_the_bernstein_basis() {
        let basis = Basis::clamped_uniform(5, 6).expect("valid");
        let binomial = [1.0, 5.0, 10.0, 10.0, 5.0, 1.0];
        for (i, value) in basis.values(0.3).into_iter().enumerate() {
            let bernstein = binomial[i] * 0.3_f64.powi(i as i32) * 0.7_f64.powi(5 - i as i32);
            assert!((value - bernstein).abs() < 1e-15);
        }
    }

    #[test]
    fn degree_without_enough_control_points_is_refused() {
        assert!(matches!(Basis::clamped_uniform(3, 3), Err(SceneError::OutOfRange { .. })));
        assert!(matches!(Basis::clamped_uniform(0, 3), Err(SceneError::OutOfRange { .. })));
    }

    proptest! {
        #[test]
        fn partition_of_unity_and_bounded_derivative(
            degree in 1_usize..6, extra in 1_usize..6, t in 0.0_f64..=1.0,
            heights in prop::collection::vec(-1.0_f64..1.0, 12),
        ) {
            let basis = Basis::clamped_uniform(degree, degree + extra).expect("valid");
            let values = basis.values(t);
            prop_assert!((values.iter().sum::<f64>() - 1.0).abs() < 1e-13);
            prop_assert!(values.iter().all(|&value| (-1e-15..=1.0 + 1e-13).contains(&value)));
            // |F′| ≤ p·max|Δα|/min knot distance: the derivative's control values are p·Δα/(t_{i+p+1} − t_{i+1}).
            let values = basis.values(Dual::new(t, 1.0));
            let derivative: f64 = values.iter().zip(&heights).map(|(value, height)| value.derivative * height).sum();
            let bound = (0..basis.count() - 1)
                .map(|i| degree as f64 * (heights[i + 1] - heights[i]).abs()
                    / (basis.knots[i + degree + 1] - basis.knots[i + 1]))
                .fold(0.0, f64::max);
            prop_assert!(derivative.abs() <= bound * (1.0 + 1e-12) + 1e-12, "{derivative} {bound}");
        }

        #[test]
        fn integrals_equal_a_fine_midpoint_rule(degree in 1_usize..5, extra in 1_usize..5) {
            let basis = Basis::clamped_uniform(degree, degree + extra).expect("valid");
            let samples = 4000;
            let mut sums = vec![0.0; basis.count()];
            for sample in 0..samples {
                for (sum, value) in sums.iter_mut().zip(basis.values((sample as f64 + 0.5) / samples as f64)) {
                    *sum += value / samples as f64;
                }
            }
            for (sum, integral) in sums.iter().zip(basis.integrals()) {
                prop_assert!((sum - integral).abs() < 1e-5);
            }
        }
    }
}
