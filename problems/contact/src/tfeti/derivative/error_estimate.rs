//! The error that the residual of a state causes in a function of its contact forces and displacements: the adjoint
//! weighs it; method.md (5.3).
//!
//! ```text
//! r = λ − Π(λ + c w),   w = B u − g;     p, η: the adjoint of j = ∂J/∂λ, l = ∂J/∂u;     ψ = j − B p − η/c
//! J(λ̄, u) − J(λ*, u*) = η_E·w_E + Σ_nodes [ψ·r + j·(λ̄ − λ)] + O(|r|²)            λ̄ = Π_cone(λ), the forces reported
//! ```
//! From K u + Bᵀλ = f, (I − D) dλ − c D B du = dr and its transpose. Every iterate has G λ = e, so that nothing else is
//! left over. [`crate::equilibrium::ValueError`] says what the terms are used for.

use crate::equilibrium::ValueError;
use crate::linear::sums::Sums;
use crate::linear::vector::dot;
use crate::tfeti::derivative::adjoint::TornAdjoint;
use crate::tfeti::dual::{Iterate, TornContact};
use crate::tfeti::torn::RowVector;

/// The error of J, from terms for every row of B_E and every contact node; `direction` is j.
pub fn value_error(
    contact: &TornContact<'_>,
    iterate: &Iterate,
    adjoint: &TornAdjoint,
    direction: &RowVector,
) -> ValueError {
    let image = contact.operator.gather(adjoint.displacement.clone());
    let residual = contact.law_residual(iterate);
    let (glued, eta) = adjoint.multipliers.split();
    let equality = iterate.jumps.split().0;
    let sums = contact.operator.model.sums().sum(equality.len(), 2, &|part, sums| {
        for term in glued[part.clone()].iter().zip(&equality[part]).map(|(eta, jump)| eta * jump) {
            sums[0] += term;
            sums[1] += term.abs();
        }
    });
    let (mut first_order, mut absolute) = (sums[0], sums[1]);
    let (j, image, forces) = (direction.contact(), image.contact(), iterate.multipliers.contact());
    for point in &contact.boundary.points {
        let rows = point.rows();
        let outside = &forces[rows.clone()];
        let mut inside = vec![0.0; outside.len()];
        point.project(outside, &mut inside);
        let moved: Vec<f64> = inside.iter().zip(outside).map(|(inside, force)| inside - force).collect();
        let weights: Vec<f64> = rows.clone().map(|row| j[row] - image[row] - eta[row] / contact.stiffness).collect();
        let term = dot(&weights, &residual[rows.clone()]) + dot(&j[rows], &moved);
        first_order += term;
        absolute += term.abs();
    }
    ValueError::from_sums(first_order, absolute, j, forces)
}
