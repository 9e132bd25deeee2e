//! Vectors over the rows of B and over torn dofs: two layouts that every product with B exchanges.

use std::ops::{Deref, DerefMut};

/// A vector over all rows of B, scaled as they are: gluing and supports (B_E) first, then the packed contact rows.
#[derive(Debug, Clone, PartialEq)]
pub struct RowVector {
    values: Vec<f64>,
    equality_count: usize,
}

/// A vector over torn dofs, subdomain by subdomain.
#[derive(Debug, Clone, PartialEq)]
pub struct TornVector(pub Vec<f64>);

impl RowVector {
    pub(crate) fn new(values: Vec<f64>, equality_count: usize) -> Self {
        Self { values, equality_count }
    }

    pub(crate) fn into_values(self) -> Vec<f64> {
        self.values
    }

    /// The rows of B_E, and the packed contact rows.
    pub fn split(&self) -> (&[f64], &[f64]) {
        self.values.split_at(self.equality_count)
    }

    /// The packed contact rows.
    pub fn contact(&self) -> &[f64] {
        self.split().1
    }

    /// The packed contact rows, to be changed.
    pub fn contact_mut(&mut self) -> &mut [f64] {
        &mut self.values[self.equality_count..]
    }
}

impl Deref for RowVector {
    type Target = [f64];

    fn deref(&self) -> &[f64] {
        &self.values
    }
}

impl DerefMut for RowVector {
    fn deref_mut(&mut self) -> &mut [f64] {
        &mut self.values
    }
}
