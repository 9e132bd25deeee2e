//! What condensation has lost of the contact forces.
//!
//! ```text
//! r = f − Bᵀλ − K u,   δ = C r̂,   Δλ: one Newton step of the contact problem whose jumps are moved by δ
//! ```
//! C and the factor of K carry the rounding of the stiffest entries of K. In tall columns and in nearly incompressible
//! cells these are so much stiffer than the motion of the top that digits of C are lost, of which no residual formed
//! with C knows. r is formed with K; free rigid motions are left out of u, since K times their rounding is no force. δ
//! is the length that one step of iterative refinement would move the contact nodes by. It does not count where
//! equilibrium alone determines the forces, since condensed loads keep the resultants of the loads; Δλ shows it.

use crate::direct::active_system::ActiveFactor;
use crate::direct::compliant_contact::CompliantContact;
use crate::equilibrium::law::Linearization;
use crate::linear::vector::norm;

/// |Δλ| over the load where the contact dofs of the bodies move by δ, mm; not finite where δ is not.
pub(super) fn change_of_forces(
    contact: &CompliantContact,
    (linearizations, active): (&[Linearization], &ActiveFactor),
    delta: &[Vec<f64>],
) -> f64 {
    let mut moved = vec![0.0; contact.row_count()];
    for (body, delta) in contact.bodies.iter().zip(delta) {
        body.rows.add_jumps(delta, 1.0 / (contact.unit * contact.load), &mut moved);
    }
    let boundary = &contact.problem.boundary;
    let mut residual = Vec::with_capacity(active.rows().len() + contact.resultant.len());
    let points = boundary.points.iter().zip(linearizations);
    for (node, linearization) in points.filter(|(_, linearization)| **linearization != Linearization::Open) {
        let count = node.row_count();
        let block = linearization.derivative(count, node.friction);
        for coefficients in block.iter().take(count) {
            let terms = coefficients[..count].iter().zip(&moved[node.start..]);
            residual.push(-terms.map(|(d, moved)| d * moved).sum::<f64>());
        }
    }
    residual.resize(active.rows().len() + contact.resultant.len(), 0.0);
    norm(&active.solve(contact, residual)[..active.rows().len()])
}
