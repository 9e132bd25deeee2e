//! Functions of a contact state that are smooth near it: values and derivatives.
//!
//! ```text
//! dJ/dα = Σ ∂J/∂λ · λ′ + Σ ∂J/∂u · u′ + Σ ∂J/∂x · x′           λ′, u′: tangents, x′: velocities of the nodes
//! ```
//! A point of a maximum depends on the nodes of one cell, or on one node, so that a row of the Jacobian costs some
//! twenty products per control and no adjoint system.

use crate::equilibrium::{ContactProblem, Tangents};
use crate::shape::Velocities;
use nonsmooth::{CostGradient, Vector};

/// The derivatives of a function of a contact state.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct StateGradient {
    /// ∂J/∂λ of every packed contact row, unit of J per N; empty for 0.
    pub forces: Vec<f64>,
    /// ∂J/∂u, three entries per node of every body, unit of J per mm; empty for 0.
    pub displacements: Vec<f64>,
    /// ∂J/∂x per point of every body at fixed forces and displacements, unit of J per mm; 0 for points that no control
    /// moves, empty for 0.
    pub positions: Vec<[f64; 3]>,
}

/// A function that is smooth near a state, by its value and its nonzero derivatives there.
#[derive(Debug, Clone, PartialEq)]
pub struct StatePiece {
    /// The value.
    pub value: f64,
    /// ∂J/∂u, unit of J per mm, by the index 3·node + axis over the nodes of all bodies.
    pub displacements: Vec<(usize, f64)>,
    /// ∂J/∂x at fixed displacements, unit of J per mm, by the numbers of the points that some control moves among those
    /// of all bodies.
    pub positions: Vec<(usize, [f64; 3])>,
}

impl StateGradient {
    /// The derivatives by the controls at a fixed state and by the state at fixed controls: what the coderivative is
    /// asked for. The displacements are part of the state where J depends on them.
    pub fn pulled(self, problem: &ContactProblem) -> CostGradient {
        let control = problem.map.pull_back(&self.positions);
        let mut state = self.forces;
        state.resize(problem.boundary.row_count, 0.0);
        state.extend(self.displacements);
        CostGradient { control: Vector::from_vec(control), state: Vector::from_vec(state) }
    }
}

impl StatePiece {
    /// The derivatives over all displacements and over all points.
    pub fn gradient(&self, problem: &ContactProblem) -> StateGradient {
        let (mut displacements, mut positions) = (vec![0.0; problem.displacement_count()], problem.no_sensitivities());
        self.displacements.iter().for_each(|&(index, entry)| displacements[index] += entry);
        for &(node, entry) in &self.positions {
            (0..3).for_each(|axis| positions[node][axis] += entry[axis]);
        }
        StateGradient { forces: Vec::new(), displacements, positions }
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
