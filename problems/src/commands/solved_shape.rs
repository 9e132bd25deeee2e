//! The objective Θ of a contact problem as the commands solve it, and shapes with their contact states.

use crate::commands::arguments::Arguments;
use crate::commands::facts::Fact;
use crate::commands::failure::Failure;
use crate::commands::limited_value::LimitedValue;
use crate::commands::numbers::plain_unit;
use contact::contact_shape::ContactState;
use contact::cost::Reported;
use contact::fields::Fields;
use contact::load_cases::CaseStates;
use contact::plausibility::Warning;
use contact::solvers::{Processes, SolverKind, Wanted};
use exchange::vtk::{Note, NoteValue};
use nonsmooth::{Accuracy, StateSolver, Vector};
use scene_file::Case;

pub use contact::contact_objective::ContactObjective;

/// Θ of a case, for single shapes.
///
/// # Errors
/// [`Failure::Input`] naming the field.
pub fn objective(case: &Case, processes: &Processes) -> Result<ContactObjective, Failure> {
    Ok(case.prepared(Wanted::States, processes)?)
}

/// What a file of fields says of the objective.
pub fn objective_note(objective: &ContactObjective, value: f64) -> Note {
    Note::new("objective", plain_unit(&objective.unit()), NoteValue::Number(value))
}

/// A shape, its states as accurate as rounding allows, and the objective there.
#[derive(Debug)]
pub struct SolvedShape {
    /// Controls of the shape, mm.
    pub controls: Vector,
    /// The contact states of the shape in all load cases.
    pub states: CaseStates,
    /// The case that is worst: the first with the largest weighted measure.
    pub worst: usize,
    /// The objective Θ at the shape.
    pub value: f64,
    /// Largest contact pressure in all cases, MPa.
    pub peak_pressure: f64,
    /// The limits with their quantities at the shape.
    pub limits: Vec<LimitedValue>,
    /// The reports with their quantities at the shape.
    pub reports: Vec<(Reported, f64)>,
}

impl SolvedShape {
    /// Solves the contact problem of a shape.
    pub fn at(objective: &ContactObjective, controls: &Vector) -> Result<Self, Failure> {
        let states = objective.cases().solve(controls, None, Accuracy::TIGHTEST)?;
        let (value, worst) = (objective.value(&states), objective.worst(&states));
        let pressures = states.iter().flat_map(|state| objective.pressures(state));
        let peak_pressure = pressures.fold(f64::NEG_INFINITY, f64::max);
        let values = objective.limited_values(controls, &states).into_iter();
        let limits = objective.limits().cloned().zip(values).map(|(limit, value)| LimitedValue { limit, value });
        let reports = objective.reported(controls, &states).into_iter();
        let reports = reports.map(|(report, value)| (report.clone(), value)).collect();
        Ok(Self { controls: controls.clone(), value, worst, peak_pressure, limits: limits.collect(), reports, states })
    }

    /// The state in the worst case, which is the only one of a scene without cases.
    pub fn state(&self) -> &ContactState {
        &self.states[self.worst]
    }

    /// Largest contact pressure in a case, MPa.
    pub fn peak_of(&self, objective: &ContactObjective, case: usize) -> f64 {
        objective.pressures(&self.states[case]).into_iter().fold(f64::NEG_INFINITY, f64::max)
    }

    /// Whether all limits are kept.
    pub fn keeps_limits(&self) -> bool {
        self.limits.iter().all(|limit| limit.excess() == 0.0)
    }

    /// The largest violation of a limit over its scale, 0 if all are kept; none without limits.
    pub fn limit_violation(&self) -> Option<f64> {
        let shares = self.limits.iter().map(|limit| limit.excess() / limit.limit.scale());
        shares.reduce(f64::max)
    }

    /// Displacements, stresses and contact fields in a case; with the sensitivity of Θ to the position of every contact
    /// node along its normal, which takes an adjoint, if it is asked for.
    pub fn fields(&self, objective: &ContactObjective, case: usize, sensitivities: bool) -> Result<Fields, Failure> {
        let mut fields = objective.cases().case(case).fields(&self.states[case])?;
        if sensitivities {
            let sensitivities = objective.position_sensitivity(&self.controls, &self.states)?;
            fields.contact.set_sensitivity(objective.solver().problem(), &sensitivities);
        }
        Ok(fields)
    }
}

/// What is implausible about a state; nothing where the checks are left out.
pub fn checks(
    objective: &ContactObjective,
    shape: &SolvedShape,
    arguments: &Arguments,
) -> Result<Vec<Warning>, Failure> {
    let mut warnings = Vec::new();
    let cases = shape.states.iter().enumerate().filter(|_| !arguments.results.no_checks);
    for (index, state) in cases {
        let (shape, name) = (objective.cases().case(index), objective.cases().name(index));
        let named = |warning: Warning| match name.is_empty() {
            true => warning,
            false => Warning { text: format!("case \"{name}\": {}", warning.text), ..warning },
        };
        warnings.extend(shape.warnings(state)?.into_iter().map(named));
    }
    Ok(warnings)
}

/// The solver of a state and why it was taken.
pub fn solver_facts(state: &ContactState) -> Result<Vec<Fact>, Failure> {
    let name = match state.solver {
        SolverKind::Direct => "direct condensation",
        SolverKind::AugmentedLagrangian => "total FETI, successive approximations",
        _ => "total FETI, semismooth Newton",
    };
    let words = state.reason.as_ref().map_or_else(|| name.into(), |reason| format!("{name}; {reason}"));
    Ok(vec![
        Fact::object("solver", "solver", &state.solver, words)?.detail(),
        Fact::json("solver_reason", &state.reason)?,
    ])
}
