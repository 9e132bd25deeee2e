//! Tearing of a block into s₁ × s₂ × s₃ subdomains of equal numbers of bricks.

use crate::body::mesh::Grid;
use crate::lattice;

/// One torn piece of a block.
#[derive(Debug, Clone, PartialEq)]
pub struct Subdomain {
    /// First brick along the three axes.
    pub first_cell: [usize; 3],
    /// Bricks along the three axes.
    pub cells: [usize; 3],
}

impl Subdomain {
    /// A whole body as one subdomain.
    pub fn whole(grid: &Grid) -> Self {
        Self { first_cell: [0; 3], cells: grid.cells }
    }

    /// Nodes along the three axes.
    pub fn nodes(&self) -> [usize; 3] {
        self.cells.map(|cells| cells + 1)
    }

    /// Number of nodes of the subdomain.
    pub fn node_count(&self) -> usize {
        self.nodes().iter().product()
    }

    /// Number of dofs, three per node.
    pub fn dof_count(&self) -> usize {
        3 * self.node_count()
    }

    /// Local index of local node (i, j, k).
    pub(crate) fn local_node(&self, node: [usize; 3]) -> usize {
        lattice::index(self.nodes(), node)
    }

    /// Local node (i, j, k) of a local index.
    pub fn local_position(&self, node: usize) -> [usize; 3] {
        lattice::point(self.nodes(), node)
    }

    /// Block node (i, j, k) of a local index.
    pub(crate) fn block_position(&self, node: usize) -> [usize; 3] {
        lattice::add(self.local_position(node), self.first_cell)
    }
}

/// The subdomains of one block.
#[derive(Debug, Clone)]
pub struct Tearing {
    /// Subdomains, index (i·s₂ + j)·s₃ + k.
    pub subdomains: Vec<Subdomain>,
    counts: [usize; 3],
    cells: [usize; 3],
}

impl Tearing {
    /// Tears a grid into `counts` subdomains per axis, which must divide its numbers of bricks (checked by the scene).
    pub fn new(grid: &Grid, counts: [usize; 3]) -> Self {
        let cells: [usize; 3] = std::array::from_fn(|axis| grid.cells[axis] / counts[axis]);
        let place = |[i, j, k]: [usize; 3]| [i * cells[0], j * cells[1], k * cells[2]];
        let places = lattice::points([0; 3], counts).map(place);
        Self { subdomains: places.map(|first_cell| Subdomain { first_cell, cells }).collect(), counts, cells }
    }

    /// Copies of block node (i, j, k): (subdomain, local node), in ascending order of subdomains.
    pub fn copies(&self, position: [usize; 3]) -> Vec<(usize, usize)> {
        let first: [usize; 3] = std::array::from_fn(|axis| position[axis].saturating_sub(1) / self.cells[axis]);
        let last: [usize; 3] =
            std::array::from_fn(|axis| (position[axis] / self.cells[axis]).min(self.counts[axis] - 1));
        let copy = |owner| {
            let index = lattice::index(self.counts, owner);
            let subdomain = &self.subdomains[index];
            (index, subdomain.local_node(lattice::subtract(position, subdomain.first_cell)))
        };
        lattice::points(first, lattice::subtract(lattice::add(last, [1; 3]), first)).map(copy).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn copies_of_corner_edge_face_and_inner_nodes() {
        let grid = Grid { cells: [4, 4, 4], size: [1.0, 1.0] };
        let tearing = Tearing::new(&grid, [2, 2, 2]);
        let counts = [[0, 0, 0], [2, 0, 0], [2, 2, 1], [2, 2, 2], [1, 3, 1]].map(|node| tearing.copies(node).len());
        assert_eq!(counts, [1, 2, 4, 8, 1]);
        for (subdomain, node) in tearing.copies([2, 2, 2]) {
            assert_eq!(tearing.subdomains[subdomain].block_position(node), [2, 2, 2]);
        }
    }
}
