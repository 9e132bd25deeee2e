//! The state map α ↦ (u, λ) of the membrane and its coderivative.
//!
//! ```text
//! A u − λ h² = b(α) = h² f(α) + boundary;     inactive I, active C:   u_C = ψ_C,  λ_I = 0
//! D*S(α)(u*, λ*) ∋ h² Σ_{I in patch} p − Σ_{C in patch} λ*,    A_II p_I = u*_I + h⁻² A_IC λ*_C
//! ```
//! λ is a density (load per area). A node on the kink, u = ψ and λ = 0, counts as inactive: for independent loads at
//! all nodes this is a limit of Jacobians nearby; for loads by patches it is an element of the set that the chain rule
//! yields.

use crate::membrane::active_set::{MembraneState, ReducedMembrane};
use crate::membrane::grid::MembraneGrid;
use contact::error::SceneError;
use contact::linear::FactorizationError;
use nonsmooth::{Accuracy, Coderivative, InputError, OracleError, Sensitivity, StateSolver, Vector};
use thiserror::Error;

/// Why there is no membrane problem.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum MembraneError {
    /// The data describe no membrane.
    #[error(transparent)]
    Data(#[from] SceneError),
    /// The matrix could not be analysed or factored.
    #[error(transparent)]
    Matrix(#[from] FactorizationError),
}

/// A function of the position.
pub type Field = Box<dyn Fn([f64; 2]) -> f64 + Send + Sync>;

/// The data of a membrane problem.
pub struct MembraneData {
    /// f₀, load per area without controls.
    pub load: Field,
    /// ψ, the height of the obstacle.
    pub obstacle: Field,
    /// g, heights of the clamped edge.
    pub boundary: Field,
    /// Patches of controlled loads per edge.
    pub patches: usize,
}

/// A membrane over an obstacle; the controls are the loads of the patches, row major with the first index along x₁.
#[derive(Debug)]
pub struct MembraneControl {
    grid: MembraneGrid,
    reduced: ReducedMembrane,
    constant: Vec<f64>,
    obstacle: Vec<f64>,
    patch_of_node: Vec<usize>,
    patches: usize,
}

impl MembraneControl {
    /// Evaluates the data on the grid and analyses the pattern.
    ///
    /// # Errors
    /// [`MembraneError::Data`] without patches and for data that are not numbers, [`MembraneError::Matrix`] when the
    /// analysis fails.
    pub fn new(grid: MembraneGrid, data: &MembraneData) -> Result<Self, MembraneError> {
        if data.patches == 0 {
            return Err(SceneError::out_of_range("patches per edge", 0, "at least 1").into());
        }
        let area = grid.width() * grid.width();
        let sums = grid.boundary_sums(&data.boundary);
        let nodes: Vec<[f64; 2]> = (0..grid.node_count()).map(|index| grid.node(index)).collect();
        let constant: Vec<f64> = nodes.iter().zip(sums).map(|(&x, sum)| area * (data.load)(x) + sum).collect();
        let obstacle: Vec<f64> = nodes.iter().map(|&x| (data.obstacle)(x)).collect();
        if let Some(value) = constant.iter().chain(&obstacle).find(|value| !value.is_finite()) {
            let field = "load, edge or obstacle of the membrane";
            return Err(SceneError::out_of_range(field, value, "finite numbers at all nodes").into());
        }
        let patch = |x: f64, axis: usize| {
            let share = (x - grid.origin[axis]) / grid.length;
            ((share * data.patches as f64) as usize).min(data.patches - 1)
        };
        let patch_of_node = nodes.iter().map(|x| patch(x[0], 0) * data.patches + patch(x[1], 1)).collect();
        let reduced = ReducedMembrane::new(&grid)?;
        Ok(Self { grid, reduced, constant, obstacle, patch_of_node, patches: data.patches })
    }

    /// The grid on which the membrane is discretized.
    pub fn grid(&self) -> &MembraneGrid {
        &self.grid
    }

    /// ψ at the inner nodes.
    pub fn obstacle(&self) -> &[f64] {
        &self.obstacle
    }

    /// b(α) = h² f(α) + boundary values, per inner node.
    ///
    /// # Errors
    /// [`InputError`] on a wrong number of controls and on entries that are not finite.
    pub fn load(&self, control: &Vector) -> Result<Vec<f64>, InputError> {
        InputError::check_vector("control", self.patches * self.patches, control)?;
        let area = self.grid.width() * self.grid.width();
        Ok(self.constant.iter().zip(&self.patch_of_node).map(|(b, &patch)| b + area * control[patch]).collect())
    }
}

impl StateSolver for MembraneControl {
    type State = MembraneState;
    type WarmStart = Vec<bool>;

    fn control_dimension(&self) -> usize {
        self.patches * self.patches
    }

    /// The exact discrete state, whatever accuracy is asked for: the method is finite.
    fn solve(
        &self,
        control: &Vector,
        start: Option<&Vec<bool>>,
        _accuracy: Accuracy,
    ) -> Result<MembraneState, OracleError> {
        let load = self.load(control)?;
        self.reduced.solve(&self.grid, &load, &self.obstacle, start.map(Vec::as_slice))
    }

    fn warm_start(&self, state: &MembraneState) -> Vec<bool> {
        state.active.clone()
    }
}

impl Coderivative for MembraneControl {
    fn coderivative(
        &self,
        _control: &Vector,
        state: &MembraneState,
        direction: &Vector,
    ) -> Result<Sensitivity, OracleError> {
        let count = self.grid.node_count();
        if direction.len() != 2 * count {
            let (expected, found) = (2 * count, direction.len());
            return Err(InputError::Dimension { what: "dual of the membrane", expected, found }.into());
        }
        let (toward, reaction) = direction.as_slice().split_at(count);
        let area = self.grid.width() * self.grid.width();
        let pressing: Vec<f64> =
            state.active.iter().zip(reaction).map(|(&active, dual)| if active { dual / area } else { 0.0 }).collect();
        let from_pressing = self.grid.multiply(&pressing);
        let mut adjoint: Vec<f64> =
            (0..count).map(|i| if state.active[i] { 0.0 } else { toward[i] + from_pressing[i] }).collect();
        state.factor.solve_in_place(&mut adjoint);
        let mut result = Vector::zeros(self.control_dimension());
        for (i, &patch) in self.patch_of_node.iter().enumerate() {
            result[patch] += area * (adjoint[i] - pressing[i]);
        }
        Ok(Sensitivity::exact(result))
    }
}
