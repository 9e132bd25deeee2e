//! Numbers of the element kernels: `f64` for work, [`Dual`] for exact derivatives.
//!
//! ```text
//! Dual = a + b·ε, ε² = 0:   f(a + ε) = f(a) + f′(a)·ε
//! ```

use num_traits::{One, Zero};
use std::fmt::Debug;
use std::ops::{Add, AddAssign, Div, Mul, Sub};

/// A field element with square root, enough for shape functions, splines and projections.
pub trait Scalar:
    Zero + One + Sub<Output = Self> + Div<Output = Self> + AddAssign + Copy + Debug + Send + Sync
{
    fn constant(value: f64) -> Self;
    fn value(self) -> f64;
    /// Square root; the argument is positive.
    fn sqrt(self) -> Self {
        self.map(f64::sqrt, |x| 0.5 / x.sqrt())
    }
    /// A function with its slope.
    fn map(self, function: impl Fn(f64) -> f64, slope: impl Fn(f64) -> f64) -> Self;
    /// self to the power `exponent`.
    fn power(self, exponent: Self) -> Self;
}

impl Scalar for f64 {
    fn constant(value: f64) -> Self {
        value
    }
    fn value(self) -> f64 {
        self
    }
    fn map(self, function: impl Fn(f64) -> f64, _slope: impl Fn(f64) -> f64) -> Self {
        function(self)
    }
    fn power(self, exponent: Self) -> Self {
        self.powf(exponent)
    }
}

/// Value and one directional derivative.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Dual {
    pub value: f64,
    /// The coefficient of ε.
    pub derivative: f64,
}

impl Dual {
    /// The number `value + derivative·ε`.
    pub fn new(value: f64, derivative: f64) -> Self {
        Self { value, derivative }
    }
}

impl Add for Dual {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self::new(self.value + other.value, self.derivative + other.derivative)
    }
}

impl Sub for Dual {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        Self::new(self.value - other.value, self.derivative - other.derivative)
    }
}

impl Mul for Dual {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        Self::new(self.value * other.value, self.derivative * other.value + self.value * other.derivative)
    }
}

impl Div for Dual {
    type Output = Self;
    fn div(self, other: Self) -> Self {
        let value = self.value / other.value;
        Self::new(value, (self.derivative - value * other.derivative) / other.value)
    }
}

impl AddAssign for Dual {
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl Zero for Dual {
    fn zero() -> Self {
        Self::new(0.0, 0.0)
    }
    fn is_zero(&self) -> bool {
        self.value == 0.0 && self.derivative == 0.0
    }
}

impl One for Dual {
    fn one() -> Self {
        Self::new(1.0, 0.0)
    }
}

impl Scalar for Dual {
    fn constant(value: f64) -> Self {
        Self::new(value, 0.0)
    }
    fn value(self) -> f64 {
        self.value
    }
    fn map(self, function: impl Fn(f64) -> f64, slope: impl Fn(f64) -> f64) -> Self {
        let inner = self.derivative;
        Self::new(function(self.value), if inner == 0.0 { 0.0 } else { slope(self.value) * inner })
    }
    fn power(self, exponent: Self) -> Self {
        let (a, b) = (self.value, exponent.value);
        let by_base = if self.derivative == 0.0 { 0.0 } else { b * a.powf(b - 1.0) * self.derivative };
        let by_exponent = if exponent.derivative == 0.0 { 0.0 } else { a.powf(b) * a.ln() * exponent.derivative };
        Self::new(a.powf(b), by_base + by_exponent)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn derivative_of_a_composed_expression() {
        // f(x) = √x·(x − 1)/(x + 2) at x = 4: f = 1, f′ = [(1/4)·3 + 2]/6 − 6/36 = 7/24.
        let x = Dual::new(4.0, 1.0);
        let f = x.sqrt() * (x - Dual::one()) / (x + Dual::constant(2.0));
        assert!((f.value - 1.0).abs() < 1e-15);
        assert!((f.derivative - 7.0 / 24.0).abs() < 1e-15);
    }
}
