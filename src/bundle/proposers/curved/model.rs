//! A second model with curvature, rebuilt from the bundle at every step.
//!
//! ```text
//! q(d) = max_i { ⟨h_i + B_i p_i, d⟩ − (a_i − ½ p_iᵀB_i p_i)₊ + ½ dᵀB_i d },   p_i = x̂ − y_i
//! over the cut of the center, the cuts that contradict its quadratic, and all certified cuts
//! ```
//! Every piece has its own curvature B_i (pieces.rs); step.rs minimises the model with its penalty.
//! Once Θ is known to be nonconvex, pieces may bend down: a piece of known curvature then keeps its subgradient, without the tilt of the
//! plain cuts, and its offset is |e_i − ½ p_iᵀB_i p_i|. Reference: \[LuksanVlcek1998\] (cuts transported by their own curvature).

use super::config::CurvedModelConfig;
use super::pieces::Curvature;
use crate::bundle::cut;
use crate::bundle::proposers::cuts::model::Model;
use crate::bundle::state::State;
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
    pub(super) fn new(state: &State, plain: &Model, settings: &CurvedModelConfig) -> Self {
        let mut model = Self::default();
        let Some(center) = state.bundle.position(state.center_id) else { return model };
        let curvature = |position, same_piece| Curvature::around(position, state, settings, same_piece);
        let around = curvature(center, settings.same_piece_at_center);
        for (i, (cut, (slope, &offset))) in
            state.bundle.cuts().iter().zip(plain.cuts().slopes.iter().zip(plain.cuts().offsets)).enumerate()
        {
            let p = &state.center - &cut.point;
            let half = 0.5 * around.along(&p);
            let error = state.bundle.pair_error(center, i);
            let is_center = i == center;
            let contradicts = error - half > settings.contradiction * (half.abs() + error.abs());
            if !is_center && !cut.certified && !contradicts {
                continue;
            }
            let piece = if is_center { around.clone() } else { curvature(i, settings.same_piece) };
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

    /// Multipliers of the plain subproblem. What the cuts outside this model carry there goes to the cut of the center.
    pub(super) fn first_multipliers(&self, state: &State) -> Vec<f64> {
        let of = |id: &u64| state.bundle.cut(*id).map_or(0.0, |cut| cut.multiplier);
        let mut multipliers: Vec<f64> = self.ids.iter().map(of).collect();
        let rest = 1.0 - multipliers.iter().sum::<f64>();
        if let Some(center) = self.ids.iter().position(|id| *id == state.center_id) {
            multipliers[center] += rest.max(0.0);
        }
        multipliers
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
