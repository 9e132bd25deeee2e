//! What the residual of a state does to a function of its contact forces: the adjoint weighs it.
//!
//! ```text
//! r = λ − Π(λ + c w),   w = B u − g;     p, η: the adjoint of j = ∂J/∂λ;     ψ = j − B p − η/c
//! J(λ̄) − J(λ*) = η_E·w_E + Σ_nodes [ψ·r + j·(λ̄ − λ)] + O(|r|²)            λ̄ = Π_cone(λ), the forces reported
//! ```
//! From K u + Bᵀλ = f, (I − D) dλ − c D B du = dr and its transpose. Every iterate has G λ = e, so that nothing else is left
//! over. [`crate::equilibrium::ValueError`] says what the terms are used for.

use crate::linear::vector::dot;
use crate::tfeti::{Iterate, TornAdjoint, TornContact};

impl TornContact<'_> {
    /// Terms of the error of J, one per equality row and one per contact node; `direction` is j over all (scaled) rows.
    pub fn weighted_residuals(&self, iterate: &Iterate, adjoint: &TornAdjoint, direction: &[f64]) -> Vec<f64> {
        let equality = self.operator.model.constraints.equality_count;
        let image = self.operator.gather(&adjoint.displacement);
        let residual = self.law_residual(iterate);
        let mut terms: Vec<f64> =
            adjoint.multipliers[..equality].iter().zip(&iterate.jumps).map(|(eta, jump)| eta * jump).collect();
        for point in &self.boundary.points {
            let contact = point.start..point.start + point.row_count();
            let rows = equality + point.start..equality + point.start + point.row_count();
            let forces = &iterate.multipliers[rows.clone()];
            let mut inside = vec![0.0; forces.len()];
            crate::equilibrium::law::project(forces, self.boundary.friction, &mut inside);
            let moved: Vec<f64> = inside.iter().zip(forces).map(|(inside, force)| inside - force).collect();
            let weights: Vec<f64> = rows
                .clone()
                .map(|row| direction[row] - image[row] - adjoint.multipliers[row] / self.stiffness)
                .collect();
            terms.push(dot(&weights, &residual[contact]) + dot(&direction[rows], &moved));
        }
        terms
    }
}
