//! An upper triangular factor that gains and loses columns.

use super::kernels::{Rotation, add_scaled, dot};

/// The columns of R, each down to its diagonal entry.
#[derive(Debug, Clone, Default)]
pub(super) struct Triangular {
    columns: Vec<Vec<f64>>,
}

impl Triangular {
    pub(super) fn columns_mut(&mut self) -> &mut [Vec<f64>] {
        &mut self.columns
    }

    pub(super) fn clear(&mut self) {
        self.columns.clear();
    }

    /// Appends a column with its diagonal entry.
    pub(super) fn push(&mut self, mut column: Vec<f64>, diagonal: f64) {
        column.push(diagonal);
        self.columns.push(column);
    }

    /// Removes a column; the later ones move up. Every rotation that restores the triangle is passed on, with the
    /// first of its two rows.
    pub(super) fn remove(&mut self, position: usize, mut rotated: impl FnMut(usize, Rotation)) {
        self.columns.remove(position);
        for k in position..self.columns.len() {
            let rotation = Rotation::onto_first(self.columns[k][k], self.columns[k][k + 1]);
            for column in &mut self.columns[k..] {
                let (head, tail) = column.split_at_mut(k + 1);
                rotation.apply(&mut head[k], &mut tail[0]);
            }
            self.columns[k].truncate(k + 1);
            rotated(k, rotation);
        }
    }

    /// Solves Rᵀ y = b in place.
    pub(super) fn solve_transposed(&self, rhs: &mut [f64]) {
        for (k, column) in self.columns.iter().enumerate() {
            let known = dot(&column[..k], &rhs[..k]);
            rhs[k] = (rhs[k] - known) / column[k];
        }
    }

    /// Solves R x = b in place.
    pub(super) fn solve(&self, rhs: &mut [f64]) {
        for (k, column) in self.columns.iter().enumerate().rev() {
            rhs[k] /= column[k];
            let value = rhs[k];
            add_scaled(&mut rhs[..k], -value, &column[..k]);
        }
    }
}
