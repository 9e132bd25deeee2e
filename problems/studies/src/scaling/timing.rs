//! States and subgradients of a contact solver, timed; tolerances are relative residuals.

use crate::scaling::{Adjoint, Solve, Start};
use contact::contact_shape::{AnySolver, ContactState, ContactWarmStart};
use contact::equilibrium::{ContactForces, ContactProblem};
use contact::error::ContactError;
use std::time::Instant;

/// Exponent of the paper's pressure norm.
const EXPONENT: i32 = 4;

/// One state, timed.
///
/// # Errors
/// [`ContactError`] from the solver.
pub fn solve(
    solver: &AnySolver,
    controls: &[f64],
    start: Option<&ContactWarmStart>,
    tolerance: f64,
) -> Result<(ContactState, Solve), ContactError> {
    let clock = Instant::now();
    let state = solver.solve(controls, start, tolerance)?;
    let solve = Solve {
        start: if start.is_some() { Start::Warm } else { Start::Cold },
        tolerance,
        residual: state.forces.residuals.newton,
        work: state.work(),
        objective: pressures(solver.problem(), &state.forces).map(|(pressure, _)| pressure.powi(EXPONENT)).sum(),
        seconds: clock.elapsed().as_secs_f64(),
        stages: state.stages,
    };
    Ok((state, solve))
}

/// Sensitivities of the column heights of Σσ⁴, timed.
///
/// # Errors
/// [`ContactError`] from the adjoint.
pub fn adjoint(solver: &AnySolver, state: &ContactState, tolerance: f64) -> Result<(Vec<f64>, Adjoint), ContactError> {
    let boundary = &solver.problem().boundary;
    let mut dual = vec![0.0; boundary.dual_dimension()];
    for (entry, (pressure, area)) in dual.iter_mut().zip(pressures(solver.problem(), &state.forces)) {
        *entry = f64::from(EXPONENT) * pressure.powi(EXPONENT - 1) / area;
    }
    let result = solver.sensitivities(&state.solution, &boundary.pack(&dual), tolerance)?;
    let (seconds, shape_seconds) = (result.adjoint_seconds, result.shape_seconds);
    Ok((result.heights, Adjoint { tolerance, applications: result.applications, seconds, shape_seconds }))
}

/// max(σ, 0) and area per contact node.
fn pressures(problem: &ContactProblem, forces: &ContactForces) -> impl Iterator<Item = (f64, f64)> {
    forces.normal.iter().zip(&problem.boundary.points).map(|(force, point)| ((force / point.area).max(0.0), point.area))
}
