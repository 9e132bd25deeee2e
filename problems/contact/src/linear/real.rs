//! Floating point numbers of blocks of columns: single or double precision.

use num_traits::Float;
use std::fmt::Debug;

/// A precision of block computations.
pub trait Real: Float + Debug + Send + Sync + 'static {
    const ZERO: Self;

    /// Rounded from double precision.
    fn of(value: f64) -> Self;

    /// Converts the number to double precision.
    fn double(self) -> f64;

    /// The numbers of this precision, of numbers that are there in both.
    fn chosen<'a>(double: &'a [f64], single: impl FnOnce() -> &'a [f32]) -> &'a [Self];
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

    fn chosen<'a>(double: &'a [f64], _single: impl FnOnce() -> &'a [f32]) -> &'a [Self] {
        double
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

    fn chosen<'a>(_double: &'a [f64], single: impl FnOnce() -> &'a [f32]) -> &'a [Self] {
        single()
    }
}
