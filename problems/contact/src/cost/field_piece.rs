//! One smooth function of the displacements at a state: its value and its sparse derivative.
//!
//! ```text
//! J = max over points of J_k(x, u):     dJ_k/dα = Σ ∂J_k/∂u · u′ + Σ ∂J_k/∂x · x′      u′: tangents, x′: velocities of the nodes
//! ```
//! A point depends on the nodes of one cell, or on one node, so that a row of the Jacobian costs some twenty products
//! per control and no adjoint system.

use crate::equilibrium::Tangents;
use crate::shape::Velocities;

/// The derivatives of a function of the displacements at a state.
#[derive(Debug, Clone, PartialEq)]
pub struct FieldGradient {
    /// ∂J/∂u, three entries per node of every body, unit of J per mm.
    pub displacements: Vec<f64>,
    /// ∂J/∂x per node of every body at fixed displacements, unit of J per mm; 0 for nodes that no control moves.
    pub positions: Vec<[f64; 3]>,
}

/// A function that is smooth near a state, by its value and its nonzero derivatives there.
#[derive(Debug, Clone, PartialEq)]
pub struct FieldPiece {
    /// The value.
    pub value: f64,
    /// ∂J/∂u, unit of J per mm, by the index 3·node + axis over the nodes of all bodies.
    pub displacements: Vec<(usize, f64)>,
    /// ∂J/∂x at fixed displacements, unit of J per mm, by the numbers of the nodes that some control moves among those
    /// of all bodies.
    pub positions: Vec<(usize, [f64; 3])>,
}

impl FieldPiece {
    /// The piece of a function with a given value and gradient.
    pub(super) fn of(value: f64, gradient: &FieldGradient) -> Self {
        let displacements = gradient.displacements.iter().copied().enumerate().filter(|(_, entry)| *entry != 0.0);
        let positions = gradient.positions.iter().copied().enumerate().filter(|(_, entry)| *entry != [0.0; 3]);
        Self { value, displacements: displacements.collect(), positions: positions.collect() }
    }

    /// The derivatives over all displacements and over all nodes.
    pub fn gradient(&self, node_count: usize) -> FieldGradient {
        let mut gradient =
            FieldGradient { displacements: vec![0.0; 3 * node_count], positions: vec![[0.0; 3]; node_count] };
        self.displacements.iter().for_each(|&(index, entry)| gradient.displacements[index] += entry);
        for &(node, entry) in &self.positions {
            (0..3).for_each(|axis| gradient.positions[node][axis] += entry[axis]);
        }
        gradient
    }

    /// The total derivative along every change of the controls that tangents with displacements and velocities of the
    /// nodes belong to, unit of J per unit of the change. Tangents without displacements give no numbers.
    pub fn row(&self, tangents: &Tangents, velocities: &Velocities<'_>) -> Vec<f64> {
        let Some(displacements) = &tangents.displacements else { return vec![f64::NAN; velocities.count()] };
        let of_state = |u: &Vec<f64>| self.displacements.iter().map(|(index, entry)| entry * u[*index]).sum();
        let mut row: Vec<f64> = displacements.iter().map(of_state).collect();
        for (node, entry) in &self.positions {
            for (column, velocity) in velocities.of_numbers(std::iter::once(*node)) {
                row[column] += (0..3).map(|axis| entry[axis] * velocity[axis]).sum::<f64>();
            }
        }
        row
    }
}
