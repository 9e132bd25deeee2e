//! The objective Θ of a contact problem, and shapes with their contact states.

use crate::commands::arguments::Arguments;
use crate::commands::failure::Failure;
use crate::commands::processes::{Processes, SharedSolver, SharedState};
use contact::contact_shape::{ContactShape, ContactState, ContactWarmStart, Wanted};
use contact::cost::{ContactAreas, FieldCost, Measure, PressureCost};
use contact::equilibrium::ContactProblem;
use contact::error::SceneError;
use contact::fields::Fields;
use contact::plausibility::Warning;
use nonsmooth::composite::OuterFunction;
use nonsmooth::{
    Accuracy, Answer, CompositeObjective, Cost, CostGradient, Evaluation, NonsmoothObjective, OracleError,
    OutputJacobian, ReducedObjective, Request, StateSolver, Vector,
};
use scene_file::{Case, MethodName};

/// Θ of a scene: a measure of the contact state that the control heights lead to. Where Σσ^p may lie outside the range of doubles, Θ is
/// its p-th root.
#[derive(Debug)]
pub enum ContactObjective {
    /// A convex function of the contact pressures.
    Pressure(CompositeObjective<ContactShape<SharedSolver>, PressureCost>),
    /// A function of the displacements, which has no composite model.
    Field(ReducedObjective<ContactShape<SharedSolver>, FieldCost>),
}

impl ContactObjective {
    /// The map from control heights to contact states.
    pub fn solver(&self) -> &ContactShape<SharedSolver> {
        match self {
            Self::Pressure(objective) => objective.solver(),
            Self::Field(objective) => objective.solver(),
        }
    }

    /// Θ at a state already found.
    pub fn value(&self, control: &Vector, state: &ContactState<SharedState>) -> f64 {
        match self {
            Self::Pressure(objective) => Cost::value(objective.cost(), control, state),
            Self::Field(objective) => objective.cost().value(control, state),
        }
    }

    /// The partial gradients of the cost at a state.
    pub fn gradient(&self, control: &Vector, state: &ContactState<SharedState>) -> CostGradient {
        match self {
            Self::Pressure(objective) => objective.cost().gradient(control, state),
            Self::Field(objective) => objective.cost().gradient(control, state),
        }
    }

    /// Θ and one subgradient at a state already found.
    ///
    /// # Errors
    /// As [`ReducedObjective::differentiate`].
    pub fn differentiate(
        &self,
        control: &Vector,
        state: &ContactState<SharedState>,
    ) -> Result<Evaluation<ContactWarmStart>, OracleError> {
        match self {
            Self::Pressure(objective) => objective.reduced().differentiate(control, state),
            Self::Field(objective) => objective.differentiate(control, state),
        }
    }

    /// The derivative of Θ by the height of every contact node, unit of Θ per mm.
    ///
    /// # Errors
    /// As [`ContactShape::height_sensitivity`].
    pub fn height_sensitivity(&self, shape: &SolvedShape) -> Result<Vec<f64>, OracleError> {
        let SolvedShape { controls, state, .. } = shape;
        let mut heights = self.solver().height_sensitivity(state, &self.gradient(controls, state).state)?.0;
        // At fixed displacements, costs of the pressures do not depend on the shape.
        if let (Self::Field(objective), Some(bodies)) = (self, &state.bodies) {
            let direct = objective.cost().gradient_of(bodies).heights;
            heights.iter_mut().zip(direct).for_each(|(height, direct)| *height += direct);
        }
        Ok(heights)
    }

    /// σ per contact node, MPa.
    pub fn pressures(&self, state: &ContactState<SharedState>) -> Vec<f64> {
        self.solver().outputs(state).as_slice().to_vec()
    }

    /// The wanted pressure per contact node, MPa, where the deviation from it is minimised.
    pub fn wanted(&self) -> Option<&[f64]> {
        match self {
            Self::Pressure(objective) => objective.cost().wanted(),
            Self::Field(_) => None,
        }
    }

    /// The least value that a total normal force leaves possible, unit of Θ; none for functions of the displacements.
    pub fn lower_bound(&self, total_force: f64) -> Option<f64> {
        match self {
            Self::Pressure(objective) => Some(objective.cost().lower_bound(total_force)),
            Self::Field(_) => None,
        }
    }

    /// The unit of Θ, such as `MPa^{4}`.
    pub fn unit(&self) -> String {
        match self {
            Self::Pressure(objective) => objective.cost().unit(),
            Self::Field(objective) => objective.cost().unit().into(),
        }
    }

    /// p where Θ is (Σσ^p)^{1/p} in place of Σσ^p, else 1.
    pub fn root(&self) -> f64 {
        match self {
            Self::Pressure(objective) => objective.cost().root(),
            Self::Field(_) => 1.0,
        }
    }

    /// The contact areas of a state, where the open area is what is minimised.
    pub fn contact_areas(&self, state: &ContactState<SharedState>) -> Option<ContactAreas> {
        match self {
            Self::Pressure(objective) => objective.cost().contact_areas(state),
            Self::Field(_) => None,
        }
    }
}

impl NonsmoothObjective for ContactObjective {
    type WarmStart = ContactWarmStart;

    fn dimension(&self) -> usize {
        self.solver().control_dimension()
    }

    fn outer(&self) -> Option<&dyn OuterFunction> {
        match self {
            Self::Pressure(objective) => objective.outer(),
            Self::Field(objective) => objective.outer(),
        }
    }

    fn evaluate(&self, request: &Request<'_, ContactWarmStart>) -> Result<Answer<ContactWarmStart>, OracleError> {
        match self {
            Self::Pressure(objective) => objective.evaluate(request),
            Self::Field(objective) => objective.evaluate(request),
        }
    }
}

/// Θ of a case, for single shapes, in a single process.
///
/// # Errors
/// [`Failure::Input`] naming the field.
pub fn objective(case: &Case) -> Result<ContactObjective, Failure> {
    objective_among(case, &Processes::alone())
}

/// Θ of a case, for single shapes.
///
/// # Errors
/// [`Failure::Input`] naming the field.
pub fn objective_among(case: &Case, processes: &Processes) -> Result<ContactObjective, Failure> {
    objective_for(case, Wanted::States, processes)
}

/// Θ of a case, for its optimization.
///
/// # Errors
/// [`Failure::Input`] naming the field.
pub fn optimized_objective(case: &Case, processes: &Processes) -> Result<ContactObjective, Failure> {
    objective_for(
        case,
        match case.method {
            MethodName::Composite => Wanted::Jacobians,
            MethodName::Bundle => Wanted::States,
        },
        processes,
    )
}

fn objective_for(case: &Case, wanted: Wanted, processes: &Processes) -> Result<ContactObjective, Failure> {
    let shape = processes.shape(case, wanted)?;
    Ok(match AnyCost::new(case, shape.problem())? {
        AnyCost::Pressure(cost) => ContactObjective::Pressure(CompositeObjective::new(shape, cost)),
        AnyCost::Field(cost) => ContactObjective::Field(ReducedObjective::new(shape.with_displacements(), cost)),
    })
}

/// The cost of a case on its mesh.
enum AnyCost {
    Pressure(PressureCost),
    Field(FieldCost),
}

impl AnyCost {
    fn new(case: &Case, problem: &ContactProblem) -> Result<Self, SceneError> {
        Ok(match case.objective.measure(problem)? {
            Measure::Pressure(measure) => {
                Self::Pressure(PressureCost::new(measure, &problem.boundary)?.normalised_for(&case.scene))
            }
            Measure::Field(measure) => Self::Field(FieldCost::new(measure, problem)?),
        })
    }
}

/// Refuses a case whose objective has no value on its mesh, without preparing a solver for it.
///
/// # Errors
/// [`SceneError`] naming the field.
pub fn check_objective(case: &Case) -> Result<(), SceneError> {
    AnyCost::new(case, &ContactProblem::new(case.scene.clone())?).map(|_| ())
}

/// A shape, its state as accurate as rounding allows, and the objective there.
#[derive(Debug)]
pub struct SolvedShape {
    /// Control heights, mm.
    pub controls: Vector,
    /// The contact state.
    pub state: ContactState<SharedState>,
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
        let value = objective.value(controls, &state);
        let peak_pressure = objective.pressures(&state).into_iter().fold(f64::NEG_INFINITY, f64::max);
        Ok(Self { controls: controls.clone(), state, value, peak_pressure })
    }

    /// Displacements, stresses and contact fields; with the sensitivity of Θ to the height of every contact node, which takes an
    /// adjoint, if it is asked for.
    ///
    /// # Errors
    /// [`Failure`] of the adjoint.
    pub fn fields(&self, objective: &ContactObjective, sensitivities: bool) -> Result<Fields, Failure> {
        let mut fields = objective.solver().fields(&self.state)?;
        if sensitivities {
            fields.contact.sensitivity = Some(objective.height_sensitivity(self)?);
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
    if arguments.no_checks { Ok(Vec::new()) } else { Ok(objective.solver().warnings(&shape.state)?) }
}
