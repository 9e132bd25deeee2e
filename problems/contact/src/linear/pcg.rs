//! Preconditioned conjugate gradients in the range of a projector: short recurrences where the system is symmetric.

use crate::linear::sums::Sums;
use crate::linear::vector::add_scaled;

/// Solution of a run of [`pcg`].
#[derive(Debug)]
pub struct PcgSolution {
    pub solution: Vec<f64>,
    /// Norm of the residual by the recurrence.
    pub residual: f64,
    pub iterations: usize,
}

/// Solves A x = r until the residual norm falls to `target` or `max_iterations` is reached.
///
/// `sums`: inner products; `precondition(v)` returns z = M v; `apply(z)` returns A z, projected. Stops early when a
/// direction has no positive curvature left (rounding); the caller checks the residual.
pub fn pcg(
    sums: &dyn Sums,
    residual: &[f64],
    target: f64,
    max_iterations: usize,
    mut precondition: impl FnMut(&[f64]) -> Vec<f64>,
    mut apply: impl FnMut(&[f64]) -> Vec<f64>,
) -> PcgSolution {
    let mut rest = residual.to_vec();
    let mut result = PcgSolution { solution: vec![0.0; residual.len()], residual: sums.norm(&rest), iterations: 0 };
    if result.residual <= target {
        return result;
    }
    let mut preconditioned = precondition(&rest);
    let mut direction = preconditioned.clone();
    let mut energy = sums.dot(&rest, &preconditioned);
    while result.residual > target && result.iterations < max_iterations {
        let projected = apply(&direction);
        let curvature = sums.dot(&direction, &projected);
        if curvature.is_nan() || curvature <= 0.0 || energy <= 0.0 {
            break;
        }
        let step = energy / curvature;
        add_scaled(&mut result.solution, step, &direction);
        add_scaled(&mut rest, -step, &projected);
        result.iterations += 1;
        result.residual = sums.norm(&rest);
        preconditioned = precondition(&rest);
        let next = sums.dot(&rest, &preconditioned);
        let ratio = next / energy;
        energy = next;
        for (direction, z) in direction.iter_mut().zip(&preconditioned) {
            *direction = z + ratio * *direction;
        }
    }
    result
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::linear::sums::Whole;
    use crate::linear::vector::{dot, norm};

    #[test]
    fn spd_system_is_solved_in_n_steps() {
        let a = [[4.0, 1.0, 0.0], [1.0, 3.0, -1.0], [0.0, -1.0, 2.0]];
        let multiply = |x: &[f64]| a.iter().map(|row| dot(row, x)).collect::<Vec<_>>();
        let expected = [1.0, -2.0, 3.0];
        let b = multiply(&expected);
        let jacobi = |v: &[f64]| v.iter().zip([4.0, 3.0, 2.0]).map(|(v, d)| v / d).collect::<Vec<_>>();
        let result = pcg(&Whole, &b, 1e-13 * norm(&b), 10, jacobi, multiply);
        assert_eq!(result.iterations, 3);
        assert!(result.solution.iter().zip(&expected).all(|(x, y)| (x - y).abs() < 1e-12));
    }
}
