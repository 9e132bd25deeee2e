//! Which process works on which subdomains, and how pieces of subdomains become results of all.
//!
//! ```text
//! process r:   the subdomains from bounds[r] to bounds[r + 1]
//! Σ over subdomains:   the tree that halves the range of all subdomains, whatever the bounds
//! ```
//! A process adds up the largest branches of the tree that lie within its range and sends their sums, some 2·log₂ of
//! the number of subdomains; everybody adds those in the order of the tree.

use crate::communication::{Communication, Parcel};
use crate::error::ContactError;
use crate::linear::entry::Entry;
use std::iter::Peekable;
use std::ops::Range;
use std::sync::Arc;

/// The subdomains of all processes, in their order.
#[derive(Debug)]
pub struct Distribution {
    communication: Arc<dyn Communication>,
    /// First subdomain of every process, then the number of subdomains.
    bounds: Vec<usize>,
    /// The largest branches of the tree within the ranges of the processes, in order.
    branches: Vec<Range<usize>>,
    /// Number of branches of every process.
    branch_counts: Vec<usize>,
}

impl Distribution {
    /// Divides subdomains of given weights among the processes: ranges of nearly equal weight.
    pub fn new(communication: Arc<dyn Communication>, weights: &[f64]) -> Self {
        let (size, count) = (communication.size(), weights.len());
        let total: f64 = weights.iter().sum();
        let mut bounds = vec![0];
        let (mut number, mut before) = (0, 0.0);
        for rank in 1..size {
            let share = total * rank as f64 / size as f64;
            // The subdomain at the border goes to whom it belongs with more than half of its weight.
            while number < count && before + 0.5 * weights[number] < share {
                before += weights[number];
                number += 1;
            }
            bounds.push(number);
        }
        bounds.push(count);
        Self::of_bounds(communication, bounds)
    }

    fn of_bounds(communication: Arc<dyn Communication>, bounds: Vec<usize>) -> Self {
        let count = bounds[bounds.len() - 1];
        let (mut branches, mut branch_counts) = (Vec::new(), Vec::new());
        for pair in bounds.windows(2) {
            let first = branches.len();
            cover(0..count, &(pair[0]..pair[1]), &mut branches);
            branch_counts.push(branches.len() - first);
        }
        Self { communication, bounds, branches, branch_counts }
    }

    /// The distribution of the subdomains where this one is that of clusters with these first subdomains.
    pub fn refined(&self, starts: &[usize]) -> Self {
        Self::of_bounds(Arc::clone(&self.communication), self.bounds.iter().map(|&bound| starts[bound]).collect())
    }

    /// The subdomains of this process.
    pub fn owned(&self) -> Range<usize> {
        self.of(self.communication.rank())
    }

    /// The subdomains of a process.
    pub fn of(&self, rank: usize) -> Range<usize> {
        self.bounds[rank]..self.bounds[rank + 1]
    }

    /// The process that works on a subdomain.
    pub fn owner(&self, subdomain: usize) -> usize {
        self.bounds.partition_point(|&bound| bound <= subdomain) - 1
    }

    pub fn count(&self) -> usize {
        self.bounds[self.bounds.len() - 1]
    }

    /// Whether there is no other process.
    pub fn is_alone(&self) -> bool {
        self.communication.size() == 1
    }

    /// What connects the processes.
    pub fn communication(&self) -> &dyn Communication {
        &*self.communication
    }

    /// What this process has computed, if no process has failed.
    ///
    /// # Errors
    /// The own failure, else [`ContactError::Factorization`] with that of the first process that has one. A process
    /// that goes on alone would wait for the others forever.
    pub fn agreed<T>(&self, own: Result<T, ContactError>) -> Result<T, ContactError> {
        match (self.communication().agree(own.as_ref().err().map(ToString::to_string)), own) {
            (Some(reason), Ok(_)) => {
                Err(ContactError::Factorization { what: "subdomain of another process".into(), reason })
            }
            (_, own) => own,
        }
    }

    /// Pieces of all subdomains from those of the own ones.
    pub fn complete(&self, own: Vec<Vec<f64>>) -> Vec<Vec<f64>> {
        if self.is_alone() {
            return own;
        }
        let lengths: Vec<f64> = own.iter().map(|piece| piece.len() as f64).collect();
        let lengths = self.gather(&lengths, 1);
        let counts: Vec<usize> = (0..self.communication.size())
            .map(|rank| lengths[self.of(rank)].iter().map(|&length| length as usize).sum())
            .collect();
        let mut values = self.communication.gather(&own.concat(), &counts).into_iter();
        lengths.iter().map(|&length| values.by_ref().take(length as usize).collect()).collect()
    }

    /// Values of all subdomains at process 0, from those of the own ones; none at the others. `starts`: first value of
    /// every subdomain, then their number.
    pub fn at_first(&self, own: &[f64], starts: &[usize]) -> Option<Vec<f64>> {
        let count = |rank: usize| {
            let subdomains = self.of(rank);
            starts[subdomains.end] - starts[subdomains.start]
        };
        let parcel = |rank: usize, outgoing: &[f64], count: usize| Parcel {
            rank,
            outgoing: outgoing.to_vec(),
            incoming: vec![0.0; count],
        };
        if self.communication.rank() > 0 {
            self.communication.exchange(&mut [parcel(0, own, 0)]);
            return None;
        }
        let mut parcels: Vec<Parcel> =
            (1..self.communication.size()).map(|rank| parcel(rank, &[], count(rank))).collect();
        self.communication.exchange(&mut parcels);
        Some(own.iter().copied().chain(parcels.into_iter().flat_map(|parcel| parcel.incoming)).collect())
    }

    /// Entries of all subdomains, `each` per subdomain, from those of the own ones.
    pub fn gather<V: Entry>(&self, own: &[V], each: usize) -> Vec<V> {
        if self.is_alone() {
            return own.to_vec();
        }
        let counts: Vec<usize> = self.bounds.windows(2).map(|pair| each * (pair[1] - pair[0])).collect();
        self.gather_entries(own, &counts)
    }

    /// Entries of all processes, `counts` per process.
    pub fn gather_entries<V: Entry>(&self, own: &[V], counts: &[usize]) -> Vec<V> {
        let numbers: Vec<f64> = own.iter().flat_map(|entry| (0..V::WIDTH).map(|column| entry.get(column))).collect();
        let counts: Vec<usize> = counts.iter().map(|count| V::WIDTH * count).collect();
        let all = self.communication.gather(&numbers, &counts);
        let entry = |numbers: &[f64]| {
            let mut entry = V::ZERO;
            numbers.iter().enumerate().for_each(|(column, &number)| entry.set(column, number));
            entry
        };
        all.chunks_exact(V::WIDTH).map(entry).collect()
    }

    /// Sums over all subdomains, `count` at once, from the terms of the own ones: `count` terms per subdomain.
    pub fn sum(&self, terms: &[f64], count: usize) -> Vec<f64> {
        let (first, rank) = (self.owned().start, self.communication.rank());
        let before: usize = self.branch_counts[..rank].iter().sum();
        let own = &self.branches[before..before + self.branch_counts[rank]];
        let branch = |branch: &Range<usize>| {
            subtotal(&terms[count * (branch.start - first)..count * (branch.end - first)], count)
        };
        let sums: Vec<f64> = own.iter().flat_map(branch).collect();
        if self.is_alone() {
            return if sums.is_empty() { vec![0.0; count] } else { sums };
        }
        let counts: Vec<usize> = self.branch_counts.iter().map(|branches| count * branches).collect();
        let sums = self.communication.gather(&sums, &counts);
        let mut pieces = self.branches.iter().zip(sums.chunks_exact(count)).peekable();
        total(0..self.count(), &mut pieces)
    }

    /// The sum of one term of every process, in the order of processes.
    pub fn sum_of_processes(&self, term: f64) -> f64 {
        self.communication.gather(&[term], &vec![1; self.communication.size()]).into_iter().sum()
    }

    /// The largest of one value of every process.
    pub fn largest(&self, value: f64) -> f64 {
        self.communication.gather(&[value], &vec![1; self.communication.size()]).into_iter().fold(value, f64::max)
    }
}

fn middle(branch: &Range<usize>) -> usize {
    branch.start + branch.len() / 2
}

/// Appends the largest branches below `branch` that lie within `range`.
fn cover(branch: Range<usize>, range: &Range<usize>, branches: &mut Vec<Range<usize>>) {
    if branch.end <= range.start || range.end <= branch.start || range.is_empty() {
        return;
    }
    if range.start <= branch.start && branch.end <= range.end {
        branches.push(branch);
        return;
    }
    let middle = middle(&branch);
    cover(branch.start..middle, range, branches);
    cover(middle..branch.end, range, branches);
}

/// The sums of a branch from the terms of its subdomains.
fn subtotal(terms: &[f64], count: usize) -> Vec<f64> {
    if terms.len() <= count {
        return terms.to_vec();
    }
    let (left, right) = terms.split_at(count * (terms.len() / count / 2));
    added(subtotal(left, count), &subtotal(right, count))
}

/// The sums of a branch from those of the branches that the processes have summed: the next of `pieces`, in order.
fn total<'a, P: Iterator<Item = (&'a Range<usize>, &'a [f64])>>(
    branch: Range<usize>,
    pieces: &mut Peekable<P>,
) -> Vec<f64> {
    match pieces.next_if(|(piece, _)| **piece == branch) {
        Some((_, sums)) => sums.to_vec(),
        None => {
            assert!(branch.len() > 1, "invariant: the branches of the processes cover the tree");
            let middle = middle(&branch);
            let left = total(branch.start..middle, pieces);
            added(left, &total(middle..branch.end, pieces))
        }
    }
}

/// The sum a + b.
fn added(mut a: Vec<f64>, b: &[f64]) -> Vec<f64> {
    a.iter_mut().zip(b).for_each(|(a, b)| *a += b);
    a
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sums_of_branches_are_the_sum_of_the_whole_tree() {
        let count = 21;
        let terms: Vec<f64> =
            (0..2 * count as usize).map(|index| (1.7 * index as f64).sin() * 10_f64.powi((index % 7) as i32)).collect();
        let whole = subtotal(&terms, 2);
        for bounds in [vec![0, 21], vec![0, 5, 21], vec![0, 0, 7, 7, 8, 20, 21], (0..=21).collect()] {
            let mut branches = Vec::new();
            bounds.windows(2).for_each(|pair| cover(0..21, &(pair[0]..pair[1]), &mut branches));
            let sums: Vec<Vec<f64>> =
                branches.iter().map(|branch| subtotal(&terms[2 * branch.start..2 * branch.end], 2)).collect();
            let mut pieces = branches.iter().zip(sums.iter().map(Vec::as_slice)).peekable();
            assert_eq!(total(0..21, &mut pieces), whole, "{bounds:?}");
        }
    }
}
