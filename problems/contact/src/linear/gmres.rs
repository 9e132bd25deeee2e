//! Right-preconditioned GMRES with the full basis and two-pass Gram–Schmidt.
//!
//! ```text
//! min |r₀ − A Z y|,   Z = [M v₁, M v₂, …],   A Z = V H
//! ```
//! The operator may attach a payload to every product (the dual operator's product before projection), so that the
//! caller can recombine it without a further application.

use crate::linear::sums::Sums;
use crate::linear::vector::norm;
use nonsmooth::interruption::interrupted;

/// Directions, payloads and their coefficients: x = Σ coefficients·directions.
#[derive(Debug)]
pub struct Combination<P> {
    /// Preconditioned basis vectors z_k.
    pub directions: Vec<Vec<f64>>,
    /// What the operator attached to A z_k.
    pub payloads: Vec<P>,
    pub coefficients: Vec<f64>,
    /// Norm of the residual by the recurrence.
    pub residual: f64,
}

/// Iterations in which the residual usually halves, if rounding does not stop it.
pub const MAX_STALLED_ITERATIONS: usize = 40;

/// Minimises |r − A x| over growing Krylov spaces until the norm falls to `target`, `max_iterations` is reached, or the
/// norm does not halve in `patience` iterations, or nobody waits for it any more; the caller checks the residual.
///
/// `sums`: inner products; `precondition(v)` returns z = M v; `apply(z)` returns (A z, payload).
pub fn gmres<P>(
    sums: &dyn Sums,
    residual: &[f64],
    target: f64,
    max_iterations: usize,
    patience: usize,
    mut precondition: impl FnMut(&[f64]) -> Vec<f64>,
    mut apply: impl FnMut(&[f64]) -> (Vec<f64>, P),
) -> Combination<P> {
    let start = sums.norm(residual);
    let mut result =
        Combination { directions: Vec::new(), payloads: Vec::new(), coefficients: Vec::new(), residual: start };
    if start <= target || start == 0.0 {
        return result;
    }
    let mut basis = vec![residual.iter().map(|r| r / start).collect::<Vec<f64>>()];
    let mut triangle = Triangle::new(start);
    let mut history = vec![start];
    while result.residual > target && result.directions.len() < max_iterations && !interrupted() {
        let direction = precondition(&basis[basis.len() - 1]);
        let (mut image, payload) = apply(&direction);
        result.directions.push(direction);
        result.payloads.push(payload);
        let column = sums.orthogonalise(&mut image, &basis);
        let length = sums.norm(&image);
        result.residual = triangle.append(column, length);
        history.push(result.residual);
        // A vanishing new vector means the solution is exact in this space; NaN ends the loop as well.
        let scale = triangle.columns.last().map_or(0.0, |column| norm(column));
        let stalled = history.len() > patience && result.residual > 0.5 * history[history.len() - 1 - patience];
        if length.is_nan() || length <= 1e-14 * scale || stalled {
            break;
        }
        image.iter_mut().for_each(|entry| *entry /= length);
        basis.push(image);
    }
    result.coefficients = triangle.solve();
    result
}

/// The Hessenberg matrix, brought to triangular form by Givens rotations.
struct Triangle {
    columns: Vec<Vec<f64>>,
    rotations: Vec<(f64, f64)>,
    right_side: Vec<f64>,
}

impl Triangle {
    fn new(start: f64) -> Self {
        Self { columns: Vec::new(), rotations: Vec::new(), right_side: vec![start] }
    }

    /// Appends a column and its subdiagonal entry; returns the new residual norm.
    fn append(&mut self, mut column: Vec<f64>, subdiagonal: f64) -> f64 {
        for (row, &(c, s)) in self.rotations.iter().enumerate() {
            let (upper, lower) = (column[row], column[row + 1]);
            column[row] = c * upper + s * lower;
            column[row + 1] = c * lower - s * upper;
        }
        let last = column.len() - 1;
        let radius = column[last].hypot(subdiagonal);
        let (c, s) = if radius > 0.0 { (column[last] / radius, subdiagonal / radius) } else { (1.0, 0.0) };
        column[last] = radius;
        let tail = self.right_side[last];
        self.right_side[last] = c * tail;
        self.right_side.push(-s * tail);
        self.rotations.push((c, s));
        self.columns.push(column);
        (s * tail).abs()
    }

    /// Back substitution; a zero pivot contributes nothing.
    fn solve(&self) -> Vec<f64> {
        let mut x = self.right_side[..self.columns.len()].to_vec();
        for column in (0..x.len()).rev() {
            let pivot = self.columns[column][column];
            x[column] = if pivot == 0.0 { 0.0 } else { x[column] / pivot };
            for row in 0..column {
                x[row] -= self.columns[column][row] * x[column];
            }
        }
        x
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::linear::sums::Whole;
    use crate::linear::vector::{add_scaled, dot};

    #[test]
    fn nonsymmetric_system_is_solved_in_n_steps() {
        let a = [[4.0, 1.0, 0.0], [-2.0, 3.0, 1.0], [0.5, 0.0, 2.0]];
        let multiply = |x: &[f64]| a.iter().map(|row| dot(row, x)).collect::<Vec<_>>();
        let expected = [1.0, -2.0, 3.0];
        let b = multiply(&expected);
        let result =
            gmres(&Whole, &b, 1e-13 * norm(&b), 10, MAX_STALLED_ITERATIONS, |v| v.to_vec(), |z| (multiply(z), ()));
        let mut x = vec![0.0; 3];
        for (c, z) in result.coefficients.iter().zip(&result.directions) {
            add_scaled(&mut x, *c, z);
        }
        assert_eq!(result.directions.len(), 3);
        assert!(x.iter().zip(&expected).all(|(x, y)| (x - y).abs() < 1e-12), "{x:?}");
    }
}
