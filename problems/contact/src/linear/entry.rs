//! Entries of vectors: one number, or one row of a block of columns. Sparse products are written once for both.
//!
//! ```text
//! vector of n numbers:   [f64]            block of n × 8N numbers by rows:   [Row<E, N>],   E single or double
//! ```
//! A block holds what belongs to one row side by side, so that whatever is read for a row (an entry of a sparse matrix,
//! of a factor) serves all columns.

use crate::linear::real::Real;
use faer::traits::pulp::Arch;

/// Numbers per lane group: one register of eight single precision numbers.
pub const LANES: usize = 8;

/// What a vector consists of.
pub trait Entry: Copy + Send + Sync + PartialEq {
    /// Zero in all columns.
    const ZERO: Self;
    /// Number of columns, padding included.
    const WIDTH: usize;

    /// Adds a multiple: self += factor·other.
    fn add_scaled(&mut self, factor: f64, other: &Self);

    /// self += factor·other inside [`vectorized`], where blocks take the instruction with one rounding.
    fn accumulate(&mut self, factor: f64, other: &Self);

    /// Multiplies: self ← factor·self.
    fn scale(&mut self, factor: f64);

    fn get(&self, column: usize) -> f64;

    fn set(&mut self, column: usize, value: f64);
}

impl Entry for f64 {
    const ZERO: Self = 0.0;
    const WIDTH: usize = 1;

    #[inline(always)]
    fn add_scaled(&mut self, factor: f64, other: &Self) {
        *self += factor * other;
    }

    #[inline(always)]
    fn accumulate(&mut self, factor: f64, other: &Self) {
        *self += factor * other;
    }

    #[inline(always)]
    fn scale(&mut self, factor: f64) {
        *self *= factor;
    }

    fn get(&self, _column: usize) -> f64 {
        *self
    }

    fn set(&mut self, _column: usize, value: f64) {
        *self = value;
    }
}

/// One row of a block of 8N columns.
// Aligned, so that no register is loaded from two cache lines.
#[repr(align(32))]
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Row<E, const N: usize>(pub [[E; LANES]; N]);

impl<E: Real, const N: usize> Row<E, N> {
    /// Converts the row to another precision.
    #[inline(always)]
    pub fn to<F: Real>(self) -> Row<F, N> {
        Row(self.0.map(|lanes| lanes.map(|entry| F::of(entry.double()))))
    }

    /// The row made of what `combine` gives for every column of this and another row.
    #[inline(always)]
    pub fn zip<F: Real, H: Real>(&self, other: &Row<F, N>, combine: impl Fn(E, F) -> H) -> Row<H, N> {
        Row(std::array::from_fn(|n| std::array::from_fn(|l| combine(self.0[n][l], other.0[n][l]))))
    }

    /// self += factors∘other, one factor per column.
    #[inline(always)]
    pub fn add_product(&mut self, factors: &Self, other: &Self) {
        for ((lanes, factors), other) in self.0.iter_mut().zip(&factors.0).zip(&other.0) {
            for ((entry, &factor), &other) in lanes.iter_mut().zip(factors).zip(other) {
                *entry = *entry + factor * other;
            }
        }
    }

    /// self += factor·other with one rounding; only inside [`vectorized`], where processors have an instruction for it.
    #[inline(always)]
    pub fn add_fused(&mut self, factor: E, other: &Self) {
        for (lanes, other) in self.0.iter_mut().zip(&other.0) {
            for (entry, &other) in lanes.iter_mut().zip(other) {
                *entry = factor.mul_add(other, *entry);
            }
        }
    }

    /// All numbers, column by column.
    pub fn iter(&self) -> impl Iterator<Item = E> + '_ {
        self.0.iter().flatten().copied()
    }

    /// The row of what `change` makes of every number.
    #[inline(always)]
    pub fn map(self, change: impl Fn(E) -> E) -> Self {
        Row(self.0.map(|lanes| lanes.map(&change)))
    }
}

impl<E: Real, const N: usize> Entry for Row<E, N> {
    const ZERO: Self = Row([[E::ZERO; LANES]; N]);
    const WIDTH: usize = LANES * N;

    #[inline(always)]
    fn add_scaled(&mut self, factor: f64, other: &Self) {
        let factor = E::of(factor);
        for (lanes, other) in self.0.iter_mut().zip(&other.0) {
            for (entry, &other) in lanes.iter_mut().zip(other) {
                *entry = *entry + factor * other;
            }
        }
    }

    #[inline(always)]
    fn accumulate(&mut self, factor: f64, other: &Self) {
        self.add_fused(E::of(factor), other);
    }

    #[inline(always)]
    fn scale(&mut self, factor: f64) {
        let factor = E::of(factor);
        *self = self.map(|entry| factor * entry);
    }

    fn get(&self, column: usize) -> f64 {
        self.0[column / LANES][column % LANES].double()
    }

    fn set(&mut self, column: usize, value: f64) {
        self.0[column / LANES][column % LANES] = E::of(value);
    }
}

/// Runs `work`, compiled for the widest registers of this processor known to faer; what it calls must be inlined.
#[inline(always)]
pub fn vectorized<R>(work: impl FnOnce() -> R) -> R {
    Arch::new().dispatch(work)
}
