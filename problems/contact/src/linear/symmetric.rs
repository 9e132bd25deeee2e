//! Lower triangles of symmetric sparse matrices that share one pattern.

use crate::linear::entry::Entry;
use std::sync::Arc;

/// Pattern of a lower triangle by columns; rows ascend within a column and start with the diagonal.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub struct LowerPattern {
    starts: Vec<usize>,
    rows: Vec<usize>,
}

impl LowerPattern {
    /// From the set of rows > column of every column (any order, duplicates allowed); the diagonal is added.
    pub fn from_columns(mut columns: Vec<Vec<usize>>) -> Self {
        let (mut starts, mut rows) = (vec![0], Vec::new());
        for (column, entries) in columns.iter_mut().enumerate() {
            entries.push(column);
            entries.retain(|&row| row >= column);
            entries.sort_unstable();
            entries.dedup();
            rows.extend_from_slice(entries);
            starts.push(rows.len());
        }
        Self { starts, rows }
    }

    /// Number of rows and columns.
    pub fn dimension(&self) -> usize {
        self.starts.len() - 1
    }

    /// Number of stored entries.
    pub fn entry_count(&self) -> usize {
        self.rows.len()
    }

    /// Column starts, `dimension() + 1` entries.
    pub fn starts(&self) -> &[usize] {
        &self.starts
    }

    /// Row of every entry.
    pub fn rows(&self) -> &[usize] {
        &self.rows
    }

    /// Position of the entry (row, column) with row ≥ column.
    pub fn position(&self, row: usize, column: usize) -> Option<usize> {
        let range = self.starts[column]..self.starts[column + 1];
        self.rows[range.clone()].binary_search(&row).ok().map(|offset| range.start + offset)
    }

    /// y = A x for the symmetric matrix with these lower values.
    pub fn multiply<V: Entry>(&self, values: &[f64], x: &[V], y: &mut [V]) {
        y.fill(V::ZERO);
        for (column, entry) in x.iter().enumerate() {
            let range = self.starts[column]..self.starts[column + 1];
            let mut sum = V::ZERO;
            sum.add_scaled(values[range.start], entry);
            for position in range.start + 1..range.end {
                let row = self.rows[position];
                y[row].add_scaled(values[position], entry);
                sum.add_scaled(values[position], &x[row]);
            }
            y[column].add_scaled(1.0, &sum);
        }
    }
}

/// A principal submatrix: its pattern and where each of its values sits in the full matrix.
#[derive(Debug, Clone)]
pub struct Submatrix {
    /// Indices that were kept, in ascending order.
    pub kept: Vec<usize>,
    /// Pattern over the kept indices.
    pub pattern: Arc<LowerPattern>,
    /// Position in the full value array of every value of the submatrix.
    pub positions: Vec<usize>,
}

impl Submatrix {
    /// The rows and columns of `full` whose index is marked.
    pub fn new(full: &LowerPattern, marked: &[bool]) -> Self {
        let kept: Vec<usize> = (0..full.dimension()).filter(|&index| marked[index]).collect();
        let (mut starts, mut rows, mut positions) = (vec![0], Vec::new(), Vec::new());
        for &column in &kept {
            for position in full.starts[column]..full.starts[column + 1] {
                if let Ok(row) = kept.binary_search(&full.rows[position]) {
                    rows.push(row);
                    positions.push(position);
                }
            }
            starts.push(rows.len());
        }
        Self { kept, pattern: Arc::new(LowerPattern { starts, rows }), positions }
    }

    /// Values of the submatrix.
    pub fn gather(&self, full_values: &[f64]) -> Vec<f64> {
        self.positions.iter().map(|&position| full_values[position]).collect()
    }
}

/// A block A_RC of a symmetric matrix by rows: where each of its values sits in the lower triangle.
#[derive(Debug)]
pub struct SymmetricBlock {
    starts: Vec<usize>,
    /// (position in C, position in the value array).
    entries: Vec<(u32, u32)>,
}

impl SymmetricBlock {
    /// The block of the given rows R and columns C.
    pub fn new(full: &LowerPattern, rows: &[usize], columns: &[usize]) -> Self {
        let place = |kept: &[usize]| {
            let mut places = vec![None; full.dimension()];
            kept.iter().enumerate().for_each(|(place, &index)| places[index] = Some(place));
            places
        };
        let (row_places, column_places) = (place(rows), place(columns));
        let narrow = |index: usize| u32::try_from(index).expect("invariant: a subdomain has fewer than 2³² entries");
        let mut lists = vec![Vec::new(); rows.len()];
        for column in 0..full.dimension() {
            for position in full.starts[column]..full.starts[column + 1] {
                let row = full.rows[position];
                let mut add = |row: usize, column: usize| {
                    if let (Some(row), Some(column)) = (row_places[row], column_places[column]) {
                        lists[row].push((narrow(column), narrow(position)));
                    }
                };
                add(row, column);
                if row != column {
                    add(column, row);
                }
            }
        }
        let mut starts = vec![0];
        starts.extend(lists.iter().scan(0, |end, list: &Vec<_>| {
            *end += list.len();
            Some(*end)
        }));
        Self { starts, entries: lists.concat() }
    }

    /// y += factor·A_RC x for the values of the lower triangle; to be called inside `entry::vectorized`.
    #[inline(always)]
    pub(crate) fn add_product<V: Entry>(&self, values: &[f64], factor: f64, x: &[V], y: &mut [V]) {
        for (y, range) in y.iter_mut().zip(self.starts.windows(2)) {
            let mut sum = V::ZERO;
            for &(column, position) in &self.entries[range[0]..range[1]] {
                sum.accumulate(values[position as usize], &x[column as usize]);
            }
            y.add_scaled(factor, &sum);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn blocks_add_up_to_the_matrix() {
        let pattern = LowerPattern::from_columns(vec![vec![1, 3], vec![2, 3], vec![], vec![]]);
        let values = [4.0, 1.0, -2.0, 5.0, 0.5, 3.0, 6.0, 7.0];
        let x = [1.0, 2.0, 3.0, 4.0];
        let mut expected = [0.0; 4];
        pattern.multiply(&values, &x, &mut expected);
        let (first, second) = ([0, 2], [1, 3]);
        for rows in [first, second] {
            let mut product = [0.0; 2];
            for columns in [first, second] {
                let block = SymmetricBlock::new(&pattern, &rows, &columns);
                block.add_product(&values, 1.0, &columns.map(|column| x[column]), &mut product);
            }
            assert_eq!(product, rows.map(|row| expected[row]));
        }
    }
}
