//! The objective Θ of a contact problem as the commands solve it, and shapes with their contact states.

use crate::commands::arguments::Arguments;
use crate::commands::facts::Fact;
use crate::commands::failure::Failure;
use crate::commands::limited_value::LimitedValue;
use crate::commands::numbers::plain_unit;
use contact::communication::InProcess;
use contact::contact_objective::ContactCost;
use contact::contact_shape::{ContactShape, ContactState};
use contact::equilibrium::ContactProblem;
use contact::error::SceneError;
use contact::fields::Fields;
use contact::memory;
use contact::plausibility::Warning;
use contact::solvers::{Processes, SolverKind, Wanted};
use exchange::vtk::{Note, NoteValue};
use nonsmooth::{Accuracy, StateSolver, Vector};
use scene_file::{Case, MethodName};

pub use contact::contact_objective::ContactObjective;

/// Θ of a case, for single shapes.
///
/// # Errors
/// [`Failure::Input`] naming the field.
pub fn objective(case: &Case, processes: &Processes) -> Result<ContactObjective, Failure> {
    objective_for(case, Wanted::States, processes)
}

/// Θ of a case, for its optimization.
///
/// # Errors
/// [`Failure::Input`] naming the field.
pub fn optimized_objective(case: &Case, processes: &Processes) -> Result<ContactObjective, Failure> {
    objective_for(case, wanted(case), processes)
}

/// What an optimization of a case asks of the contact solver.
pub fn wanted(case: &Case) -> Wanted {
    match case.method {
        MethodName::Composite => Wanted::Jacobians,
        MethodName::Bundle => Wanted::States,
    }
}

fn objective_for(case: &Case, wanted: Wanted, processes: &Processes) -> Result<ContactObjective, Failure> {
    let shape = ContactShape::by(processes.solver(case.plan(wanted))?);
    let measure = case.measure(shape.problem())?;
    Ok(ContactObjective::new(shape, measure, &case.limits)?)
}

/// Refuses a case that needs more memory than there is, or whose objective has no value on its mesh, without preparing
/// a solver for it. What each of several processes needs is looked at when they begin the case.
///
/// # Errors
/// [`SceneError`] naming the field.
pub fn check_ahead(case: &Case, wanted: Wanted, processes: &Processes) -> Result<(), SceneError> {
    if processes.is_alone() {
        memory::check(&case.plan(wanted), &InProcess)?;
    }
    let problem = ContactProblem::new(case.scene.clone())?;
    ContactCost::new(case.measure(&problem)?, &case.limits, &problem).map(|_| ())
}

/// What a file of fields says of the objective.
pub fn objective_note(objective: &ContactObjective, value: f64) -> Note {
    Note::new("objective", plain_unit(&objective.unit()), NoteValue::Number(value))
}

/// A shape, its state as accurate as rounding allows, and the objective there.
#[derive(Debug)]
pub struct SolvedShape {
    /// Controls of the shape, mm.
    pub controls: Vector,
    /// The contact state of the shape.
    pub state: ContactState,
    /// The objective Θ at the shape.
    pub value: f64,
    /// Largest contact pressure, MPa.
    pub peak_pressure: f64,
    /// The limits with their quantities at the shape.
    pub limits: Vec<LimitedValue>,
}

impl SolvedShape {
    /// Solves the contact problem of a shape.
    pub fn at(objective: &ContactObjective, controls: &Vector) -> Result<Self, Failure> {
        let state = objective.solver().solve(controls, None, Accuracy::TIGHTEST)?;
        let value = objective.value(controls, &state);
        let peak_pressure = objective.pressures(&state).into_iter().fold(f64::NEG_INFINITY, f64::max);
        let values = objective.limited_values(controls, &state).into_iter();
        let limits =
            objective.limits().iter().zip(values).map(|(&limit, value)| LimitedValue { limit, value }).collect();
        Ok(Self { controls: controls.clone(), state, value, peak_pressure, limits })
    }

    /// Whether all limits are kept.
    pub fn keeps_limits(&self) -> bool {
        self.limits.iter().all(|limit| limit.excess() == 0.0)
    }

    /// The largest violation of a limit over its bound, 0 if all are kept; none without limits.
    pub fn limit_violation(&self) -> Option<f64> {
        let shares = self.limits.iter().map(|limit| limit.excess() / limit.limit.bound.abs());
        shares.reduce(f64::max)
    }

    /// Displacements, stresses and contact fields; with the sensitivity of Θ to the position of every contact node
    /// along its normal, which takes an adjoint, if it is asked for.
    pub fn fields(&self, objective: &ContactObjective, sensitivities: bool) -> Result<Fields, Failure> {
        let mut fields = objective.solver().fields(&self.state)?;
        if sensitivities {
            fields.contact.set_sensitivity(&objective.position_sensitivity(&self.controls, &self.state)?);
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
    if arguments.results.no_checks { Ok(Vec::new()) } else { Ok(objective.solver().warnings(&shape.state)?) }
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
