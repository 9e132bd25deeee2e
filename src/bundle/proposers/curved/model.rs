//! A second model with curvature, rebuilt from the bundle at every step.
//!
//! ```text
//! q(d) = max_i { ⟨h_i + B_i p_i, d⟩ − (a_i − ½ p_iᵀB_i p_i)₊ + ½ dᵀB_i d },   p_i = x̂ − y_i
//! over the cut of the center, the cuts whose value the quadratic of the center explains to less than half, and all certified cuts
//! ```
//! Every piece has its own curvature B_i (pieces.rs); step.rs minimises the model with its penalty. Once Θ is known to
//! be nonconvex, pieces may be concave: a piece of known curvature then keeps its subgradient, without the tilt of the
//! plain cuts, and its offset is |e_i − ½ p_iᵀB_i p_i|. Reference: \[LuksanVlcek1998\] (cuts transported by their own
//! curvature).

use super::pieces::{Curvature, SAME_PIECE};
use crate::bundle::cut;
use crate::bundle::proposers::cuts::model::Model;
use crate::bundle::state::BundleState;
use crate::{Matrix, Vector};

/// Slopes, offsets and curvatures of the pieces.
#[derive(Debug, Default)]
pub(super) struct CurvedModel {
    pieces: Vec<Curvature>,
    slopes: Vec<Vector>,
    offsets: Vec<f64>,
    ids: Vec<u64>,
}

impl CurvedModel {
    /// The model q at the center, from the bundle and its plain model.
    pub(super) fn new(state: &BundleState, plain: &Model) -> Self {
        let mut model = Self::default();
        let Some(center) = state.bundle.position(state.center_id) else { return model };
        let around = Curvature::around(center, state, 0.5);
        for (i, (cut, (slope, &offset))) in
            state.bundle.cuts().iter().zip(plain.cuts().slopes.iter().zip(plain.cuts().offsets)).enumerate()
        {
            let p = &state.center - &cut.point;
            let half = 0.5 * around.along(&p);
            let error = state.bundle.pair_error(center, i);
            let is_center = i == center;
            let contradicts = half < 0.5 * error;
            if !is_center && !cut.certified && !contradicts {
                continue;
            }
            let piece = if is_center { around.clone() } else { Curvature::around(i, state, SAME_PIECE) };
            let transported = 0.5 * piece.along(&p);
            if state.nonconvex && piece.is_known() && plain.is_whole(i) {
                // The tilt of the plain cuts stands for curvature that is not known.
                let left = state.bundle.pair_error(i, center) - transported;
                let promised = if is_center { 0.0 } else { cut.excess() + state.center_error_bound() };
                model.slopes.push(&cut.subgradient + piece.apply(&p));
                model.offsets.push(cut::offset(left, 0.0, promised, false));
            } else {
                model.slopes.push(slope + piece.apply(&p));
                model.offsets.push((offset - transported).max(0.0));
            }
            model.ids.push(cut.id);
            model.pieces.push(piece);
        }
        model
    }

    /// Identities of the pieces: those of their cuts.
    pub(super) fn ids(&self) -> &[u64] {
        &self.ids
    }

    /// Σ λ_i B_i.
    pub(super) fn matrix(&self, dimension: usize, multipliers: &[f64]) -> Matrix {
        let mut sum = Matrix::zeros(dimension, dimension);
        for (piece, &multiplier) in self.pieces.iter().zip(multipliers).filter(|(_, l)| **l > 0.0) {
            piece.add_to(&mut sum, multiplier);
        }
        // Rounding makes the sum of rank-one updates unsymmetric.
        (&sum + sum.transpose()) * 0.5
    }

    /// Predicted change of Θ.
    pub(super) fn change(&self, d: &Vector) -> f64 {
        self.values(d).fold(f64::NEG_INFINITY, f64::max)
    }

    /// Slopes and values of all pieces at a step.
    pub(super) fn tangents(&self, d: &Vector) -> (Vec<Vector>, Vec<f64>) {
        (self.slopes.iter().zip(&self.pieces).map(|(h, b)| h + b.apply(d)).collect(), self.values(d).collect())
    }

    /// Values of the pieces at a step.
    fn values(&self, d: &Vector) -> impl Iterator<Item = f64> {
        let pieces = self.slopes.iter().zip(&self.offsets).zip(&self.pieces);
        pieces.map(|((h, a), b)| h.dot(d) - a + 0.5 * b.along(d))
    }

    /// The multipliers of one piece alone.
    pub(super) fn multipliers_of(&self, id: u64) -> Vec<f64> {
        self.ids.iter().map(|other| f64::from(u8::from(*other == id))).collect()
    }

    /// A model of given slopes, offsets and curvatures.
    #[cfg(test)]
    pub(super) fn from_pieces(pieces: Vec<(Vector, f64, Curvature)>) -> Self {
        let mut model = Self { ids: (0..pieces.len() as u64).collect(), ..Self::default() };
        for (slope, offset, curvature) in pieces {
            model.slopes.push(slope);
            model.offsets.push(offset);
            model.pieces.push(curvature);
        }
        model
    }
}
