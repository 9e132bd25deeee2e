//! How the displacements of condensed bodies change: from the tangents of contact forces and rigid motions to those of
//! all nodes, all columns in one solve per body.
//!
//! ```text
//! w′ = C (r̂ − ∂Bᵀλ − Bᵀλ′) + N a′,     u′ = K̂⁻¹ (r − ∂Bᵀλ − Bᵀλ′) + R b  with  B u′ = w′
//! ```
//! Rigid motions stand as in [`tangents`](super::tangents); those that no contact node feels stay as they are.

use crate::direct::compliant_contact::CompliantContact;
use crate::direct::tangents::{CondensedTangents, ShapeLoads};
use crate::linear::dense::multiply_columns;
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
        let pattern = &body.stiff().condensed.pattern;
        let own = forces.next_if(|(shaped, _)| *shaped == number);
        let right = own.map_or_else(|| Mat::zeros(pattern.piece.dof_count(), count), |(_, forces)| forces);
        let (mut on_contact, mut moved) = (Vec::with_capacity(count), Vec::with_capacity(count));
        let held: Vec<Vec<f64>> = found.tangents.forces.iter().map(|forces| body.contact_forces(forces)).collect();
        let columns = Mat::from_fn(body.load.free.len(), count, |dof, column| held[column][dof]);
        let pushed = multiply_columns(body.stiff().compliance(), &columns);
        for (column, mut held) in held.into_iter().enumerate() {
            let mut u = loads.responses[number].displacement.col_as_slice(column).to_vec();
            add_scaled(&mut u, 1.0, pushed.col_as_slice(column));
            for (motion, amplitude) in body.stiff().motions.iter().zip(&amplitudes[column][number]) {
                add_scaled(&mut u, *amplitude, motion);
            }
            add_scaled(&mut held, 1.0, loads.turned[number].col_as_slice(column));
            on_contact.push(held);
            moved.push(u);
        }
        let mut right = body.stiff().extended(right, &on_contact, &moved);
        for (column, all) in displacements.iter_mut().enumerate() {
            let u = right.col_as_slice_mut(column);
            pattern.axes.turn_back(u);
            all.extend_from_slice(u);
        }
    }
    displacements
}
