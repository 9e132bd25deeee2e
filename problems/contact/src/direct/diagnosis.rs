//! Contraction and condition of a condensed state, from its assembled matrices.
//!
//! ```text
//! Tresca matrix·du = e dΨ on the slip rows,   dλ = ∓S du,   Φ′ = 𝓕 ∂λ_N/∂Ψ over the sliding nodes
//! ```

use crate::direct::newton::CondensedContact;
use crate::equilibrium::diagnosis::{Diagnosis, spectral_radius};
use crate::equilibrium::law::Linearization;
use crate::error::ContactError;
use crate::linear::dense::{DenseLu, multiply, spectral_condition};

impl CondensedContact<'_> {
    /// Contraction factor and condition at given derivatives.
    ///
    /// # Errors
    /// [`ContactError::NotFinite`] when eigenvalues or singular values cannot be found.
    pub fn diagnose(&self, linearizations: &[Linearization]) -> Result<Diagnosis, ContactError> {
        let condition = spectral_condition(&self.newton_matrix(linearizations, self.boundary.friction))
            .ok_or(ContactError::NotFinite { what: "condition number of Newton's matrix" })?;
        let contraction = self.contraction(linearizations);
        if !contraction.is_finite() {
            return Err(ContactError::NotFinite { what: "contraction factor" });
        }
        Ok(Diagnosis { contraction, condition: Some(condition) })
    }

    /// Spectral radius of Φ′.
    fn contraction(&self, linearizations: &[Linearization]) -> f64 {
        let sliding: Vec<(usize, [f64; 2])> = linearizations
            .iter()
            .enumerate()
            .filter_map(|(index, linearization)| match linearization {
                Linearization::Slip { direction, .. } => Some((index, *direction)),
                _ => None,
            })
            .collect();
        if sliding.is_empty() {
            return 0.0;
        }
        let factors = DenseLu::new(&self.newton_matrix(linearizations, 0.0));
        let mut map = vec![0.0; sliding.len() * sliding.len()];
        for (column, (index, direction)) in sliding.iter().enumerate() {
            let mut change = vec![0.0; self.size() * self.bodies.len()];
            let rows = Self::rows_of(*index, &self.boundary.points[*index]);
            for ((dof, _), entry) in rows.skip(1).zip(direction) {
                let equation = if self.held[0][dof] { self.size() + dof } else { dof };
                change[equation] = *entry;
            }
            factors.solve_in_place(&mut change);
            let product = multiply(&self.bodies[0].schur, &change[..self.size()]);
            for (row, (node, _)) in sliding.iter().enumerate() {
                map[row * sliding.len() + column] = -self.boundary.friction * product[3 * node + 2];
            }
        }
        spectral_radius(sliding.len(), &map)
    }
}
