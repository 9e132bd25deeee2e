//! Triangular solves supernode by supernode: both sweeps of L Lᵀ X = B for a block of columns, and single sweeps that
//! may end before the last columns of L.
//!
//! ```text
//! forward, supernodes ascending:     X_s ← L_ss⁻¹ X_s,                X_p ← X_p − L_ps X_s        (p: rows below the supernode)
//! backward, supernodes descending:   X_s ← X_s − L_psᵀ X_p,           X_s ← L_ss⁻ᵀ X_s
//! ```
//! A tile of rows (forward) or columns (backward) of a panel is worked on at once, with its sums in registers; every
//! value of L is read once per sweep for all columns.

use crate::linear::entry::{Entry, Row, vectorized};
use crate::linear::real::Real;
use faer::sparse::linalg::cholesky::supernodal::SymbolicSupernodalCholesky;

/// Registers of eight single precision numbers that the sums of a tile may take, of sixteen.
const TILE_REGISTERS: usize = 10;

/// Solves L Lᵀ X = B in place for rows in elimination order; `values`: those of the factor.
pub fn solve<E: Real, const N: usize>(symbolic: &SymbolicSupernodalCholesky<usize>, values: &[E], x: &mut [Row<E, N>]) {
    match TILE_REGISTERS * size_of::<f32>() / (N * size_of::<E>()) {
        0 | 1 => sweeps::<E, N, 1>(symbolic, values, x),
        2 | 3 => sweeps::<E, N, 2>(symbolic, values, x),
        _ => sweeps::<E, N, 4>(symbolic, values, x),
    }
}

/// Partial sums of the product of a column with a vector: one register of eight.
const PARTIAL_SUMS: usize = 8;
/// Columns whose products with a vector are formed at once.
const COLUMNS_AT_ONCE: usize = 4;

/// Forward sweep over the first `count` columns of L, for an x in elimination order.
pub fn eliminate<V: Entry>(symbolic: &SymbolicSupernodalCholesky<usize>, values: &[f64], count: usize, x: &mut [V]) {
    let mut below = Vec::new();
    vectorized(
        #[inline(always)]
        || {
            for index in 0..symbolic.n_supernodes() {
                let panel = Panel::new(symbolic, values, index);
                if panel.begin < count {
                    panel.eliminate(count, x, &mut below);
                }
            }
        },
    );
}

/// Backward sweep over the first `count` columns of L, for an x in elimination order whose other entries are solved.
pub fn substitute<V: Entry>(symbolic: &SymbolicSupernodalCholesky<usize>, values: &[f64], count: usize, x: &mut [V]) {
    let mut below = Vec::new();
    vectorized(
        #[inline(always)]
        || {
            for index in (0..symbolic.n_supernodes()).rev() {
                let panel = Panel::new(symbolic, values, index);
                if panel.begin < count {
                    panel.substitute(count, x, &mut below);
                }
            }
        },
    );
}

/// Both sweeps with tiles of so many rows.
fn sweeps<E: Real, const N: usize, const TILE: usize>(
    symbolic: &SymbolicSupernodalCholesky<usize>,
    values: &[E],
    x: &mut [Row<E, N>],
) {
    vectorized(
        #[inline(always)]
        || {
            for index in 0..symbolic.n_supernodes() {
                let panel = Panel::new(symbolic, values, index);
                panel.forward::<N, TILE>(x);
            }
            let mut below = Vec::new();
            for index in (0..symbolic.n_supernodes()).rev() {
                let panel = Panel::new(symbolic, values, index);
                panel.backward::<N, TILE>(x, &mut below);
            }
        },
    );
}

/// The columns of one supernode, by columns; the block on the diagonal first.
struct Panel<'a, E> {
    begin: usize,
    width: usize,
    height: usize,
    values: &'a [E],
    /// Rows below the block on the diagonal.
    pattern: &'a [usize],
}

impl<'a, E: Real> Panel<'a, E> {
    #[inline(always)]
    fn new(symbolic: &'a SymbolicSupernodalCholesky<usize>, values: &'a [E], index: usize) -> Self {
        let (begin, end) = (symbolic.supernode_begin()[index], symbolic.supernode_end()[index]);
        let pattern = symbolic.supernode(index).pattern();
        let (width, height) = (end - begin, end - begin + pattern.len());
        let first = symbolic.col_ptr_for_val()[index];
        Self { begin, width, height, values: &values[first..first + width * height], pattern }
    }

    #[inline(always)]
    fn forward<const N: usize, const TILE: usize>(&self, x: &mut [Row<E, N>]) {
        let (solved, below) = x.split_at_mut(self.begin + self.width);
        let own = &mut solved[self.begin..];
        let mut row = 0;
        while row + TILE <= self.width {
            let (above, rest) = own.split_at_mut(row);
            let sums = self.row_products::<N, TILE>(row, above);
            for (t, sum) in sums.iter().enumerate() {
                rest[t].add_fused(-E::one(), sum);
            }
            self.lower_triangle(row, &mut rest[..TILE]);
            row += TILE;
        }
        for row in row..self.width {
            let (above, rest) = own.split_at_mut(row);
            let [sum] = self.row_products::<N, 1>(row, above);
            rest[0].add_fused(-E::one(), &sum);
            self.lower_triangle(row, &mut rest[..1]);
        }
        let own = &*own;
        let end = self.begin + self.width;
        let mut tiles = self.pattern.chunks_exact(TILE);
        let mut row = self.width;
        for tile in &mut tiles {
            let sums = self.row_products::<N, TILE>(row, own);
            for (&target, sum) in tile.iter().zip(&sums) {
                below[target - end].add_fused(-E::one(), sum);
            }
            row += TILE;
        }
        for &target in tiles.remainder() {
            let [sum] = self.row_products::<N, 1>(row, own);
            below[target - end].add_fused(-E::one(), &sum);
            row += 1;
        }
    }

    /// Σ_k L[row + t, k] x_k over the first columns of the panel, for the rows of a tile.
    #[inline(always)]
    fn row_products<const N: usize, const TILE: usize>(&self, row: usize, x: &[Row<E, N>]) -> [Row<E, N>; TILE] {
        let mut sums = [Row::ZERO; TILE];
        for (x, column) in x.iter().zip(self.values.chunks_exact(self.height)) {
            let entries = &column[row..row + TILE];
            for t in 0..TILE {
                sums[t].add_fused(entries[t], x);
            }
        }
        sums
    }

    /// Solves with the block on the diagonal that begins at `first`, for as many rows as x has.
    #[inline(always)]
    fn lower_triangle<const N: usize>(&self, first: usize, x: &mut [Row<E, N>]) {
        for row in 0..x.len() {
            let (above, rest) = x.split_at_mut(row);
            for (column, solved) in above.iter().enumerate() {
                rest[0].add_fused(-self.values[(first + column) * self.height + first + row], solved);
            }
            let pivot = E::one() / self.values[(first + row) * self.height + first + row];
            rest[0] = rest[0].map(|entry| entry * pivot);
        }
    }

    #[inline(always)]
    fn backward<const N: usize, const TILE: usize>(&self, x: &mut [Row<E, N>], below: &mut Vec<Row<E, N>>) {
        below.clear();
        below.extend(self.pattern.iter().map(|&row| x[row]));
        let own = &mut x[self.begin..self.begin + self.width];
        let mut column = self.width;
        while column >= TILE {
            column -= TILE;
            self.backward_tile::<N, TILE>(column, own, below);
        }
        while column > 0 {
            column -= 1;
            self.backward_tile::<N, 1>(column, own, below);
        }
    }

    /// The rows `first` to `first + TILE` of the supernode, when those after them are solved.
    #[inline(always)]
    fn backward_tile<const N: usize, const TILE: usize>(
        &self,
        first: usize,
        own: &mut [Row<E, N>],
        below: &[Row<E, N>],
    ) {
        let (tile, solved) = own[first..].split_at_mut(TILE);
        let columns: [&[E]; TILE] = std::array::from_fn(|t| {
            &self.values[(first + t) * self.height + first + TILE..(first + t + 1) * self.height]
        });
        let (near, far) = (column_products(columns, solved), {
            let columns = columns.map(|column| &column[solved.len()..]);
            column_products(columns, below)
        });
        for row in (0..TILE).rev() {
            let (before, rest) = tile.split_at_mut(row + 1);
            before[row].add_fused(-E::one(), &near[row]);
            before[row].add_fused(-E::one(), &far[row]);
            let column = (first + row) * self.height + first;
            for (offset, x) in rest.iter().enumerate() {
                before[row].add_fused(-self.values[column + row + 1 + offset], x);
            }
            let pivot = E::one() / self.values[column + row];
            before[row] = before[row].map(|entry| entry * pivot);
        }
    }
}

impl Panel<'_, f64> {
    /// The columns of the panel that are among the first `count` columns of L.
    #[inline(always)]
    fn columns(&self, count: usize) -> impl DoubleEndedIterator<Item = (usize, &[f64])> {
        let columns = count.saturating_sub(self.begin).min(self.width);
        self.values.chunks_exact(self.height).take(columns).enumerate()
    }

    #[inline(always)]
    fn eliminate<V: Entry>(&self, count: usize, x: &mut [V], below: &mut Vec<V>) {
        below.clear();
        below.resize(self.pattern.len(), V::ZERO);
        let own = &mut x[self.begin..self.begin + self.width];
        for (index, column) in self.columns(count) {
            let (solved, rest) = own[index..].split_at_mut(1);
            solved[0].scale(1.0 / column[index]);
            let (near, far) = column[index + 1..].split_at(rest.len());
            rest.iter_mut().zip(near).for_each(|(x, entry)| x.accumulate(-entry, &solved[0]));
            below.iter_mut().zip(far).for_each(|(sum, entry)| sum.accumulate(*entry, &solved[0]));
        }
        for (&row, sum) in self.pattern.iter().zip(below) {
            x[row].add_scaled(-1.0, sum);
        }
    }

    #[inline(always)]
    fn substitute<V: Entry>(&self, count: usize, x: &mut [V], below: &mut Vec<V>) {
        below.clear();
        below.extend(self.pattern.iter().map(|&row| x[row]));
        let own = &mut x[self.begin..self.begin + self.width];
        // What lies below first: the columns of a tile read it once.
        let mut columns: Vec<(usize, &[f64])> = self.columns(count).collect();
        let tiles = columns.chunks_exact(COLUMNS_AT_ONCE);
        for &(index, column) in tiles.remainder() {
            own[index].add_scaled(-1.0, &products([&column[self.width..]], below)[0]);
        }
        for tile in tiles {
            let parts: [&[f64]; COLUMNS_AT_ONCE] = std::array::from_fn(|t| &tile[t].1[self.width..]);
            for (t, sum) in products(parts, below).iter().enumerate() {
                own[tile[t].0].add_scaled(-1.0, sum);
            }
        }
        while let Some((index, column)) = columns.pop() {
            let (before, solved) = own.split_at_mut(index + 1);
            before[index].add_scaled(-1.0, &products([&column[index + 1..self.width]], solved)[0]);
            before[index].scale(1.0 / column[index]);
        }
    }
}

/// Σ_i columns[t][i] x_i for several columns, by partial sums that do not wait for each other.
#[inline(always)]
fn products<V: Entry, const COUNT: usize>(columns: [&[f64]; COUNT], x: &[V]) -> [V; COUNT] {
    let mut sums = [[V::ZERO; PARTIAL_SUMS]; COUNT];
    let columns = columns.map(|column| &column[..x.len()]);
    let whole = x.len() - x.len() % PARTIAL_SUMS;
    for first in (0..whole).step_by(PARTIAL_SUMS) {
        for (sums, column) in sums.iter_mut().zip(columns) {
            let entries = column[first..first + PARTIAL_SUMS].iter().zip(&x[first..first + PARTIAL_SUMS]);
            sums.iter_mut().zip(entries).for_each(|(sum, (entry, x))| sum.accumulate(*entry, x));
        }
    }
    let mut all = [V::ZERO; COUNT];
    for ((all, sums), column) in all.iter_mut().zip(&sums).zip(columns) {
        sums.iter().for_each(|sum| all.add_scaled(1.0, sum));
        column[whole..].iter().zip(&x[whole..]).for_each(|(entry, x)| all.accumulate(*entry, x));
    }
    all
}

/// Σ_i columns[t][i] x_i, for the columns of a tile.
#[inline(always)]
fn column_products<E: Real, const N: usize, const TILE: usize>(
    columns: [&[E]; TILE],
    x: &[Row<E, N>],
) -> [Row<E, N>; TILE] {
    let columns = columns.map(|column| &column[..x.len()]);
    let mut sums = [Row::ZERO; TILE];
    for (i, x) in x.iter().enumerate() {
        let entries: [E; TILE] = std::array::from_fn(|t| columns[t][i]);
        for t in 0..TILE {
            sums[t].add_fused(entries[t], x);
        }
    }
    sums
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::linear::cholesky::{NumericFactor, SymbolicFactor};
    use crate::linear::symmetric::LowerPattern;
    use std::sync::Arc;

    const SIZE: usize = 60;

    /// A banded matrix, with its factor for an elimination order that fills it.
    fn factored() -> NumericFactor {
        let columns = (0..SIZE).map(|i| (i + 1..SIZE.min(i + 6)).collect()).collect();
        let pattern = Arc::new(LowerPattern::from_columns(columns));
        let values: Vec<f64> = (0..SIZE)
            .flat_map(|column| {
                pattern.rows()[pattern.starts()[column]..pattern.starts()[column + 1]]
                    .iter()
                    .map(move |&row| (row, column))
            })
            .map(|(row, column)| if row == column { 20.0 } else { (3 * row + column) as f64 % 4.0 - 2.0 })
            .collect();
        let order = (0..SIZE).map(|new| 7 * new % SIZE).collect();
        Arc::new(SymbolicFactor::new(pattern, order).expect("symbolic")).factorize(&values).expect("positive definite")
    }

    /// Every column of a block comes out as it does alone.
    fn blocks_are_solved<E: Real, const N: usize>(rounding: f64) {
        let factor = factored();
        let right = |row: usize, column: usize| ((row * row + 3 * column) as f64).sin();
        let mut block = vec![Row::<E, N>::ZERO; SIZE];
        for (row, entry) in block.iter_mut().enumerate() {
            (0..Row::<E, N>::WIDTH).for_each(|column| entry.set(column, right(row, column)));
        }
        factor.solve_rows_in_place(&mut block);
        for column in 0..Row::<E, N>::WIDTH {
            let mut expected: Vec<f64> = (0..SIZE).map(|row| right(row, column)).collect();
            factor.solve_in_place(&mut expected);
            for (row, expected) in block.iter().zip(&expected) {
                assert!((row.get(column) - expected).abs() < rounding, "{} {expected}", row.get(column));
            }
        }
    }

    #[test]
    fn single_sweeps_solve_together_and_leave_the_schur_complement_between_them() {
        let factor = factored();
        let order = factor.order().to_vec();
        let mut expected: Vec<f64> = (0..SIZE).map(|row| (row as f64).cos()).collect();
        let right: Vec<f64> = order.iter().map(|&old| expected[old]).collect();
        factor.solve_in_place(&mut expected);
        let condensed = factor.trailing_block(SIZE - 25);
        for count in [0, 1, 25, SIZE] {
            let mut x = right.clone();
            factor.eliminate(count, &mut x);
            if count == 25 {
                // S x₂ is what elimination leaves of the right side.
                let below: Vec<f64> = order[25..].iter().map(|&old| expected[old]).collect();
                for (row, left) in x[25..].iter().enumerate() {
                    let product = |k: usize| -> f64 { (0..below.len()).map(|l| condensed[(l, k)] * below[l]).sum() };
                    let image: f64 = (0..=row).map(|k| condensed[(row, k)] * product(k)).sum();
                    assert!((left - image).abs() < 1e-13, "{left} {image}");
                }
            }
            for (new, &old) in order.iter().enumerate().skip(count) {
                x[new] = expected[old];
            }
            factor.substitute(count, &mut x);
            for (x, &old) in x.iter().zip(&order) {
                assert!((x - expected[old]).abs() < 1e-14, "{count}: {x} {}", expected[old]);
            }
        }
    }

    #[test]
    fn blocks_of_all_widths_are_solved_in_both_precisions() {
        blocks_are_solved::<f64, 1>(1e-14);
        blocks_are_solved::<f64, 3>(1e-14);
        blocks_are_solved::<f64, 5>(1e-14);
        blocks_are_solved::<f32, 1>(1e-6);
        blocks_are_solved::<f32, 3>(1e-6);
        blocks_are_solved::<f32, 5>(1e-6);
    }
}
