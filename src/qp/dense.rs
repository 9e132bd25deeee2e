//! A symmetric positive definite matrix, summed and factorised by blocks of columns, so that products of matrices do
//! the work.

use crate::interruption::interrupted;
use crate::{Matrix, Vector};

/// Columns of a block: all of them together stay in the cache.
const BLOCK: usize = 64;

/// Adds the product of a matrix with n rows and one with n columns to the lower triangle of a sum that is symmetric;
/// none where nobody waits for it any more.
pub(super) fn add_product(sum: &mut Matrix, left: &Matrix, right: &Matrix) -> Option<()> {
    let n = sum.nrows();
    for first in (0..n).step_by(BLOCK) {
        if interrupted() {
            return None;
        }
        let width = BLOCK.min(n - first);
        let mut block = sum.view_mut((first, first), (n - first, width));
        block.gemm(1.0, &left.rows(first, n - first), &right.columns(first, width), 1.0);
    }
    Some(())
}

/// The factor L of L Lᵀ.
pub(super) struct Cholesky {
    lower: Matrix,
}

impl Cholesky {
    /// Factorises the matrix with this lower triangle. A pivot that is rounding becomes infinite: solutions are zero
    /// there, as suits equations that repeat others.
    pub(super) fn new(mut lower: Matrix) -> Self {
        let n = lower.nrows();
        let least = lower.diagonal() * (n as f64 * f64::EPSILON);
        for first in (0..n).step_by(BLOCK) {
            let width = BLOCK.min(n - first);
            let mut corner = lower.view((first, first), (width, width)).into_owned();
            factorise(&mut corner, &least.as_slice()[first..]);
            lower.view_mut((first, first), (width, width)).copy_from(&corner);
            let next = first + width;
            let mut panel = lower.view((next, first), (n - next, width)).transpose();
            corner.solve_lower_triangular_mut(&mut panel);
            let columns = panel.transpose();
            lower.view_mut((next, first), (n - next, width)).copy_from(&columns);
            for start in (next..n).step_by(BLOCK) {
                let mut rest = lower.view_mut((start, start), (n - start, BLOCK.min(n - start)));
                let of_block = panel.columns(start - next, rest.ncols());
                rest.gemm(-1.0, &columns.rows(start - next, n - start), &of_block, 1.0);
            }
        }
        Self { lower }
    }

    /// Solves L Y = B in place.
    pub(super) fn halfway(&self, rhs: &mut Matrix) {
        let (n, count) = rhs.shape();
        for first in (0..n).step_by(BLOCK) {
            let width = BLOCK.min(n - first);
            let next = first + width;
            let mut block = rhs.rows(first, width).into_owned();
            self.lower.view((first, first), (width, width)).solve_lower_triangular_mut(&mut block);
            rhs.rows_mut(first, width).copy_from(&block);
            let left = self.lower.view((next, first), (n - next, width));
            rhs.view_mut((next, 0), (n - next, count)).gemm(-1.0, &left, &block, 1.0);
        }
    }

    /// The factor of B (L Lᵀ)⁻¹ Bᵀ for the rows of B as columns; none where nobody waits for it any more.
    pub(super) fn schur(&self, mut columns: Matrix) -> Option<Self> {
        self.halfway(&mut columns);
        let mut sum = Matrix::zeros(columns.ncols(), columns.ncols());
        add_product(&mut sum, &columns.transpose(), &columns)?;
        Some(Self::new(sum))
    }

    /// Solves L Lᵀ x = b.
    pub(super) fn solve(&self, mut rhs: Vector) -> Vector {
        self.lower.solve_lower_triangular_mut(&mut rhs);
        self.lower.tr_solve_lower_triangular_mut(&mut rhs);
        rhs
    }
}

/// Factorises a small matrix in place, column by column.
fn factorise(matrix: &mut Matrix, least: &[f64]) {
    let n = matrix.nrows();
    for k in 0..n {
        let pivot = matrix[(k, k)];
        let root = if pivot > least[k] { pivot.sqrt() } else { f64::INFINITY };
        matrix[(k, k)] = root;
        matrix.view_mut((k + 1, k), (n - k - 1, 1)).apply(|entry| *entry /= root);
        for j in k + 1..n {
            let factor = matrix[(j, k)];
            for i in j..n {
                let entry = matrix[(i, k)];
                matrix[(i, j)] -= factor * entry;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::verify::seeded_direction;

    /// A matrix of random columns.
    fn random(height: usize, width: usize) -> Matrix {
        Matrix::from_columns(&(0..width as u64).map(|seed| seeded_direction(height, seed)).collect::<Vec<_>>())
    }

    #[test]
    fn blocks_give_the_same_solution_as_the_whole() {
        for n in [1, 7, BLOCK, BLOCK + 1, 3 * BLOCK - 5] {
            let factor = random(n + 3, n);
            let mut sum = Matrix::identity(n, n);
            add_product(&mut sum, &factor.transpose(), &factor).expect("nobody interrupts");
            let whole = Matrix::identity(n, n) + factor.tr_mul(&factor);
            let wanted = seeded_direction(n, 1);
            let found = Cholesky::new(sum).solve(&whole * &wanted);
            assert!((found - wanted).amax() <= 1e-13, "{n}");
        }
    }

    #[test]
    fn equations_that_repeat_others_are_solved_by_zero() {
        let (n, base) = (2 * BLOCK, random(BLOCK, BLOCK) + Matrix::identity(BLOCK, BLOCK));
        let twice = Matrix::from_fn(n, BLOCK, |i, k| base[(i % BLOCK, k)]);
        let repeated = &twice * twice.transpose();
        let wanted = seeded_direction(n, 1);
        let rhs = &repeated * &wanted;
        let found = Cholesky::new(repeated.clone()).solve(rhs.clone());
        assert!((repeated * found - rhs).amax() <= 1e-9);
    }
}
