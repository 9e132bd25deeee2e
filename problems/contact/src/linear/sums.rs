//! Inner products of long vectors: taken part by part, so that their order does not depend on who holds which part.

use crate::linear::vector::{add_scaled, dot};
use std::fmt::Debug;
use std::ops::Range;

/// How sums over the entries of vectors are taken.
pub trait Sums: Debug {
    /// `count` sums over vectors of `length` entries: `of(part, sums)` adds what the entries of a part contribute.
    fn sum(&self, length: usize, count: usize, of: &(dyn Fn(Range<usize>, &mut [f64]) + Sync)) -> Vec<f64>;
}

/// Whole vectors in one part.
#[derive(Debug, Clone, Copy)]
pub struct Whole;

impl Sums for Whole {
    fn sum(&self, length: usize, count: usize, of: &(dyn Fn(Range<usize>, &mut [f64]) + Sync)) -> Vec<f64> {
        let mut sums = vec![0.0; count];
        of(0..length, &mut sums);
        sums
    }
}

impl Whole {
    /// Takes the components along orthonormal vectors off v, twice against rounding; returns them.
    pub fn orthogonalise(v: &mut [f64], basis: &[Vec<f64>]) -> Vec<f64> {
        let sums: &dyn Sums = &Self;
        sums.orthogonalise(v, basis)
    }
}

impl dyn Sums + '_ {
    /// The inner product aᵀb.
    pub fn dot(&self, a: &[f64], b: &[f64]) -> f64 {
        self.dots(&[a], b)[0]
    }

    /// The Euclidean norm |a|₂.
    pub fn norm(&self, a: &[f64]) -> f64 {
        self.dot(a, a).sqrt()
    }

    /// aᵀb for every a of a list.
    pub fn dots(&self, list: &[&[f64]], b: &[f64]) -> Vec<f64> {
        self.sum(b.len(), list.len(), &|part, sums| {
            for (sum, a) in sums.iter_mut().zip(list) {
                *sum += dot(&a[part.clone()], &b[part.clone()]);
            }
        })
    }

    /// Takes the components along orthonormal vectors off v, twice against rounding; returns them.
    pub fn orthogonalise(&self, v: &mut [f64], basis: &[Vec<f64>]) -> Vec<f64> {
        let mut components = vec![0.0; basis.len()];
        let list: Vec<&[f64]> = basis.iter().map(Vec::as_slice).collect();
        for _pass in 0..2 {
            let projections = self.dots(&list, v);
            for ((component, projection), vector) in components.iter_mut().zip(projections).zip(&list) {
                *component += projection;
                add_scaled(v, -projection, vector);
            }
        }
        components
    }
}
