//! Why an optimization ended where it began.

use crate::commands::failure::Failure;
use crate::commands::numbers::number;
use crate::commands::optimize::mesh_run::MeshRun;
use crate::commands::solved_shape::{ContactObjective, SolvedShape};
use contact::plausibility::Warning;
use nonsmooth::Termination;

/// Change of Θ over the first step, relative to Θ, up to which the derivative at a shape is rounding.
const FLAT: f64 = 1e-9;
/// Distance of Θ from its least value, relative to Θ, that is rounding.
const LEAST: f64 = 1e-9;

/// A warning about runs that gained no more than rounding because Θ is constant there, or at its least value; none for all other runs.
///
/// # Errors
/// [`Failure`] of the adjoint.
pub fn standstill(runs: &[MeshRun], last: &MeshRun, shape: &SolvedShape) -> Result<Option<Warning>, Failure> {
    let stood_still = |run: &MeshRun| {
        let word = &run.report.termination;
        let is_end =
            word.is_stationary() || matches!(word, Termination::NoiseLimit { .. } | Termination::StepTooShort { .. });
        let gained = run.report.start_value - run.report.value;
        is_end && gained <= FLAT * run.report.start_value.abs()
    };
    if !runs.iter().all(stood_still) {
        return Ok(None);
    }
    let objective = &last.objective;
    // Without loads, what is left of forces is rounding of the gaps.
    let idle = objective.solver().problem().scene.load() == 0.0;
    let slope = objective.differentiate(&shape.controls, &shape.state)?.subgradient.lp_norm(1);
    let step = objective.first_step(&last.initial_controls);
    if idle || slope * step <= FLAT * shape.value.abs() {
        let reason =
            if idle { "nothing loads the bodies; give loads to the scene".into() } else { why_flat(objective, shape) };
        let text = format!("the objective does not change with the shape where the run begins: {reason}");
        return Ok(Some(Warning { code: "flat-objective", text }));
    }
    let force = shape.state.forces.total_normal_force();
    let least = objective.lower_bound(force).filter(|least| shape.value - least <= LEAST * shape.value.abs());
    Ok(least.map(|least| Warning {
        code: "least-objective",
        text: format!(
            "the run begins at the least value that any shape has with this total force, {}: nothing is to be gained",
            number(least)
        ),
    }))
}

fn why_flat(objective: &ContactObjective, shape: &SolvedShape) -> String {
    let known = match objective {
        ContactObjective::Pressure(objective) => objective.cost().why_flat(&shape.state),
        ContactObjective::Field(_) => None,
    };
    known.unwrap_or_else(|| "its derivative is zero; begin at another shape (--start-controls, --starts)".into())
}
