//! Curvature of the outputs, from Jacobians at other points.
//!
//! ```text
//! L(x) = ⟨w, c(x)⟩,   w the weights of the outputs at the subproblem's solution
//! s_j = x_j − x,   y_j = (G_j − G)ᵀ w,   B = argmin Σ |B s_j − y_j|²/|s_j|⁴ over symmetric B,   its positive part
//! γ = Σ ⟨y_j, s_j⟩/|s_j|⁴ / Σ 1/|s_j|²   where the s_j do not tell B
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
    /// Outside of the space of all s_j and y_j, it is γ if it may have a mean. Beside constraints it has none: steps
    /// along them say nothing about other directions; `completes`: what the steps do not tell is completed.
    pub(super) fn curvature(
        &self,
        point: &Vector,
        jacobian: &Matrix,
        weights: &Vector,
        (has_mean, completes): (bool, bool),
        norm: &ScaledNorm,
    ) -> Option<Matrix> {
        let slope = jacobian.tr_mul(weights);
        let (mut steps, mut changes) = (vec![], vec![]);
        for (other, theirs) in self.0.iter().filter(|(_, theirs)| theirs.shape() == jacobian.shape()) {
            let step = norm.to_coordinates(&(other - point));
            let size = step.norm_squared();
            if size > 0.0 {
                changes.push(norm.dual_to_coordinates(&(theirs.tr_mul(weights) - &slope)) / size);
                steps.push(step / size);
            }
        }
        let directions: Vec<Vector> = steps.iter().chain(&changes).filter_map(|v| v.try_normalize(0.0)).collect();
        if steps.is_empty() || !directions.iter().all(|v| v.iter().all(|entry| entry.is_finite())) {
            return None;
        }
        let basis = Matrix::from_columns(&directions).qr().q();
        let within = |vectors: &[Vector]| basis.tr_mul(&Matrix::from_columns(vectors));
        let (steps, changes) = (within(&steps), within(&changes));
        let (gram, mixed) = (&steps * steps.transpose(), &changes * steps.transpose());
        // With at most as many variables as Jacobians, the steps come to tell B in all directions.
        let mean = if has_mean && point.len() > MAX_JACOBIANS { (mixed.trace() / gram.trace()).max(0.0) } else { 0.0 };
        let beyond_mean = beyond_mean(&gram, &mixed, mean, completes)?;
        let mut whole = &basis * beyond_mean * basis.transpose();
        (0..whole.nrows()).for_each(|i| whole[(i, i)] += mean);
        Some(norm.form_of_coordinates((&whole + whole.transpose()) * 0.5)).filter(|m| m.iter().all(|e| e.is_finite()))
    }
}

/// The fit with its unseen block completed, in the coordinates of its steps, whose spreads are `values`.
///
/// ```text
/// the fit of seen and unseen directions is (A, Cᵀ; C, 0);   with A = Σ α uuᵀ ≥ 0 take Σ α w wᵀ,  w = (u, C u/α)
/// ```
/// An eigenvalue of A below its coupling C u says nothing about the unseen directions, and is taken without it.
/// Clipping the eigenvalues of the whole instead would make of (0, β; β, 0) a curvature β/2 along a direction that has
/// none.
fn completed(fit: &Matrix, values: &Vector, largest: f64) -> Matrix {
    let (seen, unseen): (Vec<usize>, Vec<usize>) = (0..values.len()).partition(|&i| values[i] > UNSEEN * largest);
    let block = Matrix::from_fn(seen.len(), seen.len(), |i, j| fit[(seen[i], seen[j])]);
    let coupling = Matrix::from_fn(unseen.len(), seen.len(), |i, j| fit[(unseen[i], seen[j])]);
    let own = ((&block + block.transpose()) * 0.5).symmetric_eigen();
    let mut whole = Matrix::zeros(values.len(), values.len());
    for (k, &value) in own.eigenvalues.iter().enumerate().filter(|(_, value)| **value > 0.0) {
        let u = own.eigenvectors.column(k).into_owned();
        let beyond = &coupling * &u / value;
        let mut w = Vector::zeros(values.len());
        seen.iter().zip(u.iter()).for_each(|(&place, entry)| w[place] = *entry);
        if beyond.norm() <= 1.0 {
            unseen.iter().zip(beyond.iter()).for_each(|(&place, entry)| w[place] = *entry);
        }
        whole += &w * w.transpose() * value;
    }
    whole
}

/// B − γ, for the symmetric B that fits B S Sᵀ to Y Sᵀ, from these products, and is γ where the steps do not tell; its
/// negative eigenvalues count as zero. `completes`: γ is 0, and what the steps do not tell is [completed].
fn beyond_mean(gram: &Matrix, mixed: &Matrix, mean: f64, completes: bool) -> Option<Matrix> {
    let eigen = gram.clone().symmetric_eigen();
    let largest = eigen.eigenvalues.max();
    if !(largest > 0.0 && largest.is_finite()) {
        return None;
    }
    let q = &eigen.eigenvectors;
    let rest = mixed - gram * mean;
    let right = q.tr_mul(&(&rest + rest.transpose())) * q;
    let values = &eigen.eigenvalues;
    let n = values.len();
    let fit =
        Matrix::from_fn(n, n, |i, j| right[(i, j)] / (values[i].max(0.0) + values[j].max(0.0) + UNSEEN * largest));
    if completes {
        return Some(q * completed(&fit, values, largest) * q.transpose());
    }
    let fit = q * fit * q.transpose();
    let fit = ((&fit + fit.transpose()) * 0.5).symmetric_eigen();
    let beyond = Matrix::from_diagonal(&fit.eigenvalues.map(|value| value.max(-mean)));
    Some(&fit.eigenvectors * beyond * fit.eigenvectors.transpose())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Along one known step, B s = y however it is completed; what is beyond has no curvature of its own.
    #[test]
    fn what_the_steps_do_not_tell_is_completed_without_curvature_of_its_own() {
        let fit = Matrix::from_row_slice(2, 2, &[2.0, 1.0, 1.0, 0.0]);
        let spreads = Vector::from_vec(vec![1.0, 0.0]);
        let whole = completed(&fit, &spreads, 1.0);
        assert_eq!(whole.column(0), fit.column(0));
        // The least curvature that leaves it positive semidefinite: 1²/2.
        assert_eq!(whole[(1, 1)], 0.5);
        // A coupling beyond the curvature of the step tells nothing.
        let coupled = completed(&Matrix::from_row_slice(2, 2, &[0.5, 1.0, 1.0, 0.0]), &spreads, 1.0);
        assert_eq!(coupled, Matrix::from_row_slice(2, 2, &[0.5, 0.0, 0.0, 0.0]));
        let concave = completed(&Matrix::from_row_slice(2, 2, &[-1.0, 1.0, 1.0, 0.0]), &spreads, 1.0);
        assert_eq!(concave, Matrix::zeros(2, 2));
    }
}
