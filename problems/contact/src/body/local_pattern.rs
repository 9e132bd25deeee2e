//! What all subdomains of one size share: sparsity, scatter of element matrices, elimination order, fixing nodes.

use crate::body::elasticity::Material;
use crate::body::elasticity::brick::{DOFS, Nodes};
use crate::body::elasticity::hex8;
use crate::body::mesh::Subdomain;
use crate::lattice;
use crate::linear::FactorizationError;
use crate::linear::cholesky::SymbolicFactor;
use crate::linear::ordering::nested_dissection;
use crate::linear::symmetric::LowerPattern;
use std::sync::Arc;

/// Pattern and scatter map of a box of bricks.
#[derive(Debug)]
pub struct LocalPattern {
    /// A subdomain of this size at the origin.
    pub shape: Subdomain,
    /// Lower triangle of the stiffness matrix.
    pub pattern: Arc<LowerPattern>,
    /// Position of the lower entries (300 per brick) in the value array.
    scatter: Vec<u32>,
}

impl LocalPattern {
    /// The pattern of a box of `cells` bricks; `coupled` lists local nodes whose dofs are all coupled with each other
    /// in addition (the fixing nodes).
    pub fn new(cells: [usize; 3], coupled: &[usize]) -> Self {
        let shape = Subdomain { first_cell: [0; 3], cells };
        let nodes = shape.nodes();
        let mut columns = vec![Vec::new(); shape.dof_count()];
        let mut couple = |first: usize, second: usize| {
            for column in 3 * first..3 * first + 3 {
                columns[column].extend((3 * second..3 * second + 3).filter(|&row| row >= column));
            }
        };
        for node in 0..shape.node_count() {
            let position = shape.local_position(node);
            let start = position.map(|index| index.saturating_sub(1));
            let end: [usize; 3] = std::array::from_fn(|axis| (position[axis] + 2).min(nodes[axis]));
            for neighbour in lattice::points(start, lattice::subtract(end, start)) {
                couple(node, shape.local_node(neighbour));
            }
        }
        for &first in coupled {
            for &second in coupled {
                couple(first, second);
            }
        }
        let pattern = Arc::new(LowerPattern::from_columns(columns));
        let mut local = Self { shape, pattern, scatter: Vec::new() };
        local.scatter = local.bricks().flat_map(|brick| local.brick_positions(brick)).collect();
        local
    }

    /// Mean of the diagonal of a matrix, given by its values.
    pub(crate) fn mean_diagonal(&self, values: &[f64]) -> f64 {
        let (starts, dimension) = (self.pattern.starts(), self.pattern.dimension());
        (0..dimension).map(|column| values[starts[column]]).sum::<f64>() / dimension as f64
    }

    /// Local bricks (i, j, k) in the order of the scatter map.
    pub fn bricks(&self) -> impl Iterator<Item = [usize; 3]> + use<> {
        lattice::points([0; 3], self.shape.cells)
    }

    /// Local dofs of a brick in the order of [`hex8`].
    pub fn brick_dofs(&self, brick: [usize; 3]) -> [usize; DOFS] {
        let corners = lattice::corners(brick);
        std::array::from_fn(|dof| 3 * self.shape.local_node(corners[dof / 3]) + dof % 3)
    }

    fn brick_positions(&self, brick: [usize; 3]) -> Vec<u32> {
        let dofs = self.brick_dofs(brick);
        let mut positions = Vec::with_capacity(DOFS * (DOFS + 1) / 2);
        for row in 0..DOFS {
            for column in 0..=row {
                let (upper, lower) = (dofs[row].max(dofs[column]), dofs[row].min(dofs[column]));
                let position = self.pattern.position(upper, lower).expect("invariant: brick dofs are coupled");
                positions.push(u32::try_from(position).expect("invariant: fewer than 2³² entries"));
            }
        }
        positions
    }

    /// Values of the stiffness matrix for bricks with coordinates `nodes(local brick)`.
    pub fn assemble(&self, material: &Material, nodes: impl Fn([usize; 3]) -> Nodes<f64>) -> Vec<f64> {
        let mut values = vec![0.0; self.pattern.entry_count()];
        let per_brick = DOFS * (DOFS + 1) / 2;
        for (brick, positions) in self.bricks().zip(self.scatter.chunks_exact(per_brick)) {
            let matrix = hex8::stiffness(&nodes(brick), material);
            let mut position = positions.iter();
            for (row, entries) in matrix.iter().enumerate() {
                for (entry, &position) in entries[..=row].iter().zip(position.by_ref().take(row + 1)) {
                    values[position as usize] += entry;
                }
            }
        }
        values
    }

    /// Elimination order by nested dissection, with the dofs of `last` nodes moved to the end.
    pub fn elimination_order(&self, last: &[usize]) -> Vec<usize> {
        let nodes = nested_dissection(self.shape.nodes());
        let kept = nodes.into_iter().filter(|node| !last.contains(node));
        kept.chain(last.iter().copied()).flat_map(|node| 3 * node..3 * node + 3).collect()
    }

    /// Symbolic factor for [`Self::elimination_order`].
    ///
    /// # Errors
    /// [`FactorizationError`] when the analysis fails.
    pub fn symbolic(&self, last: &[usize]) -> Result<Arc<SymbolicFactor>, FactorizationError> {
        Ok(Arc::new(SymbolicFactor::new(Arc::clone(&self.pattern), self.elimination_order(last))?))
    }
}

/// Three corners of a box of `cells` bricks that span a large triangle: enough to hold all rigid motions.
pub(crate) fn fixing_nodes(cells: [usize; 3]) -> [usize; 3] {
    let shape = Subdomain { first_cell: [0; 3], cells };
    let [c1, c2, c3] = cells;
    [shape.local_node([0, 0, 0]), shape.local_node([c1, c2, 0]), shape.local_node([c1, 0, c3])]
}
