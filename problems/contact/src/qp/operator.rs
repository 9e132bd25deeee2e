//! What the solvers need to know of H and C: products.

use crate::linear::vector::{add_scaled, dot};
use nonsmooth::Matrix;

/// A symmetric positive semidefinite operator.
pub trait SymmetricOperator {
    /// Number of rows and columns.
    fn dimension(&self) -> usize;
    /// `result` = H `x`; both have `dimension()` entries.
    fn apply(&self, x: &[f64], result: &mut [f64]);
}

/// Linear equalities C x = e. Orthonormal rows give the best conditioned augmented Lagrangian.
pub trait LinearEqualities {
    /// The product C x.
    fn apply(&self, x: &[f64]) -> Vec<f64>;
    /// The product Cᵀ y.
    fn apply_transposed(&self, y: &[f64]) -> Vec<f64>;
    /// The right side e of C x = e.
    fn right_side(&self) -> &[f64];
}

/// An operator by its dimension and its product.
impl<F: Fn(&[f64], &mut [f64])> SymmetricOperator for (usize, F) {
    fn dimension(&self) -> usize {
        self.0
    }

    fn apply(&self, x: &[f64], result: &mut [f64]) {
        self.1(x, result);
    }
}

/// A dense symmetric matrix.
///
/// ```
/// use contact::qp::SymmetricOperator;
/// let h = nonsmooth::Matrix::from_row_slice(2, 2, &[2.0, 1.0, 1.0, 3.0]);
/// let mut y = vec![0.0; 2];
/// SymmetricOperator::apply(&h, &[1.0, 1.0], &mut y);
/// assert_eq!(y, [3.0, 4.0]);
/// ```
impl SymmetricOperator for Matrix {
    fn dimension(&self) -> usize {
        self.nrows()
    }

    fn apply(&self, x: &[f64], result: &mut [f64]) {
        for (result, column) in result.iter_mut().zip(self.column_iter()) {
            *result = dot(column.as_slice(), x);
        }
    }
}

/// Equalities with a dense matrix.
#[derive(Debug, Clone)]
pub struct DenseEqualities {
    /// Cᵀ: one column per equality.
    pub transposed: Matrix,
    /// The right side e of C x = e.
    pub right_side: Vec<f64>,
}

impl LinearEqualities for DenseEqualities {
    fn apply(&self, x: &[f64]) -> Vec<f64> {
        self.transposed.column_iter().map(|row| dot(row.as_slice(), x)).collect()
    }

    fn apply_transposed(&self, y: &[f64]) -> Vec<f64> {
        let mut x = vec![0.0; self.transposed.nrows()];
        for (row, y) in self.transposed.column_iter().zip(y) {
            add_scaled(&mut x, *y, row.as_slice());
        }
        x
    }

    fn right_side(&self) -> &[f64] {
        &self.right_side
    }
}
