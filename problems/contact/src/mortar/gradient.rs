//! Numbers with several derivatives at once.
//!
//! ```text
//! Gradient = a + Σ b_k ε_k,  ε_k ε_l = 0:   f(a + Σ b_k ε_k) = f(a) + f′(a) Σ b_k ε_k
//! ```

use crate::scalar::Scalar;
use num_traits::{One, Zero};
use std::ops::{Add, AddAssign, Div, Mul, Sub};

/// Value and the derivatives along `N` directions.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Gradient<const N: usize> {
    pub value: f64,
    pub slopes: [f64; N],
}

impl<const N: usize> Gradient<N> {
    /// The variable of number `index`.
    pub fn variable(value: f64, index: usize) -> Self {
        Self { value, slopes: std::array::from_fn(|k| if k == index { 1.0 } else { 0.0 }) }
    }

    /// The number `value` whose derivatives are a times those of `self` plus b times those of `other`.
    fn combined(&self, a: f64, other: &Self, b: f64, value: f64) -> Self {
        Self { value, slopes: std::array::from_fn(|k| a * self.slopes[k] + b * other.slopes[k]) }
    }
}

impl<const N: usize> Add for Gradient<N> {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        let slopes = std::array::from_fn(|k| self.slopes[k] + other.slopes[k]);
        Self { value: self.value + other.value, slopes }
    }
}

impl<const N: usize> Sub for Gradient<N> {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        let slopes = std::array::from_fn(|k| self.slopes[k] - other.slopes[k]);
        Self { value: self.value - other.value, slopes }
    }
}

impl<const N: usize> Mul for Gradient<N> {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        self.combined(other.value, &other, self.value, self.value * other.value)
    }
}

impl<const N: usize> Div for Gradient<N> {
    type Output = Self;
    fn div(self, other: Self) -> Self {
        let value = self.value / other.value;
        self.combined(1.0 / other.value, &other, -value / other.value, value)
    }
}

impl<const N: usize> AddAssign for Gradient<N> {
    fn add_assign(&mut self, other: Self) {
        self.value += other.value;
        self.slopes.iter_mut().zip(&other.slopes).for_each(|(sum, &slope)| *sum += slope);
    }
}

impl<const N: usize> Zero for Gradient<N> {
    fn zero() -> Self {
        Self::constant(0.0)
    }
    fn is_zero(&self) -> bool {
        self.value == 0.0 && self.slopes.iter().all(|&slope| slope == 0.0)
    }
}

impl<const N: usize> One for Gradient<N> {
    fn one() -> Self {
        Self::constant(1.0)
    }
}

impl<const N: usize> Scalar for Gradient<N> {
    fn constant(value: f64) -> Self {
        Self { value, slopes: [0.0; N] }
    }
    fn value(self) -> f64 {
        self.value
    }
    fn map(self, function: impl Fn(f64) -> f64, slope: impl Fn(f64) -> f64) -> Self {
        let outer = slope(self.value);
        // A constant stays one where the slope is infinite.
        let chain = |inner: f64| if inner == 0.0 { 0.0 } else { outer * inner };
        Self { value: function(self.value), slopes: self.slopes.map(chain) }
    }
    fn power(self, exponent: Self) -> Self {
        let (a, b) = (self.value, exponent.value);
        let value = a.powf(b);
        let slope = |k: usize| {
            let by_base = if self.slopes[k] == 0.0 { 0.0 } else { b * a.powf(b - 1.0) * self.slopes[k] };
            let by_exponent = if exponent.slopes[k] == 0.0 { 0.0 } else { value * a.ln() * exponent.slopes[k] };
            by_base + by_exponent
        };
        Self { value, slopes: std::array::from_fn(slope) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn derivatives_of_a_composed_expression() {
        // f(x, y) = √x·(y − 1)/(x + y) at (4, 2): f = 1/3, f_x = 1/24 − 1/18, f_y = 1/3 − 1/18.
        let (x, y) = (Gradient::<2>::variable(4.0, 0), Gradient::<2>::variable(2.0, 1));
        let f = x.sqrt() * (y - Gradient::one()) / (x + y);
        assert!((f.value - 1.0 / 3.0).abs() < 1e-15);
        assert!((f.slopes[0] - (1.0 / 24.0 - 1.0 / 18.0)).abs() < 1e-15);
        assert!((f.slopes[1] - (1.0 / 3.0 - 1.0 / 18.0)).abs() < 1e-15);
    }

    #[test]
    fn powers_and_sums() {
        let (x, y) = (Gradient::<2>::variable(3.0, 0), Gradient::<2>::variable(2.0, 1));
        let mut f = x.power(y);
        f += y;
        assert!((f.value - 11.0).abs() < 1e-13);
        assert!((f.slopes[0] - 6.0).abs() < 1e-13 && (f.slopes[1] - (9.0 * 3.0_f64.ln() + 1.0)).abs() < 1e-13);
        assert!(Gradient::<2>::zero().is_zero() && !f.is_zero());
    }
}
