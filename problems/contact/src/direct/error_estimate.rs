//! What the residual of a condensed state does to a function of its contact forces.
//!
//! ```text
//! ψ = j − (p₁ − p₂) − η/c:    J − J* = Σ_nodes ψ·r − Σ_dofs (p₁ φ₁ without multiplier, p₂ (φ₁ + φ₂)) + O(|r|²)
//! ```

use crate::direct::newton::{CondensedContact, CondensedSolution};
use crate::equilibrium::certificate::projection_residual;

impl CondensedContact<'_> {
    /// Terms of the error of J, one per contact node; `p`, `eta`: the adjoint of packed j = `direction`.
    pub fn weighted_residuals(&self, state: &CondensedSolution, p: &[f64], eta: &[f64], direction: &[f64]) -> Vec<f64> {
        let size = self.size();
        let law = projection_residual(self.boundary, &state.forces, &state.jumps, self.stiffness);
        let residual = self.residual(&state.displacement);
        let rows = self.rows_by_dof();
        let second = |dof: usize| if self.bodies.len() == 2 { p[size + dof] } else { 0.0 };
        let at_dof = |dof: usize| match rows[dof] {
            Some(row) => {
                let weight = direction[row] - (p[dof] - second(dof)) - eta[row] / self.stiffness;
                let balance = match (self.bodies.len(), self.held[0][dof]) {
                    (2, true) => p[dof] * residual[dof],
                    (2, false) => second(dof) * residual[size + dof],
                    _ => 0.0,
                };
                weight * law[row] - balance
            }
            None if self.bodies.len() == 2 => -p[dof] * residual[dof] - second(dof) * residual[size + dof],
            None => -p[dof] * residual[dof],
        };
        (0..size / 3).map(|node| (3 * node..3 * node + 3).map(at_dof).sum()).collect()
    }
}
