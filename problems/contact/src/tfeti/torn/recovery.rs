//! Displacements of whole bodies from those of their torn pieces.

use crate::body::mesh::Block;
use crate::equilibrium::SolvedBody;
use crate::lattice;
use crate::tfeti::torn::model::TornModel;
use crate::tfeti::torn::vectors::TornVector;

/// All bodies of a shape, lower first, from the displacements over the torn dofs of this process (zero elsewhere); the copies
/// of a node are averaged.
pub fn whole_bodies(model: &TornModel, blocks: &[Block], torn: &TornVector) -> Vec<SolvedBody> {
    let mut torn = torn.clone();
    model.share_torn(&mut torn);
    blocks.iter().enumerate().map(|(body, block)| whole_body(model, body, block, &torn)).collect()
}

fn whole_body(model: &TornModel, body: usize, block: &Block, TornVector(torn): &TornVector) -> SolvedBody {
    let grid = &block.grid;
    let pieces = || model.subdomains.iter().enumerate().filter(|(_, piece)| piece.body == body);
    let copies = || {
        pieces().flat_map(|(_, piece)| {
            (0..piece.place.node_count()).map(move |local| {
                let first = piece.first_dof + 3 * local;
                (grid.node(piece.place.block_position(local)), [torn[first], torn[first + 1], torn[first + 2]])
            })
        })
    };
    // Per node: the sum over its copies, and their number.
    let mut sums = vec![0.0; 4 * grid.node_count()];
    for (node, copy) in copies() {
        for (sum, value) in sums[4 * node..].iter_mut().zip(copy.into_iter().chain([1.0])) {
            *sum += value;
        }
    }
    let displacement: Vec<[f64; 3]> =
        sums.chunks_exact(4).map(|sum| std::array::from_fn(|component| sum[component] / sum[3])).collect();
    let mut spread = vec![0.0; grid.node_count()];
    for (node, copy) in copies() {
        spread[node] += copy.iter().zip(displacement[node]).map(|(copy, mean)| (copy - mean).powi(2)).sum::<f64>();
    }
    let mut subdomains = vec![0; grid.brick_count()];
    for (index, piece) in pieces() {
        for brick in lattice::points(piece.place.first_cell, piece.place.cells) {
            subdomains[grid.brick(brick)] = index;
        }
    }
    SolvedBody {
        block: block.clone(),
        displacement,
        gluing_defect: spread.into_iter().fold(0.0, f64::max).sqrt(),
        subdomains,
    }
}
