//! Orthogonal factorisation of the active normals, updated pivot by pivot.
//!
//! ```text
//! Ã = [ã_1 … ã_k],   P Ã = Q R,   QᵀQ = I,   R upper triangular,   P = deletes the rows of fixed coordinates
//! ```
//! Adding and removing a column, fixing and releasing a coordinate cost O(rows · k) each. Working with Q R rather than
//! with the Gram matrix ÃᵀÃ keeps the condition number unsquared: cuts 1e-8 apart are normal late in a bundle run.
//! Reference: \[DanielGraggKaufmanStewart1976\] (updating of Gram–Schmidt factors with reorthogonalisation).

use super::kernels::{Rotation, add_scaled, dot, norm};
use super::triangular::Triangular;

/// Factors of the active normals restricted to the coordinates that are not fixed.
pub(super) struct Factor {
    columns: Vec<Vec<f64>>,
    orthogonal: Vec<Vec<f64>>,
    triangular: Triangular,
    fixed: Vec<bool>,
}

/// A vector split into its part in the span of the columns and the remainder orthogonal to it.
pub(super) struct Split {
    /// Qᵀ a.
    pub(super) coefficients: Vec<f64>,
    /// P a − Q Qᵀ P a.
    pub(super) remainder: Vec<f64>,
    /// Norm of the remainder.
    pub(super) distance: f64,
    /// Norm of P a.
    size: f64,
    /// Norm of a.
    full_size: f64,
}

impl Split {
    /// Whether the vector lies in the span up to rounding.
    pub(super) fn is_dependent(&self) -> bool {
        self.distance <= 1e-11 * self.size || self.distance <= 1e-14 * self.full_size
    }
}

impl Factor {
    pub(super) fn new(height: usize) -> Self {
        Self {
            columns: Vec::new(),
            orthogonal: Vec::new(),
            triangular: Triangular::default(),
            fixed: vec![false; height],
        }
    }

    pub(super) fn columns(&self) -> &[Vec<f64>] {
        &self.columns
    }

    /// Row of Q.
    pub(super) fn orthogonal_row(&self, index: usize) -> Vec<f64> {
        self.orthogonal.iter().map(|q| q[index]).collect()
    }

    /// Splits a vector; the projection is repeated until it loses no more length.
    pub(super) fn split(&self, vector: &[f64]) -> Split {
        let mut remainder = vector.to_vec();
        for (entry, _) in remainder.iter_mut().zip(&self.fixed).filter(|(_, fixed)| **fixed) {
            *entry = 0.0;
        }
        let (full_size, size) = (norm(vector), norm(&remainder));
        let mut coefficients = vec![0.0; self.orthogonal.len()];
        let mut distance = size;
        for _ in 0..4 {
            for (q, total) in self.orthogonal.iter().zip(&mut coefficients) {
                let coefficient = dot(q, &remainder);
                *total += coefficient;
                add_scaled(&mut remainder, -coefficient, q);
            }
            let before = distance;
            distance = norm(&remainder);
            if distance > 0.5 * before || distance <= 1e-15 * size {
                break;
            }
        }
        Split { coefficients, remainder, distance, size, full_size }
    }

    /// Appends a column whose split is not dependent.
    pub(super) fn push(&mut self, column: Vec<f64>, split: Split) {
        let Split { coefficients, mut remainder, distance, .. } = split;
        remainder.iter_mut().for_each(|entry| *entry /= distance);
        self.columns.push(column);
        self.orthogonal.push(remainder);
        self.triangular.push(coefficients, distance);
    }

    /// Removes the column at a position; the later ones move up.
    pub(super) fn remove(&mut self, position: usize) {
        self.columns.remove(position);
        let orthogonal = &mut self.orthogonal;
        self.triangular.remove(position, |k, rotation| {
            let (head, tail) = orthogonal.split_at_mut(k + 1);
            rotation.apply_to_slices(&mut head[k], &mut tail[0]);
        });
        self.orthogonal.truncate(self.columns.len());
    }

    /// Fixes a coordinate: deletes its row. `split` is the split of the unit vector, not dependent.
    pub(super) fn fix(&mut self, coordinate: usize, split: Split) {
        let Split { coefficients, remainder: mut extra, distance, .. } = split;
        extra.iter_mut().for_each(|entry| *entry /= distance);
        let mut last = distance;
        let mut extra_row = vec![0.0; self.columns.len()];
        for k in (0..self.orthogonal.len()).rev() {
            // (last, coefficient_k) ↦ (length, 0): the unit vector moves into the extra column.
            let rotation = Rotation::onto_first(last, coefficients[k]);
            last = last.hypot(coefficients[k]);
            rotation.apply_to_slices(&mut extra, &mut self.orthogonal[k]);
            for (column, extra) in self.triangular.columns_mut()[k..].iter_mut().zip(&mut extra_row[k..]) {
                rotation.apply(extra, &mut column[k]);
            }
            self.orthogonal[k][coordinate] = 0.0;
        }
        self.fixed[coordinate] = true;
    }

    /// Releases a fixed coordinate: inserts its row again.
    pub(super) fn release(&mut self, coordinate: usize) {
        let mut extra = vec![0.0; self.fixed.len()];
        extra[coordinate] = 1.0;
        let mut extra_row: Vec<f64> = self.columns.iter().map(|column| column[coordinate]).collect();
        for k in 0..self.orthogonal.len() {
            let rotation = Rotation::onto_first(self.triangular.columns_mut()[k][k], extra_row[k]);
            for (column, extra) in self.triangular.columns_mut()[k..].iter_mut().zip(&mut extra_row[k..]) {
                rotation.apply(&mut column[k], extra);
            }
            rotation.apply_to_slices(&mut self.orthogonal[k], &mut extra);
        }
        self.fixed[coordinate] = false;
    }

    /// Solves Rᵀ y = b in place.
    pub(super) fn solve_transposed(&self, rhs: &mut [f64]) {
        self.triangular.solve_transposed(rhs);
    }

    /// Solves R x = b in place.
    pub(super) fn solve(&self, rhs: &mut [f64]) {
        self.triangular.solve(rhs);
    }
}
