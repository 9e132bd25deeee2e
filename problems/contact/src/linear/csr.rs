//! Sparse rows: y_r = Σ_c A_rc x_c, for a vector or a block of columns.

use crate::linear::entry::{Entry, vectorized};
use crate::linear::parallel::for_parts;

/// A sparse matrix by rows.
#[derive(Debug, Clone, Default)]
pub struct Csr {
    starts: Vec<usize>,
    columns: Vec<u32>,
    values: Vec<f64>,
    column_count: usize,
}

/// Below this many numbers of the result one thread is faster than two.
const PARALLEL_NUMBERS: usize = 4096;

impl Csr {
    /// A matrix with `column_count` columns from its rows of (column, value).
    pub(crate) fn from_rows(column_count: usize, rows: impl IntoIterator<Item = Vec<(usize, f64)>>) -> Self {
        let mut matrix = Self { starts: vec![0], column_count, ..Self::default() };
        matrix.extend(rows);
        matrix
    }

    /// Appends rows of (column, value).
    pub fn extend(&mut self, rows: impl IntoIterator<Item = Vec<(usize, f64)>>) {
        for row in rows {
            for (column, value) in row {
                debug_assert!(column < self.column_count);
                self.columns.push(u32::try_from(column).expect("invariant: fewer than 2³² dofs"));
                self.values.push(value);
            }
            self.starts.push(self.columns.len());
        }
    }

    pub fn row_count(&self) -> usize {
        self.starts.len() - 1
    }

    pub fn column_count(&self) -> usize {
        self.column_count
    }

    /// Entries (column, value) of a row.
    pub fn row(&self, row: usize) -> impl Iterator<Item = (usize, f64)> + '_ {
        let range = self.starts[row]..self.starts[row + 1];
        self.columns[range.clone()].iter().zip(&self.values[range]).map(|(&column, &value)| (column as usize, value))
    }

    pub fn transpose(&self) -> Self {
        let mut starts = vec![0; self.column_count + 1];
        for &column in &self.columns {
            starts[column as usize + 1] += 1;
        }
        (0..self.column_count).for_each(|column| starts[column + 1] += starts[column]);
        let (mut columns, mut values) = (vec![0; self.columns.len()], vec![0.0; self.values.len()]);
        let mut next = starts.clone();
        for row in 0..self.row_count() {
            for (column, value) in self.row(row) {
                columns[next[column]] = u32::try_from(row).expect("invariant: fewer than 2³² rows");
                values[next[column]] = value;
                next[column] += 1;
            }
        }
        Self { starts, columns, values, column_count: self.row_count() }
    }

    /// Row `row` of A x.
    #[inline(always)]
    fn product<V: Entry>(&self, row: usize, x: &[V]) -> V {
        let mut sum = V::ZERO;
        for (column, value) in self.row(row) {
            sum.accumulate(value, &x[column]);
        }
        sum
    }

    /// y = A x.
    pub fn multiply<V: Entry>(&self, x: &[V], y: &mut [V]) {
        debug_assert_eq!((x.len(), y.len()), (self.column_count, self.row_count()));
        if y.len() * V::WIDTH < PARALLEL_NUMBERS {
            self.multiply_rows(0, x, y);
        } else {
            let rows = (PARALLEL_NUMBERS / 4).div_ceil(V::WIDTH);
            for_parts(y.chunks_mut(rows), &|index, y| self.multiply_rows(index * rows, x, y));
        }
    }

    /// The rows of A x from `first` on, as many as y has, on this thread.
    pub(crate) fn multiply_rows<V: Entry>(&self, first: usize, x: &[V], y: &mut [V]) {
        vectorized(
            #[inline(always)]
            || {
                for (offset, y) in y.iter_mut().enumerate() {
                    *y = self.product(first + offset, x);
                }
            },
        );
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn transpose_satisfies_the_adjoint_identity() {
        let a = Csr::from_rows(3, vec![vec![(0, 1.0), (2, -2.0)], vec![(1, 3.0)]]);
        let (x, y) = ([1.0, 2.0, 3.0], [4.0, 5.0]);
        let (mut ax, mut aty) = ([0.0; 2], [0.0; 3]);
        a.multiply(&x, &mut ax);
        a.transpose().multiply(&y, &mut aty);
        assert_eq!(ax, [-5.0, 6.0]);
        assert_eq!(ax[0] * y[0] + ax[1] * y[1], x.iter().zip(&aty).map(|(x, a)| x * a).sum::<f64>());
    }
}
