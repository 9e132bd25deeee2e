//! Nested dissection of a box of grid nodes, in elimination order.
//!
//! The longest axis is split by a plane of nodes: left part, right part, separator. The order is a postorder of its
//! elimination tree, which the factorisation relies on when trailing dofs must stay last.

use crate::lattice;

/// Nodes of a grid of `nodes` = (n₁, n₂, n₃) points, index (i·n₂ + j)·n₃ + k, in nested dissection order.
pub fn nested_dissection(nodes: [usize; 3]) -> Vec<usize> {
    let mut order = Vec::with_capacity(nodes.iter().product());
    dissect([0; 3], nodes, nodes, &mut order);
    order
}

/// Boxes up to this many nodes are emitted as they are.
const LEAF: usize = 8;

fn dissect(start: [usize; 3], end: [usize; 3], nodes: [usize; 3], order: &mut Vec<usize>) {
    let size = lattice::subtract(end, start);
    if size.contains(&0) {
        return;
    }
    let axis = (0..3).max_by_key(|&axis| (size[axis], 2 - axis)).unwrap_or(0);
    if size.iter().product::<usize>() <= LEAF || size[axis] < 3 {
        emit(start, end, nodes, order);
        return;
    }
    let middle = start[axis] + size[axis] / 2;
    let (mut left_end, mut right_start) = (end, start);
    left_end[axis] = middle;
    right_start[axis] = middle + 1;
    dissect(start, left_end, nodes, order);
    dissect(right_start, end, nodes, order);
    let (mut plane_start, mut plane_end) = (start, end);
    plane_start[axis] = middle;
    plane_end[axis] = middle + 1;
    emit(plane_start, plane_end, nodes, order);
}

fn emit(start: [usize; 3], end: [usize; 3], nodes: [usize; 3], order: &mut Vec<usize>) {
    order.extend(lattice::points(start, lattice::subtract(end, start)).map(|node| lattice::index(nodes, node)));
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_node_appears_once() {
        for nodes in [[1, 1, 1], [2, 3, 4], [8, 8, 8], [37, 2, 5]] {
            let mut order = nested_dissection(nodes);
            order.sort_unstable();
            assert_eq!(order, (0..nodes.iter().product()).collect::<Vec<_>>());
        }
    }
}
