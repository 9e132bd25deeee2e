//! The adjoint of the condensed problem.
//!
//! ```text
//! M = ∂(λ − Π(λ + w), Rᵀλ − e)/∂(λ, a):    Mᵀ (ψ; b) = (j; 0),    η = −Dᵀψ,    p_b = −C_b B_bᵀ η + N_b b
//! dJ = −pᵀ (∂K u − ∂f) + terms of the rows,      J − J* = ψᵀ (λ − Π(λ + w)) + bᵀ (Rᵀλ − e) + O(|r|²)
//! with l = ∂J/∂u (displacement_load.rs):   j − B C l̂ for j,   Rᵀ l̂ for 0,   p_b + C_b l̂_b for p_b
//! ```
//! Where the closed nodes leave a motion free, M is singular: a proximal spring regularises its factor, and refinement
//! against M itself takes the spring off again wherever M determines the answer.

use crate::direct::active_system::ActiveFactor;
use crate::direct::compliant_contact::CompliantContact;
use crate::direct::displacement_load::CondensedLoad;
use crate::equilibrium::law::Linearization;
use crate::linear::dense::multiply;
use crate::linear::vector::add_scaled;
use nalgebra::DVector;

#[derive(Debug)]
pub(super) struct CondensedAdjoint {
    /// Contact displacements p of every body, unit of J per N.
    pub(super) displacements: Vec<Vec<f64>>,
    /// Packed η, unit of J per mm.
    pub(super) multipliers: Vec<f64>,
    /// Terms of J − J*, per row, then per motion.
    pub(super) error_terms: Vec<f64>,
}

/// The adjoint at a state, with the factor of its Newton matrix, for packed j = ∂J/∂λ and for l = ∂J/∂u of all bodies;
/// no loads if J does not depend on u.
pub(super) fn adjoint(
    contact: &CompliantContact,
    (unknowns, linearizations): (&[f64], &[Linearization]),
    active: &ActiveFactor,
    direction: &[f64],
    loads: &[CondensedLoad],
) -> CondensedAdjoint {
    let (direction, resultant) = condensed_dual(contact, direction, loads);
    let boundary = &contact.problem.boundary;
    let (count, motions) = (contact.row_count(), contact.resultant.len());
    let mut right: Vec<f64> = active.rows().iter().map(|&row| direction[row] * contact.load).collect();
    right.extend(resultant);
    let solution = active.solve_transposed(contact, &right);
    let mut psi = vec![0.0; count + motions];
    for (&row, value) in active.rows().iter().zip(&solution) {
        psi[row] = *value;
    }
    psi[count..].copy_from_slice(&solution[active.rows().len()..]);
    let mut eta = vec![0.0; count];
    for (node, linearization) in boundary.points.iter().zip(linearizations) {
        let block = linearization.derivative(node.row_count(), node.friction);
        for (i, coefficients) in block.iter().enumerate().take(node.row_count()) {
            for (j, d) in coefficients.iter().enumerate().take(node.row_count()) {
                eta[node.start + j] -= d * psi[node.start + i];
            }
        }
    }
    let (product, rigid) = (multiply(&contact.compliance, &eta), multiply(&contact.motions, &psi[count..]));
    for (node, _) in boundary.points.iter().zip(linearizations).filter(|(_, l)| **l == Linearization::Open) {
        for row in node.rows() {
            psi[row] = direction[row] * contact.load + product[row] - rigid[row];
        }
    }
    let (residual, _) = contact.residual(unknowns, 0.0);
    let error_terms = psi.iter().zip(&residual).map(|(psi, residual)| psi * residual).collect();
    eta.iter_mut().for_each(|eta| *eta /= contact.unit * contact.load);
    let own = contact.own_amplitudes(&psi[count..], 1.0 / contact.load);
    let mut displacements: Vec<Vec<f64>> =
        contact.bodies.iter().zip(&own).map(|(body, own)| body.displacement(&eta, own, false)).collect();
    for (displacement, load) in displacements.iter_mut().zip(loads) {
        add_scaled(displacement, 1.0, &load.response);
    }
    CondensedAdjoint { displacements, multipliers: eta, error_terms }
}

/// ∂J/∂λ with the displacements eliminated, packed, unit of J per N, and ∂J/∂a, dimensionless amplitudes.
fn condensed_dual(contact: &CompliantContact, direction: &[f64], loads: &[CondensedLoad]) -> (Vec<f64>, Vec<f64>) {
    let mut dual = direction.to_vec();
    if loads.is_empty() {
        return (dual, vec![0.0; contact.resultant.len()]);
    }
    for (body, load) in contact.bodies.iter().zip(loads) {
        body.rows.add_jumps(&load.response, -1.0, &mut dual);
    }
    let own = loads.iter().flat_map(|load| &load.resultants).map(|resultant| resultant * contact.unit * contact.load);
    let own: Vec<f64> = own.collect();
    (dual, contact.resultants_of(&DVector::from_vec(own)))
}
