//! Vectors over the rows of B and over torn dofs: two layouts that every product with B exchanges.

use std::ops::{Deref, DerefMut};

/// A vector over the rows of B of a process, scaled as they are: its rows of gluing and supports (B_E) first, then all
/// packed contact rows. An entry is a number, or a row of a block of columns.
#[derive(Debug, Clone, PartialEq)]
pub struct RowVector<V = f64> {
    values: Vec<V>,
    equality_count: usize,
}

/// A vector over the torn dofs of a process, subdomain by subdomain, then over its ghosts.
#[derive(Debug, Clone, PartialEq)]
pub struct TornVector(pub Vec<f64>);

/// The parts of a vector between the starts of subdomains; what follows the last one is left out.
pub fn parts_mut<'v, V>(mut values: &'v mut [V], starts: &[usize]) -> Vec<&'v mut [V]> {
    let mut parts = Vec::with_capacity(starts.len() - 1);
    for pair in starts.windows(2) {
        let (part, rest) = values.split_at_mut(pair[1] - pair[0]);
        parts.push(part);
        values = rest;
    }
    parts
}

impl<V> RowVector<V> {
    pub(crate) fn new(values: Vec<V>, equality_count: usize) -> Self {
        Self { values, equality_count }
    }

    /// The rows of B_E, and the packed contact rows.
    pub fn split(&self) -> (&[V], &[V]) {
        self.values.split_at(self.equality_count)
    }

    /// The packed contact rows.
    pub fn contact(&self) -> &[V] {
        self.split().1
    }

    /// The packed contact rows, to be changed.
    pub fn contact_mut(&mut self) -> &mut [V] {
        &mut self.values[self.equality_count..]
    }
}

impl<V> Deref for RowVector<V> {
    type Target = [V];

    fn deref(&self) -> &[V] {
        &self.values
    }
}

impl<V> DerefMut for RowVector<V> {
    fn deref_mut(&mut self) -> &mut [V] {
        &mut self.values
    }
}
