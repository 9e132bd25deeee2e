//! A condensed body as a compliance, with the rigid motions that its own supports leave free.
//!
//! ```text
//! S u = f ∓ Bᵀλ   ⇔   u = C (f ∓ Bᵀλ) + N a,   Nᵀ (f ∓ Bᵀλ) = 0,   C = S⁺ = (S + s N Nᵀ)⁻¹ − N Nᵀ/s,   Nᵀ N = I
//! ```

use crate::direct::condensation::CondensedBody;
use crate::equilibrium::ContactBoundary;
use crate::equilibrium::modes::OwnMotion;
use crate::linear::dense::{DenseLu, multiply};
use crate::linear::vector::{add_scaled, dot, norm};
use faer::Mat;

/// A condensed body with its compliance.
#[derive(Debug)]
pub struct CompliantBody {
    pub(super) condensed: CondensedBody,
    /// C over the contact dofs, mm/N.
    pub(super) compliance: Mat<f64>,
    /// N: orthonormal contact displacements of the free motions.
    pub(super) motions: Vec<Vec<f64>>,
    /// Displacement of the contact dofs under the loads alone, C f, mm.
    pub(super) free: Vec<f64>,
    /// 1 for the lower body, −1 for the upper one: its share in a jump.
    pub(super) sign: f64,
    /// (row, dof) of the packed rows that the body takes part in.
    pub(super) rows: Vec<(usize, usize)>,
}

impl CompliantBody {
    /// The compliance of a condensed body; `motions`: the rigid motions that its supports leave free, `held`: its held
    /// contact dofs, `sign`: 1 for the lower body, −1 for the upper one. The condensed load takes over the resultants
    /// of the loads, of which condensation keeps fewer digits.
    pub fn new(
        mut condensed: CondensedBody,
        motions: Vec<OwnMotion>,
        boundary: &ContactBoundary,
        held: &[bool],
        sign: f64,
    ) -> Self {
        let motions = orthonormal(motions, held);
        for OwnMotion { contact, resultant } in &motions {
            let lost = resultant - dot(contact, &condensed.load);
            add_scaled(&mut condensed.load, lost, contact);
        }
        let motions: Vec<Vec<f64>> = motions.into_iter().map(|motion| motion.contact).collect();
        let schur = &condensed.schur;
        let size = schur.nrows();
        let scale = (0..size).map(|dof| schur[(dof, dof)]).sum::<f64>() / size as f64;
        let mut matrix = schur.clone();
        for motion in &motions {
            for (j, right) in motion.iter().enumerate() {
                add_scaled(matrix.col_as_slice_mut(j), scale * right, motion);
            }
        }
        let mut compliance = DenseLu::new(&matrix).inverse();
        for motion in &motions {
            for (j, right) in motion.iter().enumerate() {
                add_scaled(compliance.col_as_slice_mut(j), -right / scale, motion);
            }
        }
        let mut rows = Vec::with_capacity(boundary.row_count);
        for (index, point) in boundary.points.iter().enumerate() {
            rows.extend(point.rows_of(index).filter(|&(_, dof)| !held[dof]));
        }
        let free = multiply(&compliance, &condensed.load);
        Self { condensed, compliance, motions, free, sign, rows }
    }

    /// Forces on the contact dofs, N, of packed multipliers.
    pub(super) fn contact_forces(&self, multipliers: &[f64]) -> Vec<f64> {
        let mut forces = vec![0.0; self.condensed.load.len()];
        for &(row, dof) in &self.rows {
            forces[dof] = -self.sign * multipliers[row];
        }
        forces
    }

    /// Nᵀf of the loads, N.
    pub(super) fn resultants(&self) -> impl Iterator<Item = f64> + '_ {
        self.motions.iter().map(|motion| dot(motion, &self.condensed.load))
    }

    /// Displacements of the contact dofs, mm, under packed multipliers and with given amplitudes of the free motions;
    /// with or without the loads.
    pub(super) fn displacement(&self, multipliers: &[f64], amplitudes: &[f64], loaded: bool) -> Vec<f64> {
        let mut u = multiply(&self.compliance, &self.contact_forces(multipliers));
        if loaded {
            add_scaled(&mut u, 1.0, &self.free);
        }
        for (motion, amplitude) in self.motions.iter().zip(amplitudes) {
            add_scaled(&mut u, *amplitude, motion);
        }
        u
    }

    /// |Nᵀ(f ∓ Bᵀλ)|₂: the resultants that the forces leave along the free motions, N.
    pub(super) fn imbalance(&self, multipliers: &[f64]) -> f64 {
        let mut force = self.contact_forces(multipliers);
        add_scaled(&mut force, 1.0, &self.condensed.load);
        norm(&self.motions.iter().map(|motion| dot(motion, &force)).collect::<Vec<f64>>())
    }
}

/// Motions that are orthonormal over the contact dofs and vanish on the held ones.
fn orthonormal(motions: Vec<OwnMotion>, held: &[bool]) -> Vec<OwnMotion> {
    let mut basis: Vec<OwnMotion> = Vec::new();
    for OwnMotion { contact: mut motion, mut resultant } in motions {
        for (value, held) in motion.iter_mut().zip(held) {
            *value = if *held { 0.0 } else { *value };
        }
        // Twice, since once leaves rounding in the older directions.
        for _pass in 0..2 {
            for older in &basis {
                let share = dot(&older.contact, &motion);
                add_scaled(&mut motion, -share, &older.contact);
                resultant -= share * older.resultant;
            }
            let length = norm(&motion);
            motion.iter_mut().for_each(|value| *value /= length);
            resultant /= length;
        }
        basis.push(OwnMotion { contact: motion, resultant });
    }
    basis
}
