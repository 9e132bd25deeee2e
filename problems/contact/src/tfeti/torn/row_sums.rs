//! Inner products of vectors over the rows of B, or over the unknowns of an active set: rows of B_E, then contact.
//!
//! ```text
//! Σ over rows of B_E = Σ over subdomains of the rows that they own, by the tree of the distribution;   contact rows are everywhere
//! ```

use crate::linear::parallel::for_parts;
use crate::linear::sums::Sums;
use crate::tfeti::torn::constraints::Constraints;
use crate::tfeti::torn::distribution::Distribution;
use std::ops::Range;

/// Sums over the rows of all processes.
#[derive(Debug, Clone, Copy)]
pub struct RowSums<'a> {
    /// Whose rows belong to which subdomain.
    pub constraints: &'a Constraints,
    /// Which process has which subdomain.
    pub distribution: &'a Distribution,
}

/// Below this many products one thread is faster than two.
const PARALLEL_PRODUCTS: usize = 1 << 14;

impl Sums for RowSums<'_> {
    fn sum(&self, length: usize, count: usize, of: &(dyn Fn(Range<usize>, &mut [f64]) + Sync)) -> Vec<f64> {
        if count == 0 {
            return vec![];
        }
        let bounds = &self.constraints.owned_rows;
        let mut terms = vec![0.0; count * (bounds.len() - 1)];
        let part = |index: usize, sums: &mut [f64]| of(bounds[index]..bounds[index + 1], sums);
        if count * length < PARALLEL_PRODUCTS {
            terms.chunks_exact_mut(count).enumerate().for_each(|(index, sums)| part(index, sums));
        } else {
            for_parts(terms.chunks_exact_mut(count), &part);
        }
        let mut sums = self.distribution.sum(&terms, count);
        of(self.constraints.equality_count..length, &mut sums);
        sums
    }
}
