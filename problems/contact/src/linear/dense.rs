//! Dense LU and Cholesky factorisations by faer, on one thread whatever the process is set to.

use crate::linear::FactorizationError;
use crate::linear::vector::{add_scaled, dot, norm};
use faer::diag::Diag;
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::llt;
use faer::linalg::lu::partial_pivoting as lu;
use faer::linalg::matmul::matmul;
use faer::linalg::svd::{ComputeSvdVectors, svd, svd_scratch};
use faer::linalg::triangular_solve::{solve_lower_triangular_in_place, solve_upper_triangular_in_place};
use faer::perm::Perm;
use faer::{Accum, Conj, Mat, MatMut, Par};

/// The number of threads, given with every call: results do not depend on it, and no caller's own setting is changed.
const SEQUENTIAL: Par = Par::Seq;

/// Factors P A = L U of a square matrix, by partial pivoting.
#[derive(Debug)]
pub struct DenseLu {
    /// U on and above the diagonal, L (whose diagonal is 1) below it.
    factors: Mat<f64>,
    permutation: Perm<usize>,
    pivot_ratio: f64,
}

impl DenseLu {
    /// Factors a square matrix; a singular one gives a `pivot_ratio` near 0.
    pub fn new(matrix: &Mat<f64>) -> Self {
        let size = matrix.nrows();
        let mut factors = matrix.clone();
        let (mut forward, mut inverse) = (vec![0; size], vec![0; size]);
        let scratch = lu::factor::lu_in_place_scratch::<usize, f64>(size, size, SEQUENTIAL, Default::default());
        lu::factor::lu_in_place(
            factors.as_mut(),
            &mut forward,
            &mut inverse,
            SEQUENTIAL,
            MemStack::new(&mut MemBuffer::new(scratch)),
            Default::default(),
        );
        let (mut smallest, mut largest) = (f64::INFINITY, 0.0_f64);
        for i in 0..size {
            let pivot = factors[(i, i)].abs();
            smallest = if pivot.is_nan() { 0.0 } else { smallest.min(pivot) };
            largest = largest.max(pivot);
        }
        let pivot_ratio = if largest > 0.0 { smallest / largest } else { 0.0 };
        let permutation = Perm::new_checked(forward.into_boxed_slice(), inverse.into_boxed_slice(), size);
        Self { factors, permutation, pivot_ratio: if size == 0 { 1.0 } else { pivot_ratio } }
    }

    /// Smallest pivot over largest pivot: a cheap sign of singularity.
    pub fn pivot_ratio(&self) -> f64 {
        self.pivot_ratio
    }

    /// Solves A x = b in place.
    pub fn solve_in_place(&self, b: &mut [f64]) {
        self.solve_columns(column(b));
    }

    /// Solves A X = B in place, all columns at once.
    pub(crate) fn solve_columns_in_place(&self, b: &mut Mat<f64>) {
        self.solve_columns(b.as_mut());
    }

    fn solve_columns(&self, b: MatMut<'_, f64>) {
        let scratch = lu::solve::solve_in_place_scratch::<usize, f64>(b.nrows(), b.ncols(), SEQUENTIAL);
        let mut memory = MemBuffer::new(scratch);
        let (factors, permutation) = (self.factors.as_ref(), self.permutation.as_ref());
        let stack = MemStack::new(&mut memory);
        lu::solve::solve_in_place_with_conj(factors, factors, permutation, Conj::No, b, SEQUENTIAL, stack);
    }

    /// Solves A x = b in place with one step of iterative refinement against a matrix near the one that was factored;
    /// the correction is taken if it lowers the residual.
    pub fn solve_refined(&self, matrix: &Mat<f64>, b: &mut [f64]) {
        refined(b, |b| self.solve_in_place(b), |x| multiply(matrix, x));
    }

    /// As [`DenseLu::solve_refined`], for Aᵀ x = b.
    pub fn solve_transpose_refined(&self, matrix: &Mat<f64>, b: &mut [f64]) {
        let product = |x: &[f64]| (0..x.len()).map(|column| dot(matrix.col_as_slice(column), x)).collect();
        refined(b, |b| self.solve_transpose_in_place(b), product);
    }

    /// Solves Aᵀ x = b in place.
    pub(crate) fn solve_transpose_in_place(&self, b: &mut [f64]) {
        let scratch = lu::solve::solve_transpose_in_place_scratch::<usize, f64>(b.len(), 1, SEQUENTIAL);
        let mut memory = MemBuffer::new(scratch);
        let (factors, permutation) = (self.factors.as_ref(), self.permutation.as_ref());
        let (right, stack) = (column(b), MemStack::new(&mut memory));
        lu::solve::solve_transpose_in_place_with_conj(
            factors,
            factors,
            permutation,
            Conj::No,
            right,
            SEQUENTIAL,
            stack,
        );
    }
}

/// Solves A x = b in place, then once for the residual.
fn refined(b: &mut [f64], solve: impl Fn(&mut [f64]), product: impl Fn(&[f64]) -> Vec<f64>) {
    let right = b.to_vec();
    solve(b);
    let rest =
        |x: &[f64]| -> Vec<f64> { product(x).iter().zip(&right).map(|(product, right)| right - product).collect() };
    let mut correction = rest(b);
    let before = norm(&correction);
    solve(&mut correction);
    let refined: Vec<f64> = b.iter().zip(&correction).map(|(x, correction)| x + correction).collect();
    if norm(&rest(&refined)) < before {
        b.copy_from_slice(&refined);
    }
}

/// The factor of a symmetric positive definite matrix, A = L Lᵀ.
#[derive(Debug)]
pub struct DenseCholesky {
    /// L on and below the diagonal; above it, A.
    factor: Mat<f64>,
}

impl DenseCholesky {
    /// Factors a symmetric matrix, of which the lower triangle is read.
    ///
    /// # Errors
    /// [`FactorizationError`] when the matrix is not positive definite.
    pub fn new(mut matrix: Mat<f64>) -> Result<Self, FactorizationError> {
        let scratch = llt::factor::cholesky_in_place_scratch::<f64>(matrix.nrows(), SEQUENTIAL, Default::default());
        llt::factor::cholesky_in_place(
            matrix.as_mut(),
            Default::default(),
            SEQUENTIAL,
            MemStack::new(&mut MemBuffer::new(scratch)),
            Default::default(),
        )
        .map_err(|error| FactorizationError {
            what: "dense Cholesky factorisation",
            reason: format!("{error:?}: not positive definite"),
        })?;
        Ok(Self { factor: matrix })
    }

    /// Solves L x = b in place.
    pub fn solve_lower_in_place(&self, b: &mut [f64]) {
        solve_lower_triangular_in_place(self.factor.as_ref(), column(b), SEQUENTIAL);
    }

    /// Solves Lᵀ x = b in place.
    pub fn solve_upper_in_place(&self, b: &mut [f64]) {
        solve_upper_triangular_in_place(self.factor.transpose(), column(b), SEQUENTIAL);
    }
}

/// The inverse of a symmetric matrix that is positive definite but for rounding: by Cholesky, or, where rounding has
/// made it indefinite, by LU factors.
pub(crate) fn inverse(matrix: Mat<f64>) -> Mat<f64> {
    let size = matrix.nrows();
    let Ok(DenseCholesky { factor }) = DenseCholesky::new(matrix.clone()) else {
        let mut inverse = Mat::<f64>::identity(size, size);
        DenseLu::new(&matrix).solve_columns_in_place(&mut inverse);
        return inverse;
    };
    let mut inverse = matrix;
    let mut memory = MemBuffer::new(llt::inverse::inverse_scratch::<f64>(size, SEQUENTIAL));
    llt::inverse::inverse(inverse.as_mut(), factor.as_ref(), SEQUENTIAL, MemStack::new(&mut memory));
    for column in 0..size {
        for row in column + 1..size {
            inverse[(column, row)] = inverse[(row, column)];
        }
    }
    inverse
}

/// A vector as the right side of faer's solves.
pub(super) fn column<E>(b: &mut [E]) -> MatMut<'_, E> {
    let size = b.len();
    MatMut::from_column_major_slice_mut(b, size, 1)
}

/// y = A x for a dense column-major matrix without infinite entries, whose columns at zeros of x are not read.
pub fn multiply(matrix: &Mat<f64>, x: &[f64]) -> Vec<f64> {
    let mut y = vec![0.0; matrix.nrows()];
    for (column, &x) in x.iter().enumerate().filter(|(_, x)| **x != 0.0) {
        add_scaled(&mut y, x, matrix.col_as_slice(column));
    }
    y
}

/// A B, on one thread.
pub fn multiply_columns(matrix: &Mat<f64>, columns: &Mat<f64>) -> Mat<f64> {
    let mut product = Mat::<f64>::zeros(matrix.nrows(), columns.ncols());
    matmul(product.as_mut(), Accum::Replace, matrix.as_ref(), columns.as_ref(), 1.0, SEQUENTIAL);
    product
}

/// Largest over smallest singular value of a square matrix after the rows are brought to equal length; infinite for a
/// singular matrix, none when the singular values cannot be found.
pub fn spectral_condition(matrix: &Mat<f64>) -> Option<f64> {
    let mut scaled = matrix.clone();
    for row in 0..scaled.nrows() {
        let length = scaled.row(row).iter().map(|entry| entry * entry).sum::<f64>().sqrt();
        if length > 0.0 {
            scaled.row_mut(row).iter_mut().for_each(|entry| *entry /= length);
        }
    }
    let size = scaled.nrows();
    let mut values = Diag::<f64>::zeros(size);
    let none = ComputeSvdVectors::No;
    let scratch = svd_scratch::<f64>(size, size, none, none, SEQUENTIAL, Default::default());
    let mut memory = MemBuffer::new(scratch);
    let stack = MemStack::new(&mut memory);
    svd(scaled.as_ref(), values.as_mut(), None, None, SEQUENTIAL, stack, Default::default()).ok()?;
    let values: Vec<f64> = values.column_vector().iter().copied().collect();
    let largest = values.iter().copied().fold(0.0, f64::max);
    let smallest = values.iter().copied().fold(f64::INFINITY, f64::min);
    if values.is_empty() { Some(1.0) } else { Some(largest / smallest).filter(|condition| !condition.is_nan()) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn solves_with_the_matrix_and_its_transpose() {
        let a = Mat::from_fn(3, 3, |i, j| [[0.0, 2.0, 1.0], [4.0, 1.0, 0.0], [1.0, 0.0, 3.0]][i][j]);
        let lu = DenseLu::new(&a);
        let mut x = vec![7.0, 6.0, 10.0];
        lu.solve_in_place(&mut x);
        assert!(x.iter().zip([1.0, 2.0, 3.0]).all(|(x, y)| (x - y).abs() < 1e-14), "{x:?}");
        let mut x = vec![11.0, 4.0, 10.0];
        lu.solve_transpose_in_place(&mut x);
        assert!(x.iter().zip([1.0, 2.0, 3.0]).all(|(x, y)| (x - y).abs() < 1e-14), "{x:?}");
    }

    #[test]
    fn condition_does_not_see_the_units_of_the_rows() {
        let a = Mat::from_fn(2, 2, |i, j| if i == j { [1.0, 1e9][i] } else { 0.0 });
        assert!((spectral_condition(&a).expect("finite") - 1.0).abs() < 1e-12);
        let a = Mat::from_fn(2, 2, |_, j| 1.0 + j as f64);
        assert!(spectral_condition(&a).expect("finite") > 1e15);
    }

    #[test]
    fn singular_matrix_shows_in_the_pivot_ratio() {
        let a = Mat::from_fn(2, 2, |_, j| 1.0 + j as f64);
        assert!(DenseLu::new(&a).pivot_ratio() < 1e-15);
    }
}
