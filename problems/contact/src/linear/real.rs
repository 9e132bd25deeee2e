//! Floating point numbers of blocks of columns: single or double precision.

use crate::linear::cholesky::NumericFactor;
use num_traits::Float;
use std::fmt::Debug;

/// A precision of block computations.
pub trait Real: Float + Debug + Send + Sync + 'static {
    /// Zero.
    const ZERO: Self;

    /// Rounded from double precision.
    fn of(value: f64) -> Self;

    /// In double precision.
    fn double(self) -> f64;

    /// The values of a Cholesky factor in this precision.
    fn factor_values(factor: &NumericFactor) -> &[Self];
}

impl Real for f64 {
    const ZERO: Self = 0.0;

    #[inline(always)]
    fn of(value: f64) -> Self {
        value
    }

    #[inline(always)]
    fn double(self) -> f64 {
        self
    }

    fn factor_values(factor: &NumericFactor) -> &[Self] {
        factor.values()
    }
}

impl Real for f32 {
    const ZERO: Self = 0.0;

    #[inline(always)]
    fn of(value: f64) -> Self {
        value as f32
    }

    #[inline(always)]
    fn double(self) -> f64 {
        f64::from(self)
    }

    fn factor_values(factor: &NumericFactor) -> &[Self] {
        factor.single_values()
    }
}
