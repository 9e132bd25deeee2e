//! Coordinates of the nodes in which supports hold axes: oblique supports become held dofs.
//!
//! ```text
//! û = Q u,   f̂ = Q f,   K̂ = Q K Qᵀ         Q: orthogonal, node by node; I where supports hold axes or nothing
//! ```

use crate::body::{Body, Piece};
use crate::linear::symmetric::LowerPattern;

/// The coordinates of the nodes of a piece.
#[derive(Debug, PartialEq)]
pub struct NodalAxes {
    /// Whether supports hold a dof in these coordinates.
    pub held: Vec<bool>,
    /// The rows of Q of every node whose coordinates are not the axes.
    turned: Vec<Option<[[f64; 3]; 3]>>,
}

impl NodalAxes {
    /// The coordinates that the supports of a body ask for.
    pub fn new(body: &Body, piece: &Piece) -> Self {
        let mut held = vec![false; piece.dof_count()];
        let mut turned = vec![None; piece.nodes.len()];
        for (place, &node) in piece.nodes.iter().enumerate() {
            let directions = body.held(node);
            let axes: Vec<Option<usize>> = directions.iter().map(axis_of).collect();
            if axes.contains(&None) {
                let mut rows = directions.to_vec();
                rows.extend(body.free(node));
                turned[place] = Some([rows[0], rows[1], rows[2]]);
                held[3 * place..3 * place + directions.len()].fill(true);
            } else {
                axes.iter().flatten().for_each(|axis| held[3 * place + axis] = true);
            }
        }
        Self { held, turned }
    }

    /// The displacements that supports prescribe to the nodes of a piece, in these coordinates, mm; 0 at free dofs.
    pub fn lift(&self, piece: &Piece, prescribed: impl Fn(u32) -> [f64; 3]) -> Vec<f64> {
        let mut lift: Vec<f64> = piece.nodes.iter().flat_map(|&node| prescribed(node)).collect();
        self.turn(&mut lift);
        lift.iter_mut().zip(&self.held).filter(|(_, held)| !**held).for_each(|(value, _)| *value = 0.0);
        lift
    }

    /// A vector at a node in its coordinates.
    pub fn turn_at(&self, node: usize, vector: [f64; 3]) -> [f64; 3] {
        self.turned[node].map_or(vector, |rows| rows.map(|row| (0..3).map(|axis| row[axis] * vector[axis]).sum()))
    }

    /// Q v in place.
    pub fn turn(&self, values: &mut [f64]) {
        for (node, value) in values.as_chunks_mut::<3>().0.iter_mut().enumerate() {
            *value = self.turn_at(node, *value);
        }
    }

    /// A vector at a node along the axes, from its coordinates.
    pub fn turn_back_at(&self, node: usize, vector: [f64; 3]) -> [f64; 3] {
        let along =
            |rows: [[f64; 3]; 3]| std::array::from_fn(|axis| (0..3).map(|row| rows[row][axis] * vector[row]).sum());
        self.turned[node].map_or(vector, along)
    }

    /// Qᵀ v in place.
    pub fn turn_back(&self, values: &mut [f64]) {
        for (node, value) in values.as_chunks_mut::<3>().0.iter_mut().enumerate() {
            *value = self.turn_back_at(node, *value);
        }
    }

    /// Q K Qᵀ in place, for the lower values of K.
    pub fn turn_matrix(&self, lower: &LowerPattern, values: &mut [f64]) {
        if self.turned.iter().all(Option::is_none) {
            return;
        }
        let (starts, rows) = (lower.starts(), lower.rows());
        for column in 0..lower.dimension() {
            // Blocks below the diagonal one have all three rows of their node.
            let mut place = starts[column] + 3 - column % 3;
            while place < starts[column + 1] {
                let turned = self.turn_at(rows[place] / 3, [values[place], values[place + 1], values[place + 2]]);
                values[place..place + 3].copy_from_slice(&turned);
                place += 3;
            }
        }
        for (node, q) in self.turned.iter().enumerate() {
            let Some(q) = q else { continue };
            let first: [usize; 3] = std::array::from_fn(|axis| starts[3 * node + axis] + 3 - axis);
            for offset in 0..starts[3 * node + 1] - first[0] {
                let places = first.map(|first| first + offset);
                let turned = self.turn_at(node, places.map(|place| values[place]));
                (0..3).for_each(|axis| values[places[axis]] = turned[axis]);
            }
            let place = |row: usize, column: usize| {
                let (row, column) = (row.max(column), row.min(column));
                starts[3 * node + column] + row - column
            };
            let block: [[f64; 3]; 3] = std::array::from_fn(|i| std::array::from_fn(|j| values[place(i, j)]));
            for row in 0..3 {
                for column in 0..=row {
                    let terms = (0..3).flat_map(|i| (0..3).map(move |j| (i, j)));
                    values[place(row, column)] = terms.map(|(i, j)| q[row][i] * block[i][j] * q[column][j]).sum();
                }
            }
        }
    }
}

/// The axis that a direction is.
fn axis_of(direction: &[f64; 3]) -> Option<usize> {
    (0..3).find(|&axis| direction[axis] == 1.0)
}
