//! Tearing of a block into s₁ × s₂ × s₃ subdomains of equal numbers of bricks.

use crate::body::mesh::Grid;

/// One torn piece of a block.
#[derive(Debug, Clone, PartialEq)]
pub struct Subdomain {
    /// First brick along the three axes.
    pub first_cell: [usize; 3],
    /// Bricks along the three axes.
    pub cells: [usize; 3],
}

impl Subdomain {
    /// Nodes along the three axes.
    pub fn nodes(&self) -> [usize; 3] {
        self.cells.map(|cells| cells + 1)
    }

    /// Number of nodes.
    pub fn node_count(&self) -> usize {
        self.nodes().iter().product()
    }

    /// Number of dofs, three per node.
    pub fn dof_count(&self) -> usize {
        3 * self.node_count()
    }

    /// Local index of local node (i, j, k).
    pub fn local_node(&self, [i, j, k]: [usize; 3]) -> usize {
        (i * (self.cells[1] + 1) + j) * (self.cells[2] + 1) + k
    }

    /// Local node (i, j, k) of a local index.
    pub fn local_position(&self, node: usize) -> [usize; 3] {
        let [_, n2, n3] = self.nodes();
        [node / (n2 * n3), node / n3 % n2, node % n3]
    }

    /// Block node (i, j, k) of a local index.
    pub fn block_position(&self, node: usize) -> [usize; 3] {
        let local = self.local_position(node);
        std::array::from_fn(|axis| local[axis] + self.first_cell[axis])
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
        let mut subdomains = Vec::with_capacity(counts.iter().product());
        for i in 0..counts[0] {
            for j in 0..counts[1] {
                for k in 0..counts[2] {
                    subdomains.push(Subdomain { first_cell: [i * cells[0], j * cells[1], k * cells[2]], cells });
                }
            }
        }
        Self { subdomains, counts, cells }
    }

    /// Copies of block node (i, j, k): (subdomain, local node), in ascending order of subdomains.
    pub fn copies(&self, position: [usize; 3]) -> Vec<(usize, usize)> {
        let owners: [Vec<usize>; 3] = std::array::from_fn(|axis| {
            let (index, width) = (position[axis], self.cells[axis]);
            let right = index / width;
            let mut owners = Vec::with_capacity(2);
            if index % width == 0 && right > 0 {
                owners.push(right - 1);
            }
            if right < self.counts[axis] {
                owners.push(right);
            }
            owners
        });
        let mut copies = Vec::with_capacity(8);
        for &i in &owners[0] {
            for &j in &owners[1] {
                for &k in &owners[2] {
                    let index = (i * self.counts[1] + j) * self.counts[2] + k;
                    let first = self.subdomains[index].first_cell;
                    let local: [usize; 3] = std::array::from_fn(|axis| position[axis] - first[axis]);
                    copies.push((index, self.subdomains[index].local_node(local)));
                }
            }
        }
        copies
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
