//! Lower triangles of dense symmetric matrices, in tiles of columns: what fronts hand to their parents.
//!
//! A tile holds its columns from its first row on, column after column, so that a triangle takes little more than half
//! of a square. Its block on the diagonal is a square, of which the lower triangle is used.

/// Columns of a tile.
pub(super) const TILE: usize = 256;

/// A lower triangle.
#[derive(Debug)]
pub(super) struct Triangle {
    size: usize,
    values: Vec<f64>,
}

impl Triangle {
    /// Zero.
    pub(super) fn zero(size: usize) -> Self {
        Self { size, values: vec![0.0; start(size, size)] }
    }

    /// Number of rows.
    pub(super) fn size(&self) -> usize {
        self.size
    }

    /// A column from the diagonal on.
    pub(super) fn column(&self, column: usize) -> &[f64] {
        let (first, end) = self.range(column);
        &self.values[first..end]
    }

    /// A column from the diagonal on.
    pub(super) fn column_mut(&mut self, column: usize) -> &mut [f64] {
        let (first, end) = self.range(column);
        &mut self.values[first..end]
    }

    fn range(&self, column: usize) -> (usize, usize) {
        let tile = column / TILE * TILE;
        let begin = start(self.size, tile) + (column - tile) * (self.size - tile);
        (begin + column - tile, begin + self.size - tile)
    }

    /// The tiles, in order: by columns, from the row on that their first column has on the diagonal.
    pub(super) fn tiles(&mut self) -> Vec<&mut [f64]> {
        let (mut rest, mut tiles) = (self.values.as_mut_slice(), Vec::new());
        for first in (0..self.size).step_by(TILE) {
            let (tile, others) = rest.split_at_mut((self.size - first) * TILE.min(self.size - first));
            tiles.push(tile);
            rest = others;
        }
        tiles
    }
}

/// Where the tile of a column begins among the values; `column`: a multiple of [`TILE`], or the size.
fn start(size: usize, column: usize) -> usize {
    let whole = column / TILE;
    // Σ_k TILE (size − k TILE) over the tiles before, and what the last tile has beside whole ones.
    let before = TILE * whole * size - TILE * TILE * (whole * whole.saturating_sub(1) / 2);
    before + (column - whole * TILE) * (size - whole * TILE)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_lie_in_their_tiles() {
        for size in [0, 1, 5, TILE - 1, TILE, TILE + 1, 2 * TILE, 2 * TILE + 77] {
            let mut triangle = Triangle::zero(size);
            for column in 0..size {
                triangle.column_mut(column).iter_mut().zip(column..).for_each(|(x, row)| *x = (row + column) as f64);
            }
            assert_eq!(triangle.tiles().iter().map(|tile| tile.len()).sum::<usize>(), triangle.values.len());
            for column in 0..size {
                assert_eq!(triangle.column(column).len(), size - column);
                assert!(triangle.column(column).iter().zip(column..).all(|(x, row)| *x == (row + column) as f64));
            }
            for (index, tile) in triangle.tiles().into_iter().enumerate() {
                let (first, height) = (index * TILE, size - index * TILE);
                let column = (tile.len() / height).min(2) - 1;
                assert_eq!(tile[column * height + column], 2.0 * (first + column) as f64);
            }
        }
    }
}
