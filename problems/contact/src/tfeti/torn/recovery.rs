//! Displacements of whole bodies from those of their torn pieces, and the transposed map.

use crate::equilibrium::{Positions, SolvedBody};
use crate::shape::first_of;
use crate::tfeti::torn::model::TornModel;
use crate::tfeti::torn::vectors::TornVector;
use std::sync::Arc;

/// All bodies of a shape, lower first, from the displacements over the torn dofs of this process; the copies of a node
/// are averaged. Process 0 alone has them: nobody else needs the memory that whole bodies take.
pub fn whole_bodies(model: &TornModel, positions: &Positions, torn: &TornVector) -> Vec<SolvedBody> {
    let own = &torn.0[..model.interface.owned_count()];
    let Some(all) = model.distribution.at_first(own, model.numbering.starts()) else { return Vec::new() };
    (0..positions.len()).map(|body| whole_body(model, body, positions, &all)).collect()
}

/// The transposed map: from three entries per node of every body, lower first, to the torn dofs of this process. Each
/// of the c copies of a node carries 1/c of its entries.
pub fn torn_loads(model: &TornModel, loads: &[f64]) -> TornVector {
    let mut torn = model.zeros();
    let mut first = 0;
    for (number, body) in model.problem.bodies.iter().enumerate() {
        let count = body.mesh.node_count();
        let own = loads[first..first + 3 * count].as_chunks::<3>().0;
        first += 3 * count;
        let mut copies = vec![0.0; count];
        let nodes = body.pieces.iter().flat_map(|piece| &piece.nodes);
        nodes.for_each(|&node| copies[node as usize] += 1.0);
        for (index, subdomain) in model.subdomains.iter().enumerate().filter(|(_, own)| own.body == number) {
            let start = model.starts[index];
            for (local, &node) in body.pieces[subdomain.piece].nodes.iter().enumerate() {
                for axis in 0..3 {
                    torn.0[start + 3 * local + axis] = own[node as usize][axis] / copies[node as usize];
                }
            }
        }
    }
    torn
}

fn whole_body(model: &TornModel, number: usize, positions: &Positions, torn: &[f64]) -> SolvedBody {
    let (body, numbering) = (&model.problem.bodies[number], &model.numbering);
    let copies = || {
        body.pieces.iter().enumerate().flat_map(|(piece, own)| {
            let first = numbering.starts()[numbering.number(number, piece)];
            let displacements = torn[first..][..own.dof_count()].as_chunks::<3>().0.iter().copied();
            own.nodes.iter().map(|&node| node as usize).zip(displacements)
        })
    };
    let count = body.mesh.node_count();
    // Per node: the sum over its copies, and their number.
    let mut sums = vec![0.0; 4 * count];
    for (node, copy) in copies() {
        for (sum, value) in sums[4 * node..].iter_mut().zip(copy.into_iter().chain([1.0])) {
            *sum += value;
        }
    }
    let displacement: Vec<[f64; 3]> =
        sums.chunks_exact(4).map(|sum| std::array::from_fn(|component| sum[component] / sum[3].max(1.0))).collect();
    let mut spread = vec![0.0; count];
    for (node, copy) in copies() {
        spread[node] += copy.iter().zip(displacement[node]).map(|(copy, mean)| (copy - mean).powi(2)).sum::<f64>();
    }
    let before: usize = model.problem.bodies[..number].iter().map(|body| body.pieces.len()).sum();
    let mut subdomains = vec![0; body.mesh.cell_count()];
    for (piece, own) in body.pieces.iter().enumerate() {
        own.cells.iter().for_each(|&cell| subdomains[cell as usize] = before + piece);
    }
    SolvedBody {
        mesh: Arc::clone(&body.mesh),
        positions: first_of(&positions[number], body.mesh.node_count()),
        displacement,
        gluing_defect: spread.into_iter().fold(0.0, f64::max).sqrt(),
        subdomains,
    }
}
