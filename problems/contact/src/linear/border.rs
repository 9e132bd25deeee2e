//! Rows B below a matrix that are never eliminated: what fronts see of them.

use crate::linear::fronts::Fronts;

/// The border of one factorisation.
#[derive(Debug)]
pub(super) struct Border {
    count: usize,
    /// Entries (row of B, value) of the columns of L.
    columns: Vec<Vec<(u32, f64)>>,
    /// The rows that reach the front of each supernode, ascending.
    reached: Vec<Vec<u32>>,
}

impl Border {
    /// No rows.
    pub(super) fn none() -> Self {
        Self { count: 0, columns: Vec::new(), reached: Vec::new() }
    }

    /// Rows with entries (index, value); `place`: the columns of L of the indices.
    pub(super) fn new(fronts: &Fronts, rows: &[Vec<(usize, f64)>], place: impl Fn(usize) -> usize) -> Self {
        let supernodes = fronts.first.len();
        let mut columns = vec![Vec::new(); fronts.column_count()];
        for (entries, row) in rows.iter().zip(0..) {
            entries.iter().for_each(|&(index, value)| columns[place(index)].push((row, value)));
        }
        let mut reached: Vec<Vec<u32>> = Vec::with_capacity(supernodes);
        for supernode in 0..supernodes {
            let own = columns[fronts.columns(supernode)].iter().flatten().map(|(row, _)| *row);
            let below = fronts.children[supernode].iter().flat_map(|&child| &reached[child as usize]).copied();
            let mut rows: Vec<u32> = own.chain(below).collect();
            rows.sort_unstable();
            rows.dedup();
            reached.push(rows);
        }
        Self { count: rows.len(), columns, reached }
    }

    /// Number of rows.
    pub(super) fn count(&self) -> usize {
        self.count
    }

    /// The entries of a column of L.
    pub(super) fn column(&self, column: usize) -> &[(u32, f64)] {
        self.columns.get(column).map_or(&[], Vec::as_slice)
    }

    /// The rows that reach the front of a supernode.
    pub(super) fn of(&self, supernode: usize) -> &[u32] {
        self.reached.get(supernode).map_or(&[], Vec::as_slice)
    }
}
