//! The cost of a membrane: its distance from a wanted shape, its load and the pressure on the obstacle.
//!
//! ```text
//! J(α, u, λ) = ½ h² Σ (u − u_d)² + (ν/2) w Σ α_k² + κ h² Σ λ          w: area of a patch
//! ```

use crate::membrane::active_set::MembraneState;
use crate::membrane::grid::MembraneGrid;
use nonsmooth::{Cost, CostGradient, Vector};

/// The cost J of the membrane.
#[derive(Debug, Clone)]
pub struct MembraneCost {
    wanted: Vec<f64>,
    area: f64,
    total: f64,
    load_weight: f64,
    reaction_weight: f64,
}

impl MembraneCost {
    /// The cost with a wanted shape u_d, the weight ν of the load and the weight κ of the reaction.
    pub fn new(grid: &MembraneGrid, wanted: impl Fn([f64; 2]) -> f64, load_weight: f64, reaction_weight: f64) -> Self {
        let wanted = (0..grid.node_count()).map(|index| wanted(grid.node(index))).collect();
        let (area, total) = (grid.width() * grid.width(), grid.length * grid.length);
        Self { wanted, area, total, load_weight, reaction_weight }
    }
}

impl Cost<MembraneState> for MembraneCost {
    fn value(&self, control: &Vector, state: &MembraneState) -> f64 {
        let off: f64 = state.displacement.iter().zip(&self.wanted).map(|(u, wanted)| (u - wanted).powi(2)).sum();
        let patch = self.total / control.len() as f64;
        0.5 * self.area * off
            + 0.5 * self.load_weight * patch * control.norm_squared()
            + self.reaction_weight * self.area * state.reaction.iter().sum::<f64>()
    }

    fn gradient(&self, control: &Vector, state: &MembraneState) -> CostGradient {
        let count = self.wanted.len();
        let toward = Vector::from_fn(2 * count, |i, _| match i.checked_sub(count) {
            None => self.area * (state.displacement[i] - self.wanted[i]),
            Some(_) => self.reaction_weight * self.area,
        });
        let patch = self.total / control.len() as f64;
        CostGradient { control: control * (self.load_weight * patch), state: toward }
    }
}
