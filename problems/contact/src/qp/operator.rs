//! What the solvers need to know of H and C: products.

use crate::linear::vector::{add_scaled, dot};
use crate::qp::QpError;

/// A symmetric positive semidefinite operator.
pub trait SymmetricOperator {
    /// Number of rows and columns.
    fn dimension(&self) -> usize;
    /// `result` = H `x`; both have `dimension()` entries.
    fn apply(&self, x: &[f64], result: &mut [f64]);
}

/// Linear equalities C x = e. Orthonormal rows give the best conditioned augmented Lagrangian.
pub trait LinearEqualities {
    /// C `x`.
    fn apply(&self, x: &[f64]) -> Vec<f64>;
    /// Cᵀ `y`.
    fn apply_transposed(&self, y: &[f64]) -> Vec<f64>;
    /// e.
    fn right_side(&self) -> &[f64];
}

/// A dense symmetric matrix by rows.
///
/// ```
/// use contact::qp::{DenseSymmetric, SymmetricOperator};
/// let h = DenseSymmetric::new(vec![vec![2.0, 1.0], vec![1.0, 3.0]])?;
/// let mut y = vec![0.0; 2];
/// h.apply(&[1.0, 1.0], &mut y);
/// assert_eq!(y, [3.0, 4.0]);
/// # Ok::<(), contact::qp::QpError>(())
/// ```
#[derive(Debug, Clone)]
pub struct DenseSymmetric {
    rows: Vec<Vec<f64>>,
}

impl DenseSymmetric {
    /// From its rows.
    ///
    /// # Errors
    /// [`QpError::Dimension`] when a row has the wrong length.
    pub fn new(rows: Vec<Vec<f64>>) -> Result<Self, QpError> {
        let expected = rows.len();
        match rows.iter().find(|row| row.len() != expected) {
            Some(row) => Err(QpError::Dimension { what: "row of a symmetric matrix", expected, found: row.len() }),
            None => Ok(Self { rows }),
        }
    }
}

impl SymmetricOperator for DenseSymmetric {
    fn dimension(&self) -> usize {
        self.rows.len()
    }

    fn apply(&self, x: &[f64], result: &mut [f64]) {
        for (result, row) in result.iter_mut().zip(&self.rows) {
            *result = dot(row, x);
        }
    }
}

/// Equalities with a dense matrix by rows.
#[derive(Debug, Clone)]
pub struct DenseRows {
    columns: usize,
    rows: Vec<Vec<f64>>,
    right_side: Vec<f64>,
}

impl DenseRows {
    /// From rows of `columns` entries and the right side.
    ///
    /// # Errors
    /// [`QpError::Dimension`] when the sizes do not fit.
    pub fn new(columns: usize, rows: Vec<Vec<f64>>, right_side: Vec<f64>) -> Result<Self, QpError> {
        if let Some(row) = rows.iter().find(|row| row.len() != columns) {
            return Err(QpError::Dimension { what: "row of the equalities", expected: columns, found: row.len() });
        }
        if rows.len() != right_side.len() {
            let (expected, found) = (rows.len(), right_side.len());
            return Err(QpError::Dimension { what: "right side of the equalities", expected, found });
        }
        Ok(Self { columns, rows, right_side })
    }
}

impl LinearEqualities for DenseRows {
    fn apply(&self, x: &[f64]) -> Vec<f64> {
        self.rows.iter().map(|row| dot(row, x)).collect()
    }

    fn apply_transposed(&self, y: &[f64]) -> Vec<f64> {
        let mut x = vec![0.0; self.columns];
        for (row, y) in self.rows.iter().zip(y) {
            add_scaled(&mut x, *y, row);
        }
        x
    }

    fn right_side(&self) -> &[f64] {
        &self.right_side
    }
}
