//! Displacements of whole bodies from those of their torn pieces, and the transposed map.

use crate::body::mesh::Block;
use crate::equilibrium::SolvedBody;
use crate::lattice;
use crate::tfeti::torn::model::TornModel;
use crate::tfeti::torn::vectors::TornVector;

/// All bodies of a shape, lower first, from the displacements over the torn dofs of this process; the copies of a node
/// are averaged. Process 0 alone has them: nobody else needs the memory that whole bodies take.
pub fn whole_bodies(model: &TornModel, blocks: &[Block], torn: &TornVector) -> Vec<SolvedBody> {
    let size = model.pattern.pattern.dimension();
    let own = &torn.0[..model.interface.owned_count()];
    let Some(all) = model.distribution.at_first(own, size) else { return Vec::new() };
    blocks.iter().enumerate().map(|(body, block)| whole_body(model, body, block, &all)).collect()
}

/// The transposed map: from three entries per node of every body, lower first, to the torn dofs of this process. Each
/// of the c copies of a node carries 1/c of its entries.
pub fn torn_loads(model: &TornModel, loads: &[f64]) -> TornVector {
    let grid = &model.problem.grid;
    let count = grid.node_count();
    // All bodies are torn alike.
    let mut copies = vec![0.0; count];
    for (_, place) in model.numbering.of_body(0) {
        (0..place.node_count()).for_each(|local| copies[grid.node(place.block_position(local))] += 1.0);
    }
    let mut torn = model.zeros();
    for subdomain in &model.subdomains {
        let place = &subdomain.place;
        for local in 0..place.node_count() {
            let node = grid.node(place.block_position(local));
            let (from, to) = (3 * (subdomain.body * count + node), subdomain.first_dof + 3 * local);
            for component in 0..3 {
                torn.0[to + component] = loads[from + component] / copies[node];
            }
        }
    }
    torn
}

fn whole_body(model: &TornModel, body: usize, block: &Block, torn: &[f64]) -> SolvedBody {
    let (grid, size) = (&block.grid, model.pattern.pattern.dimension());
    let copies = || {
        model.numbering.of_body(body).flat_map(|(number, place)| {
            let displacements = torn[size * number..][..size].as_chunks::<3>().0.iter().copied();
            (0..place.node_count()).map(|local| grid.node(place.block_position(local))).zip(displacements)
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
    let before = body * model.numbering.count() / model.numbering.body_count();
    for (index, (_, place)) in model.numbering.of_body(body).enumerate() {
        for brick in lattice::points(place.first_cell, place.cells) {
            subdomains[grid.brick(brick)] = before + index;
        }
    }
    SolvedBody {
        block: block.clone(),
        displacement,
        gluing_defect: spread.into_iter().fold(0.0, f64::max).sqrt(),
        subdomains,
    }
}
