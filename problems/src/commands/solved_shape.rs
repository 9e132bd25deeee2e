//! A shape with its contact state.

use crate::commands::contact_objective::ContactObjective;
use crate::commands::failure::Failure;
use contact::contact_shape::ContactState;
use nonsmooth::{Accuracy, Cost, StateSolver, Vector};

/// A shape, its state as accurate as rounding allows, and the objective there.
#[derive(Debug)]
pub struct SolvedShape {
    /// Control heights, mm.
    pub controls: Vector,
    /// The contact state.
    pub state: ContactState,
    /// Θ.
    pub value: f64,
    /// Largest contact pressure, MPa.
    pub peak_pressure: f64,
}

impl SolvedShape {
    /// Solves the contact problem of a shape.
    ///
    /// # Errors
    /// [`Failure`] of the contact solver.
    pub fn at(objective: &ContactObjective, controls: &Vector) -> Result<Self, Failure> {
        let state = objective.solver().solve(controls, None, Accuracy::TIGHTEST)?;
        let value = objective.cost().value(controls, &state);
        let peak_pressure = objective.cost().pressures(&state).into_iter().fold(f64::NEG_INFINITY, f64::max);
        Ok(Self { controls: controls.clone(), state, value, peak_pressure })
    }
}
