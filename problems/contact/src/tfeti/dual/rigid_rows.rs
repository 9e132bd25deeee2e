//! Gᵀ: rows of B times the rigid modes, in blocks of the six amplitudes of a cluster or single subdomain.

use crate::body::MOTIONS;
use crate::linear::entry::{Entry, vectorized};
use crate::linear::parallel::for_parts;
use std::ops::Range;

/// What a row of B does to the six rigid amplitudes of a cluster.
pub type Six = [f64; MOTIONS];

/// Blocks row by row, or the same blocks cluster by cluster.
#[derive(Debug)]
pub struct RigidRows {
    starts: Vec<usize>,
    /// Subdomains of the blocks, or rows.
    others: Vec<u32>,
    values: Vec<Six>,
}

/// Lists that one task works on.
const LISTS_AT_ONCE: usize = 512;

impl RigidRows {
    /// An empty list of rows.
    pub fn new() -> Self {
        Self { starts: vec![0], others: Vec::new(), values: Vec::new() }
    }

    /// Appends rows of (cluster, block).
    pub fn extend(&mut self, rows: impl IntoIterator<Item = Vec<(usize, Six)>>) {
        for row in rows {
            for (cluster, block) in row {
                self.others.push(u32::try_from(cluster).expect("invariant: fewer than 2³² clusters"));
                self.values.push(block);
            }
            self.starts.push(self.others.len());
        }
    }

    pub fn count(&self) -> usize {
        self.starts.len() - 1
    }

    /// The blocks of a row with their clusters, or those of a cluster with their rows, ascending.
    pub fn blocks(&self, list: usize) -> impl Iterator<Item = (usize, &Six)> {
        let range = self.starts[list]..self.starts[list + 1];
        self.others[range.clone()].iter().map(|&other| other as usize).zip(&self.values[range])
    }

    /// The blocks of some clusters, cluster by cluster.
    pub fn of_clusters(&self, clusters: Range<usize>) -> Self {
        let mut starts = vec![0; clusters.len() + 1];
        let place = |cluster: &u32| (*cluster as usize).checked_sub(clusters.start).filter(|s| *s < clusters.len());
        self.others.iter().filter_map(place).for_each(|place| starts[place + 1] += 1);
        (0..clusters.len()).for_each(|place| starts[place + 1] += starts[place]);
        let count = starts[clusters.len()];
        let (mut others, mut values, mut next) = (vec![0; count], vec![[0.0; MOTIONS]; count], starts.clone());
        for row in 0..self.count() {
            let range = self.starts[row]..self.starts[row + 1];
            for (cluster, block) in self.others[range.clone()].iter().zip(&self.values[range]) {
                if let Some(place) = place(cluster) {
                    others[next[place]] = u32::try_from(row).expect("invariant: fewer than 2³² rows");
                    values[next[place]] = *block;
                    next[place] += 1;
                }
            }
        }
        Self { starts, others, values }
    }

    /// Gᵀ a, where the lists are rows.
    pub fn jumps<V: Entry>(&self, amplitudes: &[V]) -> Vec<V> {
        let mut result = vec![V::ZERO; self.count()];
        for_parts(result.chunks_mut(LISTS_AT_ONCE), &|chunk, result| {
            vectorized(
                #[inline(always)]
                || {
                    for (offset, jump) in result.iter_mut().enumerate() {
                        for (cluster, block) in self.blocks(chunk * LISTS_AT_ONCE + offset) {
                            let own = &amplitudes[MOTIONS * cluster..MOTIONS * (cluster + 1)];
                            block.iter().zip(own).for_each(|(&value, amplitude)| jump.accumulate(value, amplitude));
                        }
                    }
                },
            );
        });
        result
    }

    /// G λ, six entries per cluster, where the lists are clusters.
    pub fn resultants<V: Entry>(&self, multipliers: &[V]) -> Vec<V> {
        let mut result = vec![V::ZERO; MOTIONS * self.count()];
        for_parts(result.chunks_exact_mut(MOTIONS), &|cluster, six| {
            vectorized(
                #[inline(always)]
                || {
                    for (row, block) in self.blocks(cluster) {
                        let multiplier = &multipliers[row];
                        six.iter_mut().zip(block).for_each(|(sum, &value)| sum.accumulate(value, multiplier));
                    }
                },
            );
        });
        result
    }
}
