//! −∂(K u − f)[x′]: the nodal forces that velocities of the nodes cause at a fixed displacement u; method.md (5.2).
//!
//! The adjoint counterpart is [`shape_sensitivity`](super::shape_sensitivity): its −pᵀ∂(K u − f) is pᵀr.

use crate::body::loads::{add_moved_loads, loads_depend};
use crate::body::{Body, Piece};
use crate::shape::Velocities;

/// The forces over the dofs of one piece of a body, given with its number, N, one vector per field of velocities; `u`:
/// displacement over its dofs.
pub fn shape_forces(
    (number, body): (usize, &Body),
    piece: &Piece,
    positions: &[[f64; 3]],
    u: &[f64],
    velocities: &Velocities<'_>,
) -> Vec<Vec<f64>> {
    let count = velocities.count();
    let mut forces = vec![vec![0.0; piece.dof_count()]; count];
    let mut cell_u = Vec::new();
    for (index, &cell) in piece.cells.iter().enumerate() {
        let (cell, nodes) = (cell as usize, body.mesh.cell(cell as usize).nodes);
        let fields = velocities.of_nodes(number, nodes);
        if fields.is_empty() {
            continue;
        }
        piece.cell_values(index, u, &mut cell_u);
        let mut moved = vec![vec![0.0; cell_u.len()]; fields.len()];
        let pairs = fields.iter().zip(&mut moved).map(|((_, field), moved)| (field.as_slice(), moved.as_mut_slice()));
        body.mesh.cell_nodes(cell, positions).add_moved_forces(body.solid.material(cell), &cell_u, pairs);
        for ((column, _), mut moved) in fields.iter().zip(moved) {
            moved.iter_mut().for_each(|force| *force = -*force);
            piece.add_cell_forces(index, &moved, &mut forces[*column]);
        }
    }
    if loads_depend(body, |node| velocities.moves(number, node)) {
        for (column, forces) in forces.iter_mut().enumerate() {
            add_moved_loads(body, piece, positions, |node| velocities.at(number, node, column), forces);
        }
    }
    forces
}
