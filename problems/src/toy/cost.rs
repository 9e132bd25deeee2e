//! The toy's cost: compliance, contact pressure, distance to a nominal shape.
//!
//! ```text
//! J(α, y) = Σᵢ [ tᵢ wᵢ − Pᵢ nᵢ + (a/2) λ_N,i² ] + (γ/2)|α − ᾱ|²
//! ∇₁J = γ(α − ᾱ),     ∇₂J = (a λ_N, 0, −P, t) per node
//! ```
//! The first two terms are the work of the loads. J is smooth in (α, y); all kinks of Θ come from S.

use super::solver::ToyState;
use nonsmooth::{Cost, CostGradient, Vector};

/// The cost J of the toy problem.
#[derive(Debug, Clone, PartialEq)]
pub struct ToyCost {
    /// Loads (P, t) of the nodes, N.
    pub loads: [(f64, f64); 2],
    /// Weight a of the squared normal forces, mm/N.
    pub pressure_weight: f64,
    /// Weight γ of the distance to the nominal shape, N/mm.
    pub shape_weight: f64,
    /// The nominal shape ᾱ, mm.
    pub nominal_shape: [f64; 2],
}

impl ToyCost {
    fn shape_offset(&self, control: &Vector) -> Vector {
        control - Vector::from_row_slice(&self.nominal_shape)
    }
}

impl Cost<ToyState> for ToyCost {
    fn value(&self, control: &Vector, state: &ToyState) -> f64 {
        let node_cost = |((press, drag), values): (&(f64, f64), super::NodeValues)| {
            drag * values.slip - press * values.height + 0.5 * self.pressure_weight * values.normal_force.powi(2)
        };
        let nodes = self.loads.iter().zip(state.nodes.iter().map(|node| node.values));
        nodes.map(node_cost).sum::<f64>() + 0.5 * self.shape_weight * self.shape_offset(control).norm_squared()
    }

    fn gradient(&self, control: &Vector, state: &ToyState) -> CostGradient {
        let node_gradient = |((press, drag), node): (&(f64, f64), &super::NodeState)| {
            [self.pressure_weight * node.values.normal_force, 0.0, -press, *drag]
        };
        CostGradient {
            control: self.shape_offset(control) * self.shape_weight,
            state: Vector::from_iterator(ToyState::LEN, self.loads.iter().zip(&state.nodes).flat_map(node_gradient)),
        }
    }
}
