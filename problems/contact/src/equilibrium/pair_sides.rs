//! Master nodes that may have weights in the rows of a slave node at some shape.
//!
//! ```text
//! across the normal of node i:  |x_f − x_i| ≤ r_i + r_f + margin     x_f, r_f: centre and radius of a master facet,
//! margin = largest move of both bodies + largest facet + a tenth of the distance along the normal
//! ```
//! Shapes move nodes along their faces, and turn normals: more nodes are taken than the start needs.

use crate::mortar::{Facet, MortarNode};
use std::collections::BTreeSet;

/// Turn of a normal that is allowed for, radians.
const TURN: f64 = 0.1;

/// The master nodes of each of some slave nodes, ascending. `reach`: the largest move of both bodies along their faces,
/// mm.
pub(crate) fn possible_masters<'m>(
    slaves: impl Iterator<Item = &'m MortarNode>,
    facets: &[Vec<Facet>; 2],
    [slave, master]: [&[[f64; 3]]; 2],
    reach: f64,
) -> Vec<(u32, Vec<u32>)> {
    let ball = |facet: &Facet, positions: &[[f64; 3]]| {
        let corners = || facet.corners().iter().map(|&node| positions[node as usize]);
        let count = facet.corners().len() as f64;
        let centre: [f64; 3] = std::array::from_fn(|axis| corners().map(|x| x[axis]).sum::<f64>() / count);
        (centre, corners().map(|x| length(minus(x, centre))).fold(0.0, f64::max))
    };
    let masters: Vec<_> = facets[1].iter().map(|facet| ball(facet, master)).collect();
    let own = facets[0].iter().map(|facet| ball(facet, slave).1);
    let largest = own.chain(masters.iter().map(|(_, radius)| *radius)).fold(0.0, f64::max);
    let of_node = |node: &MortarNode| {
        let x = slave[node.node as usize];
        let mut nodes: BTreeSet<u32> = node.weights.iter().map(|(node, _)| *node).collect();
        for (facet, (centre, radius)) in facets[1].iter().zip(&masters) {
            let from = minus(*centre, x);
            let along: f64 = (0..3).map(|axis| from[axis] * node.normal[axis]).sum();
            let across: [f64; 3] = std::array::from_fn(|axis| from[axis] - along * node.normal[axis]);
            // The facets about the node reach as far as twice the largest radius.
            if length(across) <= 2.0 * largest + radius + reach + 2.0 * largest + TURN * along.abs() {
                nodes.extend(facet.corners());
            }
        }
        (node.node, nodes.into_iter().collect())
    };
    slaves.map(of_node).filter(|(_, masters): &(u32, Vec<u32>)| !masters.is_empty()).collect()
}

fn minus(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|axis| a[axis] - b[axis])
}

fn length(a: [f64; 3]) -> f64 {
    a.iter().map(|x| x * x).sum::<f64>().sqrt()
}
