//! An active set: its rows, and the oblique projector that keeps its directions in equilibrium.
//!
//! ```text
//! P = I − Gqᵀ (G_T Gqᵀ)⁻¹ G_T,   Gq = G Q,  G_T = G T      (the orthogonal projector when T = Q)
//! ```
//! One projector serves both sides: it removes the rigid amplitudes on the left and keeps G T y = 0 on the right. The
//! adjoint system has its transpose.

use crate::error::ContactError;
use crate::linear::right_side::RightSide;
use crate::linear::vector::{add_scaled, norm};
use crate::tfeti::dual::active_rows::ActiveRows;
use crate::tfeti::dual::coarse_matrix::CoarseFactor;
use crate::tfeti::dual::coarse_space::CoarseSpace;
use crate::tfeti::torn::RowVector;

/// The rows of an active set that holds all rigid motions, with its factored coarse matrix G_T Gqᵀ.
#[derive(Debug)]
pub struct ActiveSet<'a> {
    /// Its rows: unknowns y, trial map T, test map Q.
    pub rows: ActiveRows<'a>,
    space: &'a CoarseSpace,
    coarse: CoarseFactor<'a>,
}

/// Pivot ratio of a coarse matrix that counts as singular.
const SINGULAR: f64 = 1e-13;

impl<'a> ActiveSet<'a> {
    /// Factors the coarse matrix of given rows.
    ///
    /// # Errors
    /// [`ContactError::Unheld`] when the rows leave a rigid motion free.
    pub fn new(space: &'a CoarseSpace, rows: ActiveRows<'a>) -> Result<Self, ContactError> {
        let coarse = space.timed(|| {
            space.condensed.with_contact(|add| {
                rows.contact_columns(|trial, test| {
                    let (trial, test) = (space.combine(trial), space.combine(test));
                    for &(column, right) in &test {
                        for &(row, left) in &trial {
                            add(row, column, left * right);
                        }
                    }
                });
            })
        });
        let pivot_ratio = coarse.pivot_ratio();
        if pivot_ratio < SINGULAR {
            return Err(ContactError::Unheld { pivot_ratio, resultant: norm(space.resultants()) });
        }
        Ok(Self { rows, space, coarse })
    }

    /// a = −(G_T Gqᵀ)⁻¹ G_T r: r + Gqᵀ a = P r is the reduced residual r without its rigid part.
    pub fn amplitudes<V: RightSide>(&self, residual: &[V]) -> Vec<V> {
        self.space.timed(|| {
            let mut amplitudes = self.space.resultant(&self.rows.trial(residual));
            self.coarse.solve_in_place(&mut amplitudes);
            amplitudes.iter_mut().for_each(|entry| entry.scale(-1.0));
            amplitudes
        })
    }

    /// v ← P v.
    pub fn project<V: RightSide>(&self, v: &mut [V]) {
        let amplitudes = self.amplitudes(v);
        self.add_rigid(&amplitudes, v);
    }

    /// v += Gqᵀ a.
    pub fn add_rigid<V: RightSide>(&self, amplitudes: &[V], v: &mut [V]) {
        self.space.timed(|| {
            for (v, jump) in v.iter_mut().zip(self.rows.test_transposed(&self.space.jumps(amplitudes))) {
                v.add_scaled(1.0, &jump);
            }
        });
    }

    /// v −= T Gqᵀ (G_T Gqᵀ)⁻¹ G v for multipliers v = T y + w with any w: then G v = 0.
    pub fn balance(&self, v: &mut RowVector) {
        self.space.timed(|| self.take_off(self.space.resultant(v), v));
    }

    /// v −= T Gqᵀ (G_T Gqᵀ)⁻¹ (G v − e): then the clusters are in equilibrium, up to the rounding of the change.
    pub fn equilibrate(&self, v: &mut RowVector) {
        self.space.timed(|| self.take_off(self.space.defect(v), v));
    }

    /// v −= T Gqᵀ (G_T Gqᵀ)⁻¹ b.
    fn take_off(&self, mut b: Vec<f64>, v: &mut RowVector) {
        self.coarse.solve_in_place(&mut b);
        let jumps = self.rows.test_transposed(&self.space.jumps(&b));
        add_scaled(v, -1.0, &self.rows.trial(&jumps));
    }

    /// y += Gqᵀ (G_T Gqᵀ)⁻¹ (target − G T y): T y has the given resultants then; the change is the smallest if T = Q.
    pub fn enforce<V: RightSide>(&self, y: &mut [V], target: &[V]) {
        let defect = self.space.timed(|| {
            let mut defect = self.space.resultant(&self.rows.trial(y));
            for (defect, target) in defect.iter_mut().zip(target) {
                defect.scale(-1.0);
                defect.add_scaled(1.0, target);
            }
            self.coarse.solve_in_place(&mut defect);
            defect
        });
        self.add_rigid(&defect, y);
    }

    /// Amplitudes b of the adjoint: −(Gq G_Tᵀ)⁻¹ Gq r.
    pub fn adjoint_amplitudes(&self, residual: &[f64]) -> Vec<f64> {
        self.space.timed(|| {
            let mut amplitudes = self.space.resultant(&self.rows.test(residual));
            self.coarse.solve_transpose_in_place(&mut amplitudes);
            amplitudes.iter_mut().for_each(|entry| *entry = -*entry);
            amplitudes
        })
    }

    /// q = G_Tᵀ (Gq G_Tᵀ)⁻¹ e for resultants e of all clusters: Gq q = e then; q is the smallest such vector if T = Q.
    pub fn carrying(&self, mut resultants: Vec<f64>) -> Vec<f64> {
        self.space.timed(|| {
            self.coarse.solve_transpose_in_place(&mut resultants);
            self.rows.trial_transposed(&self.space.jumps(&resultants))
        })
    }

    /// v ← Pᵀ v.
    pub fn project_adjoint(&self, v: &mut [f64]) {
        let amplitudes = self.adjoint_amplitudes(v);
        self.space.timed(|| add_scaled(v, 1.0, &self.rows.trial_transposed(&self.space.jumps(&amplitudes))));
    }
}
