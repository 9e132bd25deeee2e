//! Tᵀ K T of a symmetric matrix over nodes, for T = I + E with few blocks in E.
//!
//! ```text
//! Tᵀ K T = K + A + Aᵀ + Eᵀ A,     A = K E
//! ```

use crate::linear::symmetric::LowerPattern;
use std::collections::{BTreeMap, HashMap};

/// A block of three by three entries.
pub(super) type Block = [[f64; 3]; 3];

/// The blocks of a column of E by their rows, with the node of the column.
pub(super) type BlockColumn = (usize, Vec<(usize, Block)>);

/// Replaces the lower values of K, whose nodes have the neighbours `graph`, by those of Tᵀ K T; `lower` holds both.
pub(super) fn transform(values: &mut [f64], lower: &LowerPattern, graph: &[Vec<u32>], columns: &[BlockColumn]) {
    let product = |(_, blocks): &BlockColumn| {
        let mut sums: BTreeMap<usize, Block> = BTreeMap::new();
        for (node, block) in blocks {
            let neighbours = graph[*node].iter().map(|&other| other as usize);
            for row in neighbours.chain([*node]) {
                let Some(own) = block_at(values, lower, row, *node) else { continue };
                add_product(sums.entry(row).or_default(), &own, block);
            }
        }
        sums
    };
    let products: Vec<BTreeMap<usize, Block>> = columns.iter().map(product).collect();
    let mut by_row: HashMap<usize, Vec<(usize, &Block)>> = HashMap::new();
    for (column, blocks) in columns {
        blocks.iter().for_each(|(row, block)| by_row.entry(*row).or_default().push((*column, block)));
    }
    for ((column, _), sums) in columns.iter().zip(&products) {
        let mut twice: BTreeMap<usize, Block> = BTreeMap::new();
        for (&row, sum) in sums {
            if row == *column {
                add(values, lower, row, *column, &transposed(sum));
            }
            add(values, lower, row, *column, sum);
            for (other, block) in by_row.get(&row).into_iter().flatten().filter(|(other, _)| other >= column) {
                add_product(twice.entry(*other).or_default(), &transposed(block), sum);
            }
        }
        twice.iter().for_each(|(&row, sum)| add(values, lower, row, *column, sum));
    }
}

/// The position of the first entry of a block below the diagonal one, and those of its other columns.
fn positions(lower: &LowerPattern, row: usize, column: usize) -> Option<[usize; 3]> {
    let starts = lower.starts();
    if row == column {
        return Some(std::array::from_fn(|axis| starts[3 * column + axis]));
    }
    let offset = lower.position(3 * row, 3 * column)? - starts[3 * column] - 3;
    Some(std::array::from_fn(|axis| starts[3 * column + axis] + 3 - axis + offset))
}

/// The block of a row and a column, above or below the diagonal.
fn block_at(values: &[f64], lower: &LowerPattern, row: usize, column: usize) -> Option<Block> {
    if row < column {
        return block_at(values, lower, column, row).map(|block| transposed(&block));
    }
    let first = positions(lower, row, column)?;
    let of = |i: usize, j: usize| match row == column {
        true => values[first[i.min(j)] + i.max(j) - i.min(j)],
        false => values[first[j] + i],
    };
    Some(std::array::from_fn(|i| std::array::from_fn(|j| of(i, j))))
}

/// Adds a block to that of a row and a column, and its transpose to the mirrored one, of which the lower is kept; of
/// the diagonal block the lower part.
fn add(values: &mut [f64], lower: &LowerPattern, row: usize, column: usize, block: &Block) {
    if row < column {
        return add(values, lower, column, row, &transposed(block));
    }
    let first = positions(lower, row, column).expect("invariant: the pattern holds all blocks of the product");
    for (j, first) in first.into_iter().enumerate() {
        let skipped = if row == column { j } else { 0 };
        (skipped..3).for_each(|i| values[first + i - skipped] += block[i][j]);
    }
}

fn transposed(block: &Block) -> Block {
    std::array::from_fn(|i| std::array::from_fn(|j| block[j][i]))
}

fn add_product(sum: &mut Block, a: &Block, b: &Block) {
    for (i, row) in sum.iter_mut().enumerate() {
        for (j, entry) in row.iter_mut().enumerate() {
            *entry += (0..3).map(|k| a[i][k] * b[k][j]).sum::<f64>();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A chain of four nodes, a column with two blocks and one with a block on its own node.
    #[test]
    fn the_product_is_that_of_full_matrices() {
        let graph: Vec<Vec<u32>> = vec![vec![1], vec![0, 2], vec![1, 3], vec![2]];
        let all: Vec<Vec<u32>> = (0..4).map(|node| (0..4).filter(|other| *other != node).collect()).collect();
        let lower = crate::body::lower_pattern(&all);
        let entry = |i: usize, j: usize| ((i.max(j) * 7 + i.min(j) * 3) % 11) as f64 - 4.0 + 20.0 * f64::from(i == j);
        let coupled = |i: usize, j: usize| (i / 3).abs_diff(j / 3) <= 1;
        let mut values = vec![0.0; lower.entry_count()];
        for j in 0..12 {
            for i in (j..12).filter(|&i| coupled(i, j)) {
                values[lower.position(i, j).expect("an entry")] = entry(i, j);
            }
        }
        let block = |seed: usize| -> Block {
            std::array::from_fn(|i| std::array::from_fn(|j| ((seed + 2 * i + 5 * j) % 7) as f64 / 3.0 - 1.0))
        };
        let columns = vec![(0, vec![(1, block(1)), (3, block(2))]), (2, vec![(1, block(3)), (2, block(4))])];
        let mut t = nalgebra::DMatrix::<f64>::identity(12, 12);
        for (column, blocks) in &columns {
            for (row, block) in blocks {
                (0..3).for_each(|i| (0..3).for_each(|j| t[(3 * row + i, 3 * column + j)] += block[i][j]));
            }
        }
        let k = nalgebra::DMatrix::from_fn(12, 12, |i, j| if coupled(i, j) { entry(i, j) } else { 0.0 });
        let expected = t.transpose() * k * &t;
        transform(&mut values, &lower, &graph, &columns);
        for j in 0..12 {
            for i in j..12 {
                let found = values[lower.position(i, j).expect("an entry")];
                assert!((found - expected[(i, j)]).abs() < 1e-12, "{i} {j}: {found} {}", expected[(i, j)]);
            }
        }
    }
}
