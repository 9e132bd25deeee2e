//! Curvature of the smooth piece that a cut touches, from the other cuts of that piece.
//!
//! ```text
//! B_i:  per other cut j, farthest first, s = y_j − y_i, z = g_j − g_i:
//!       same piece:   cut B down to sᵀBs ≤ sᵀz, then B += r rᵀ/⟨r, s⟩, r = z − B s
//!       other piece:  cut B down to sᵀBs ≤ 2 min(E_ij, E_ji)₊, so that the piece stays below Θ at y_j where it can
//! ```
//! B_i starts from zero; on a quadratic it is the multisecant matrix. A pair lies on one piece if its two linearization
//! errors agree: on a quadratic both are ½ sᵀBs, and a kink between the points drives them apart. As long as Θ looks
//! convex, B_i stays positive semidefinite. Afterwards ⟨r, s⟩ may have either sign, and pairs of one piece whose errors
//! are both negative cut nothing down: a curved valley between two pieces makes one of them concave, and a model
//! without this curvature sees the valley rise on both sides of every step along it.

use crate::bundle::cut::Cut;
use crate::bundle::kept_cuts::allowance;
use crate::bundle::state::{BundleState, NOISE_MARGIN};
use crate::{Matrix, Vector};

/// Ratio of the smaller to the larger linearization error of a pair from which on both points count as lying on one
/// smooth piece; for pairs with the center, whose curvature does not change the model from afar, and for pairs whose
/// errors are both negative, one half does.
pub(super) const SAME_PIECE: f64 = 0.995;
/// Least cosine between s and r for a rank-one update, and between s and B s where B is cut down.
const LEAST_COSINE: f64 = 1e-3;

/// A symmetric matrix Σ c v vᵀ.
#[derive(Debug, Clone, Default)]
pub(super) struct Curvature {
    terms: Vec<(f64, Vector)>,
}

impl Curvature {
    /// The curvature around the cut at a position. Errors of a pair agree if the smaller is at least `same_piece` times
    /// the larger; where both are negative, which a convex kink cannot cause, one half does.
    pub(super) fn around(base: usize, state: &BundleState, same_piece: f64) -> Self {
        let mut curvature = Self::default();
        let may_be_concave = state.nonconvex;
        let (bundle, own) = (&state.bundle, base);
        let base = &bundle.cuts()[own];
        // The value of a certified cut says nothing about curvature.
        if base.certified {
            return curvature;
        }
        let distances = |(i, cut)| (bundle.pairs().distance(own, i), i, cut);
        let mut cuts: Vec<(f64, usize, &Cut)> = bundle.cuts().iter().enumerate().map(distances).collect();
        cuts.retain(|(distance, _, cut)| cut.id != base.id && *distance > 0.0 && !cut.certified);
        cuts.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.2.id.cmp(&b.2.id)));
        for (_, i, cut) in cuts {
            let errors = [bundle.pair_error(own, i), bundle.pair_error(i, own)];
            let (low, high) = (errors[0].min(errors[1]), errors[0].max(errors[1]));
            // What the oracle leaves open must not pass for curvature.
            let open = base.error_bound + cut.error_bound;
            let proven = NOISE_MARGIN * state.noise + allowance(base, cut);
            let concave = may_be_concave && -high > proven && high <= 0.5 * low;
            let convex = low >= same_piece * high && high > 0.0 && open <= (1.0 - same_piece) * high;
            let one_piece = concave || convex;
            if !one_piece && curvature.terms.is_empty() {
                continue;
            }
            let s = &cut.point - &base.point;
            let z = &cut.subgradient - &base.subgradient;
            if !concave {
                let limit = if one_piece { z.dot(&s) } else { 2.0 * (low + open).max(0.0) };
                // Where B is indefinite, the terms of sᵀBs may nearly cancel, and a multiple of B s sᵀB would be huge.
                let least = LEAST_COSINE * state.norm.length(&s);
                curvature.cut_down(&s, limit, |image| least * state.norm.dual_length(image));
            }
            let r = &z - curvature.apply(&s);
            let along = r.dot(&s);
            let size = if may_be_concave { along.abs() } else { along };
            if one_piece && size > LEAST_COSINE * state.norm.dual_length(&r) * state.norm.length(&s) {
                curvature.terms.push((1.0 / along, r));
            }
        }
        curvature
    }

    /// Whether a pair has shown any curvature.
    pub(super) fn is_known(&self) -> bool {
        !self.terms.is_empty()
    }

    #[cfg(test)]
    pub(super) fn from_terms(terms: Vec<(f64, Vector)>) -> Self {
        Self { terms }
    }

    /// B s.
    pub(super) fn apply(&self, s: &Vector) -> Vector {
        let mut product = Vector::zeros(s.len());
        for (factor, v) in &self.terms {
            product.axpy(factor * v.dot(s), v, 1.0);
        }
        product
    }

    /// sᵀB s.
    pub(super) fn along(&self, s: &Vector) -> f64 {
        s.dot(&self.apply(s))
    }

    /// Adds `share` · B to a dense matrix.
    pub(super) fn add_to(&self, matrix: &mut Matrix, share: f64) {
        for (factor, v) in &self.terms {
            matrix.ger(share * factor, v, v, 1.0);
        }
    }

    /// Lowers sᵀB s to the limit, if it is larger.
    fn cut_down(&mut self, s: &Vector, limit: f64, least: impl Fn(&Vector) -> f64) {
        let image = self.apply(s);
        let along = s.dot(&image);
        if along > limit && along > least(&image) {
            self.terms.push(((limit / along - 1.0) / along, image));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// B = diag(1, −1) and s = (1, 1 − 1e-6), for which sᵀBs = 2e-6: cut down to 0, B would get the eigenvalue −1e6.
    #[test]
    fn an_indefinite_matrix_is_cut_down_only_where_its_terms_do_not_cancel() {
        let axis = |i| Vector::from_fn(2, |k, _| if k == i { 1.0 } else { 0.0 });
        let indefinite = || Curvature::from_terms(vec![(1.0, axis(0)), (-1.0, axis(1))]);
        let largest = |curvature: &Curvature| {
            let mut matrix = Matrix::zeros(2, 2);
            curvature.add_to(&mut matrix, 1.0);
            matrix.amax()
        };
        let across = Vector::from_vec(vec![1.0, 1.0 - 1e-6]);
        let cosine = 1e-3;
        let mut kept = indefinite();
        kept.cut_down(&across, 0.0, |image| cosine * image.norm() * across.norm());
        assert_eq!(largest(&kept), 1.0);
        let mut unguarded = indefinite();
        unguarded.cut_down(&across, 0.0, |_| 0.0);
        assert!(largest(&unguarded) > 1e5);
        let mut cut = indefinite();
        cut.cut_down(&axis(0), 0.25, |image| cosine * image.norm());
        assert!((cut.along(&axis(0)) - 0.25).abs() < 1e-15 && (cut.along(&axis(1)) + 1.0).abs() < 1e-15);
    }
}
