//! How the displacements of condensed bodies change: from the tangents of contact forces and rigid motions to those of
//! all nodes, all columns in one solve per body.
//!
//! ```text
//! u_c′ = C (r̂_c − ∂Bᵀλ − Bᵀλ′) + N a′,     (K + σ I_c) u′ = r + (−∂Bᵀλ − Bᵀλ′ + σ u_c′ on the contact dofs)
//! ```
//! Rigid motions stand as in [`tangents`](super::tangents); those that no contact node feels stay as they are.

use crate::direct::compliant_body::ContactBody;
use crate::direct::compliant_contact::CompliantContact;
use crate::direct::tangents::{CondensedTangents, ShapeLoads};
use crate::linear::dense::multiply;
use crate::linear::vector::add_scaled;
use faer::Mat;

/// u′ per change: three entries along the axes per node of every body, mm; `forces`: r over the bodies that controls
/// shape, in the coordinates of their nodes, N, one column per change.
pub(super) fn displacement_tangents(
    contact: &CompliantContact,
    forces: Vec<(usize, Mat<f64>)>,
    loads: &ShapeLoads,
    found: &CondensedTangents,
) -> Vec<Vec<f64>> {
    let count = loads.approaches.len();
    let own = |amplitudes: &Vec<f64>| contact.own_amplitudes(amplitudes, contact.unit * contact.load);
    let amplitudes: Vec<Vec<Vec<f64>>> = found.amplitudes.iter().map(own).collect();
    let mut displacements = vec![Vec::new(); count];
    let mut forces = forces.into_iter().peekable();
    for (number, body) in contact.bodies.iter().enumerate() {
        let condensed = &body.stiff().condensed;
        let (pattern, weights) = (&condensed.pattern, &condensed.weights);
        let own = forces.next_if(|(shaped, _)| *shaped == number);
        let mut right = own.map_or_else(|| Mat::zeros(pattern.piece.dof_count(), count), |(_, forces)| forces);
        for column in 0..count {
            let held = body.contact_forces(&found.tangents.forces[column]);
            let on_contact = loads.contact[number].col_as_slice(column);
            let u = contact_change(body, on_contact, &held, &amplitudes[column][number]);
            let turned = loads.turned[number].col_as_slice(column);
            let right = right.col_as_slice_mut(column);
            for (index, &node) in pattern.contact.iter().enumerate() {
                for dof in 3 * index..3 * index + 3 {
                    right[3 * node + dof % 3] += turned[dof] + held[dof] + condensed.shift * u[dof];
                }
            }
        }
        condensed.factor.solve_columns_in_place(&mut right);
        for (column, all) in displacements.iter_mut().enumerate() {
            let u = right.col_as_slice_mut(column);
            pattern.coordinates.displacements(&contact.problem.bodies[number].trace, weights, u);
            all.extend_from_slice(u);
        }
    }
    displacements
}

/// u_c′ of a body, mm, from forces of the change of the shape and of λ′ on its contact dofs, N, and amplitudes, mm.
fn contact_change(body: &ContactBody, loads: &[f64], held: &[f64], amplitudes: &[f64]) -> Vec<f64> {
    let forces: Vec<f64> = loads.iter().zip(held).map(|(load, held)| load + held).collect();
    let mut u = multiply(&body.stiff().compliance, &forces);
    for (motion, amplitude) in body.stiff().motions.iter().zip(amplitudes) {
        add_scaled(&mut u, *amplitude, motion);
    }
    u
}
