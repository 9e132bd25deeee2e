//! Contraction and condition of a condensed state, from its assembled matrices.
//!
//! ```text
//! Tresca matrix·(dλ, da) = e dΨ on the slip rows,   Φ′ = 𝓕 ∂λ_N/∂Ψ over the sliding nodes
//! ```

use crate::direct::compliant_contact::CompliantContact;
use crate::direct::newton::SPRINGS;
use crate::equilibrium::diagnosis::{Diagnosis, spectral_radius};
use crate::equilibrium::law::Linearization;
use crate::error::ContactError;
use crate::linear::dense::{DenseLu, spectral_condition};

impl CompliantContact {
    /// Contraction factor and condition at given derivatives.
    ///
    /// # Errors
    /// [`ContactError::NotFinite`] when eigenvalues or singular values cannot be found.
    pub(super) fn diagnose(&self, linearizations: &[Linearization]) -> Result<Diagnosis, ContactError> {
        let newton = self.active_system(linearizations, 0.0, self.problem.boundary.friction);
        let condition = spectral_condition(&newton.matrix)
            .ok_or(ContactError::NotFinite { what: "condition number of Newton's matrix" })?;
        let contraction = self.contraction(linearizations);
        if !contraction.is_finite() {
            return Err(ContactError::NotFinite { what: "contraction factor" });
        }
        Ok(Diagnosis { contraction, condition: Some(condition) })
    }

    /// Spectral radius of Φ′.
    pub(super) fn contraction(&self, linearizations: &[Linearization]) -> f64 {
        let boundary = &self.problem.boundary;
        let mut tresca = self.active_system(linearizations, 0.0, 0.0);
        let size = tresca.rows.len();
        for motion in size..tresca.matrix.nrows() {
            tresca.matrix[(motion, motion)] = SPRINGS[0];
        }
        let mut sliding: Vec<(usize, [f64; 2], usize)> = Vec::new();
        let mut first = 0;
        for (node, linearization) in boundary.points.iter().zip(linearizations) {
            if let Linearization::Slip { direction, .. } = linearization {
                sliding.push((first, *direction, node.tangents.len()));
            }
            first += if *linearization == Linearization::Open { 0 } else { node.row_count() };
        }
        if sliding.is_empty() {
            return 0.0;
        }
        let factors = DenseLu::new(&tresca.matrix);
        let mut map = vec![0.0; sliding.len() * sliding.len()];
        for (column, (first, direction, tangents)) in sliding.iter().enumerate() {
            let mut change = vec![0.0; tresca.matrix.nrows()];
            change[first + 1..first + 1 + tangents].copy_from_slice(&direction[..*tangents]);
            factors.solve_in_place(&mut change);
            for (row, (normal, ..)) in sliding.iter().enumerate() {
                map[row * sliding.len() + column] = boundary.friction * change[*normal];
            }
        }
        spectral_radius(sliding.len(), &map)
    }
}
