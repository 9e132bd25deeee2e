//! What factors are applied to: one vector, or a block of columns by rows.

use crate::linear::cholesky::NumericFactor;
use crate::linear::dense::DenseLu;
use crate::linear::entry::{Entry, Row};
use crate::linear::parallel;
use crate::linear::real::Real;
use faer::Mat;

/// Entries of right sides.
pub trait RightSide: Entry {
    /// The type of these entries in double precision.
    type Double: RightSide;

    /// Converts the entry to double precision.
    fn double(&self) -> Self::Double;

    /// Rounded from double precision.
    fn rounded(double: Self::Double) -> Self;

    /// Solves A x = b in place by a Cholesky factor.
    fn solve(factor: &NumericFactor, b: &mut [Self]);

    /// Solves A x = b in place by a dense LU factorisation, in double precision.
    fn solve_dense(factor: &DenseLu, b: &mut [Self]);
}

impl RightSide for f64 {
    type Double = f64;

    fn double(&self) -> f64 {
        *self
    }

    fn rounded(double: f64) -> f64 {
        double
    }

    fn solve(factor: &NumericFactor, b: &mut [Self]) {
        factor.solve_in_place(b);
    }

    fn solve_dense(factor: &DenseLu, b: &mut [Self]) {
        factor.solve_in_place(b);
    }
}

/// Columns that a dense solve takes at once: enough to read the factor rarely, few enough to keep two threads busy.
const DENSE_COLUMNS: usize = 20;

impl<E: Real, const N: usize> RightSide for Row<E, N> {
    type Double = Row<f64, N>;

    fn double(&self) -> Row<f64, N> {
        self.to()
    }

    fn rounded(double: Row<f64, N>) -> Self {
        double.to()
    }

    fn solve(factor: &NumericFactor, b: &mut [Self]) {
        factor.solve_rows_in_place(b);
    }

    fn solve_dense(factor: &DenseLu, b: &mut [Self]) {
        let solve = |first: usize| {
            let count = DENSE_COLUMNS.min(Self::WIDTH - first);
            let mut columns = Mat::from_fn(b.len(), count, |row, column| b[row].get(first + column));
            factor.solve_columns_in_place(&mut columns);
            columns
        };
        let starts: Vec<usize> = (0..Self::WIDTH).step_by(DENSE_COLUMNS).collect();
        let solved: Vec<Mat<f64>> = parallel::map(starts.len(), &|index| solve(starts[index]));
        for (row, b) in b.iter_mut().enumerate() {
            for (first, columns) in starts.iter().zip(&solved) {
                for column in 0..columns.ncols() {
                    b.set(first + column, columns[(row, column)]);
                }
            }
        }
    }
}
