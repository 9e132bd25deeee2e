//! Curvature of the outputs, from Jacobians at other points.
//!
//! ```text
//! L(x) = ⟨w, c(x)⟩,   w the weights of the outputs at the subproblem's solution
//! s_j = x_j − x,   y_j = (G_j − G)ᵀ w,   B = argmin Σ |B s_j − y_j|²/|s_j|⁴ over symmetric B,   its positive part
//! ```
//! Where outputs have curvature, a model that linearizes them ends in short steps, unless kinks of h determine the
//! point. The curvature that matters is that of L, which changes with w: as every Jacobian is kept whole, B follows the
//! present w at once.

use crate::bundle::norm::ScaledNorm;
use crate::{Matrix, Vector};

/// Number of Jacobians kept: enough to determine B where there are few variables.
const MAX_JACOBIANS: usize = 25;
/// Directions in which the eigenvalue of Σ s_j s_jᵀ/|s_j|⁴ is below this share of the largest one count as not seen.
const UNSEEN: f64 = 1e-8;

/// Jacobians of the outputs at earlier points, the latest last.
#[derive(Debug, Default)]
pub(super) struct Memory(Vec<(Vector, Matrix)>);

impl Memory {
    /// Remembers the Jacobian at a point.
    pub(super) fn remember(&mut self, point: &Vector, jacobian: &Matrix) {
        if self.0.len() >= MAX_JACOBIANS {
            self.0.remove(0);
        }
        self.0.push((point.clone(), jacobian.clone()));
    }

    /// B at a point with its Jacobian, for weights of the outputs; none where no Jacobian at another point is known.
    pub(super) fn curvature(
        &self,
        (point, jacobian): (&Vector, &Matrix),
        weights: &Vector,
        norm: &ScaledNorm,
    ) -> Option<Matrix> {
        let n = point.len();
        let slope = jacobian.tr_mul(weights);
        let (mut gram, mut mixed) = (Matrix::zeros(n, n), Matrix::zeros(n, n));
        for (other, theirs) in self.0.iter().filter(|(_, theirs)| theirs.shape() == jacobian.shape()) {
            let step = norm.to_coordinates(&(other - point));
            let size = step.norm_squared();
            if size > 0.0 {
                let change = norm.dual_to_coordinates(&(theirs.tr_mul(weights) - &slope));
                let trust = 1.0 / (size * size);
                gram.ger(trust, &step, &step, 1.0);
                mixed.ger(trust, &change, &step, 1.0);
            }
        }
        let eigen = gram.symmetric_eigen();
        let largest = eigen.eigenvalues.max();
        if !(largest > 0.0 && largest.is_finite()) {
            return None;
        }
        let q = &eigen.eigenvectors;
        let right = q.tr_mul(&(&mixed + mixed.transpose())) * q;
        let values = &eigen.eigenvalues;
        let fit =
            Matrix::from_fn(n, n, |i, j| right[(i, j)] / (values[i].max(0.0) + values[j].max(0.0) + UNSEEN * largest));
        let fit = q * fit * q.transpose();
        let fit = ((&fit + fit.transpose()) * 0.5).symmetric_eigen();
        let positive = Matrix::from_diagonal(&fit.eigenvalues.map(|value| value.max(0.0)));
        let positive = &fit.eigenvectors * positive * fit.eigenvectors.transpose();
        Some(norm.form_of_coordinates((&positive + positive.transpose()) * 0.5))
            .filter(|m| m.iter().all(|e| e.is_finite()))
    }
}
