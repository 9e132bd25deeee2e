//! The error that the residual of a state causes in a function of its contact forces: the adjoint weighs it; method.md (5.3).
//!
//! ```text
//! r = λ − Π(λ + c w),   w = B u − g;     p, η: the adjoint of j = ∂J/∂λ;     ψ = j − B p − η/c
//! J(λ̄) − J(λ*) = η_E·w_E + Σ_nodes [ψ·r + j·(λ̄ − λ)] + O(|r|²)            λ̄ = Π_cone(λ), the forces reported
//! ```
//! From K u + Bᵀλ = f, (I − D) dλ − c D B du = dr and its transpose. Every iterate has G λ = e, so that nothing else is left
//! over. [`crate::equilibrium::ValueError`] says what the terms are used for.

use crate::equilibrium::law;
use crate::linear::vector::dot;
use crate::tfeti::derivative::adjoint::TornAdjoint;
use crate::tfeti::dual::{Iterate, TornContact};
use crate::tfeti::torn::RowVector;

impl TornContact<'_> {
    /// Terms of the error of J, one per row of B_E and one per contact node; `direction` is j.
    pub fn weighted_residuals(&self, iterate: &Iterate, adjoint: &TornAdjoint, direction: &RowVector) -> Vec<f64> {
        let image = self.operator.gather(adjoint.displacement.clone());
        let residual = self.law_residual(iterate);
        let (glued, eta) = adjoint.multipliers.split();
        let mut terms: Vec<f64> = glued.iter().zip(iterate.jumps.iter()).map(|(eta, jump)| eta * jump).collect();
        let (j, image, forces) = (direction.contact(), image.contact(), iterate.multipliers.contact());
        for point in &self.boundary.points {
            let rows = point.rows();
            let outside = &forces[rows.clone()];
            let mut inside = vec![0.0; outside.len()];
            law::project(outside, self.boundary.friction, &mut inside);
            let moved: Vec<f64> = inside.iter().zip(outside).map(|(inside, force)| inside - force).collect();
            let weights: Vec<f64> = rows.clone().map(|row| j[row] - image[row] - eta[row] / self.stiffness).collect();
            terms.push(dot(&weights, &residual[rows.clone()]) + dot(&j[rows], &moved));
        }
        terms
    }
}
