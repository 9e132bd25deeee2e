//! Symmetric matrices of cells as lower triangles by rows.

/// Entries of the lower triangle of a symmetric matrix by rows, of which `row` are before row `row`.
pub const fn lower_start(row: usize) -> usize {
    row * (row + 1) / 2
}
