//! −pᵀ(∂K u − ∂f), cell by cell, as sensitivities of the positions of nodes; method.md (5.1), (5.2).

use crate::body::loads::load_sensitivities;
use crate::body::{Body, Piece};
use std::collections::BTreeMap;

/// Sensitivities of the nodes of one piece (node of the mesh, value), from displacement u and adjoint displacement p
/// over its dofs. Nodes that do not move, by `moves`, are left out.
pub fn position_sensitivities(
    body: &Body,
    piece: &Piece,
    positions: &[[f64; 3]],
    [u, p]: [&[f64]; 2],
    moves: impl Fn(u32) -> bool,
) -> BTreeMap<u32, [f64; 3]> {
    let mut sensitivities: BTreeMap<u32, [f64; 3]> = BTreeMap::new();
    let (mut cell_u, mut cell_p) = (Vec::new(), Vec::new());
    for (index, &cell) in piece.cells.iter().enumerate() {
        let (cell, nodes) = (cell as usize, body.mesh.cell(cell as usize).nodes);
        if !nodes.iter().any(|node| moves(*node)) {
            continue;
        }
        piece.cell_values(index, u, &mut cell_u);
        piece.cell_values(index, p, &mut cell_p);
        let derivative =
            body.mesh.cell_nodes(cell, positions).position_derivative(body.solid.material(cell), &cell_u, &cell_p);
        for (node, derivative) in nodes.iter().zip(derivative) {
            let sum = sensitivities.entry(*node).or_default();
            (0..3).for_each(|axis| sum[axis] -= derivative[axis]);
        }
    }
    let is_own = |cell: u32| piece.cells.binary_search(&cell).is_ok();
    let p = |node: u32| piece.value_at(node, p);
    for (node, value) in load_sensitivities(body, &is_own, positions, &p, &moves) {
        let sum = sensitivities.entry(node).or_default();
        (0..3).for_each(|axis| sum[axis] += value[axis]);
    }
    sensitivities.retain(|node, _| moves(*node));
    sensitivities
}
