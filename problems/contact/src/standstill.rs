//! Why an optimization ended where it began.

use crate::contact_objective::ContactObjective;
use crate::equilibrium::ContactStatus;
use crate::load_cases::CaseStates;
use crate::plausibility::Warning;
use nonsmooth::{OracleError, Report, Termination, Vector};

/// Change of Θ over the first step, relative to Θ, up to which the derivative at a shape is rounding.
const FLAT: f64 = 1e-9;
/// Distance of Θ from its least value, relative to Θ, that is rounding.
const LEAST: f64 = 1e-9;

/// Why Θ is constant without loads.
const IDLE: &str = "nothing loads the bodies; give loads to the scene";

/// A warning about runs that gained no more than rounding because Θ is constant there, or at its least value; none for
/// all other runs. `start` and `end` are the controls at the ends of the last run, with the state at `end`.
///
/// # Errors
/// [`OracleError`] of the adjoint.
pub fn standstill<'r>(
    reports: impl IntoIterator<Item = &'r Report>,
    objective: &ContactObjective,
    start: &Vector,
    end: (&Vector, &CaseStates),
) -> Result<Option<Warning>, OracleError> {
    let stood_still = |report: &Report| {
        let termination = &report.termination;
        let is_end = termination.is_stationary()
            || matches!(termination, Termination::NoiseLimit { .. } | Termination::StepTooShort { .. });
        is_end && report.start_value - report.value <= FLAT * report.start_value.abs()
    };
    if !reports.into_iter().all(stood_still) {
        return Ok(None);
    }
    let (controls, states) = end;
    let value = objective.value(states);
    // Without loads, what is left of forces is rounding of the gaps.
    let idle = (0..objective.cases().count()).all(|case| objective.cases().case(case).problem().load() == 0.0);
    let slope = objective.differentiate(controls, states)?.subgradient.lp_norm(1);
    let is_flat = idle || slope * objective.first_step(start) <= FLAT * value.abs();
    let flat = |reason: String| Warning {
        code: "flat-objective",
        text: format!("the objective does not change with the shape where the run begins: {reason}"),
    };
    let known = if idle { Some(IDLE.into()) } else { why_flat(objective, states) };
    if let Some(reason) = known.filter(|_| is_flat) {
        return Ok(Some(flat(reason)));
    }
    // At its least value, Θ is flat too where it is smooth.
    let least = objective.lower_bound(states);
    let least = least.filter(|least| value - least <= LEAST * value.abs()).map(|least| Warning {
        code: "least-objective",
        text: format!("the run begins at the least value that any shape has with this total force, {least:.4e}: nothing is to be gained"),
    });
    let unknown = "its derivative is zero; begin at another shape (--start-controls, --starts)";
    Ok(least.or_else(|| is_flat.then(|| flat(unknown.into()))))
}

/// Why Θ does not change near some states, where more is known than that its derivative is zero.
fn why_flat(objective: &ContactObjective, states: &CaseStates) -> Option<String> {
    let mut status = states.iter().flat_map(|state| &state.forces.status);
    if status.all(|status| *status == ContactStatus::Open) {
        let reason = "the bodies do not touch there; bring them together by loads, the start or the counter surface";
        return Some(reason.into());
    }
    objective.why_flat(states)
}
