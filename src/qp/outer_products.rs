//! Sums Σ D_i g_i g_iᵀ of rows, some of which have few entries.

use super::dense::add_product;
use crate::{Matrix, Vector};

/// The product of a row with itself is added entry by entry where the square of its number of entries is at most this
/// share of the number of variables: products of whole matrices are as much faster per entry.
const FEW_ENTRIES: usize = 4;

/// Rows g_i, as far as their sums need them.
pub(super) struct OuterProducts {
    /// The rows with few entries: position, columns and entries.
    sparse: Vec<(usize, Vec<(usize, f64)>)>,
    /// The positions of all others.
    full: Vec<usize>,
    /// The others, as columns.
    columns: Matrix,
}

impl OuterProducts {
    /// Of the rows that are the columns of a matrix.
    pub(super) fn of(rows: &Matrix) -> Self {
        let entries = |row: usize| {
            let all = rows.column(row);
            (row, all.iter().copied().enumerate().filter(|(_, entry)| *entry != 0.0).collect())
        };
        let has_few = |(_, entries): &(usize, Vec<_>)| FEW_ENTRIES * entries.len() * entries.len() <= rows.nrows();
        let (sparse, others): (Vec<_>, Vec<_>) = (0..rows.ncols()).map(entries).partition(has_few);
        let full: Vec<usize> = others.into_iter().map(|(row, _)| row).collect();
        Self { sparse, columns: rows.select_columns(&full), full }
    }

    /// Adds the sum to the lower triangle of a matrix; none where nobody waits for it any more.
    pub(super) fn add_to(&self, lower: &mut Matrix, densities: &Vector) -> Option<()> {
        for (row, entries) in &self.sparse {
            for (first, &(k, entry)) in entries.iter().enumerate() {
                let scaled = densities[*row] * entry;
                entries[first..].iter().for_each(|&(i, other)| lower[(i, k)] += scaled * other);
            }
        }
        let mut scaled = self.columns.clone();
        scaled.column_iter_mut().zip(&self.full).for_each(|(mut column, &row)| column *= densities[row]);
        add_product(lower, &self.columns, &scaled.transpose())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::verify::seeded_direction;

    #[test]
    fn rows_with_few_and_with_many_entries_give_the_same_sum() {
        let n = 30;
        let full: Vec<Vector> = (0..50).map(|seed| seeded_direction(n, seed)).collect();
        let few = |row: usize| {
            Vector::from_fn(n, |k, _| if k == row % n || k == (7 * row + 3) % n { full[row][k] } else { 0.0 })
        };
        let mixed: Vec<Vector> = (0..50).map(|row| if row % 3 == 0 { full[row].clone() } else { few(row) }).collect();
        let rows = Matrix::from_columns(&mixed);
        let densities = seeded_direction(50, 99).abs();
        let mut found = Matrix::identity(n, n);
        OuterProducts::of(&rows).add_to(&mut found, &densities).expect("nobody interrupts");
        let wanted = Matrix::identity(n, n) + &rows * Matrix::from_diagonal(&densities) * rows.transpose();
        let lower = |i: usize, k: usize| if i >= k { found[(i, k)] - wanted[(i, k)] } else { 0.0 };
        assert!(Matrix::from_fn(n, n, lower).amax() <= 1e-14);
    }
}
