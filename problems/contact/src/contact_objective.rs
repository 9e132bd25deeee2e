//! The objective Θ of a contact problem: a measure of the states of control heights, and its first step.

use crate::body::mesh::smallest_extent;
use crate::contact_shape::{ContactShape, ContactState, ContactWarmStart};
pub use crate::cost::PressureRoot;
use crate::cost::{ContactAreas, FieldCost, Measure, PressureCost};
use crate::equilibrium::{ContactProblem, ContactSolver};
use crate::error::SceneError;
use crate::solvers::AnySolver;
use nonsmooth::composite::OuterFunction;
use nonsmooth::{
    Answer, CompositeObjective, ConstraintKind, Cost, CostGradient, Evaluation, Matrix, NonsmoothObjective,
    OracleError, OutputJacobian, ReducedObjective, Request, StateSolver, Vector,
};

/// Least first step over the smallest extent of the body. Ten times as much costs evaluations on flat bodies.
const LEAST_FIRST_STEP: f64 = 1e-3;
/// Largest first step over the smallest extent of the body: bodies close larger gaps by moving as a whole, which says
/// nothing about their shape.
const LARGEST_FIRST_STEP: f64 = 0.5;

/// Θ of a scene: a measure of the contact state that the control heights lead to. Where a pressure norm may lie outside
/// the range of doubles, Θ is its p-th root.
#[derive(Debug)]
pub enum ContactObjective<S: ContactSolver = AnySolver> {
    /// A convex function of the contact pressures.
    Pressure(CompositeObjective<ContactShape<S>, PressureCost>),
    /// A function of the displacements, which has no composite model.
    Field(ReducedObjective<ContactShape<S>, FieldCost>),
}

/// A measure on the bodies of a problem.
#[derive(Debug, Clone)]
pub enum ContactCost {
    /// Of the contact pressures, normalised where it may lie outside the range of doubles.
    Pressure(PressureCost),
    /// A function of the displacements.
    Field(FieldCost),
}

impl ContactCost {
    /// The cost of a measure.
    ///
    /// # Errors
    /// As [`PressureCost::new`] and [`FieldCost::new`].
    pub fn new(measure: Measure, problem: &ContactProblem) -> Result<Self, SceneError> {
        Ok(match measure {
            Measure::Pressure(measure) => Self::Pressure(PressureCost::new(measure, problem)?.normalised_for(problem)),
            Measure::LimitedPressure(measure, limit) => {
                let cost = PressureCost::new(measure, problem)?.normalised_for(problem);
                Self::Pressure(cost.limited(limit)?)
            }
            Measure::Field(measure) => Self::Field(FieldCost::new(measure, problem)?),
        })
    }
}

impl<S: ContactSolver> ContactObjective<S> {
    /// A measure of the states of a map.
    ///
    /// # Errors
    /// As [`ContactCost::new`].
    pub fn new(shape: ContactShape<S>, measure: Measure) -> Result<Self, SceneError> {
        Ok(match ContactCost::new(measure, shape.problem())? {
            ContactCost::Pressure(cost) => {
                Self::Pressure(CompositeObjective::new(shape.with_outputs(cost.outputs()), cost))
            }
            ContactCost::Field(cost) => Self::Field(ReducedObjective::new(shape.with_displacements(), cost)),
        })
    }

    /// The map from control heights to contact states.
    pub fn solver(&self) -> &ContactShape<S> {
        match self {
            Self::Pressure(objective) => objective.solver(),
            Self::Field(objective) => objective.solver(),
        }
    }

    /// Θ at a state already found.
    pub fn value(&self, control: &Vector, state: &ContactState<S::State>) -> f64 {
        match self {
            Self::Pressure(objective) => objective.value(state),
            Self::Field(objective) => objective.cost().value(control, state),
        }
    }

    /// The gradients of the cost by the controls at a fixed state, and by the state at fixed controls, y*: what the
    /// coderivative is asked for.
    pub fn cost_gradient(&self, control: &Vector, state: &ContactState<S::State>) -> CostGradient {
        match self {
            Self::Pressure(objective) => objective.cost_gradient(control, state),
            Self::Field(objective) => objective.cost().gradient(control, state),
        }
    }

    /// Θ and one subgradient at a state already found.
    ///
    /// # Errors
    /// As [`CompositeObjective::differentiate`] and [`ReducedObjective::differentiate`].
    pub fn differentiate(
        &self,
        control: &Vector,
        state: &ContactState<S::State>,
    ) -> Result<Evaluation<ContactWarmStart>, OracleError> {
        match self {
            Self::Pressure(objective) => objective.differentiate(control, state),
            Self::Field(objective) => objective.differentiate(control, state),
        }
    }

    /// The derivative of Θ by the position of every node of the lower body along the axes at a state already found, unit
    /// of Θ per mm; 0 for nodes that no control moves.
    ///
    /// # Errors
    /// As [`ContactShape::position_sensitivity`].
    pub fn position_sensitivity(
        &self,
        control: &Vector,
        state: &ContactState<S::State>,
    ) -> Result<Vec<[f64; 3]>, OracleError> {
        let dual = self.cost_gradient(control, state).state;
        let mut positions = self.solver().position_sensitivity(state, &dual)?.0;
        let explicit = match (self, &state.bodies) {
            (Self::Field(objective), Some(bodies)) => objective.cost().gradient_of(bodies).positions,
            (Self::Field(_), None) => return Ok(positions),
            (Self::Pressure(objective), _) => {
                let weights = objective.cost().subgradient(&self.solver().outputs(state));
                self.solver().output_position_gradient(control, state, &weights)
            }
        };
        for (sum, explicit) in positions.iter_mut().zip(explicit) {
            (0..3).for_each(|axis| sum[axis] += explicit[axis]);
        }
        Ok(positions)
    }

    /// σ per contact node, MPa.
    pub fn pressures(&self, state: &ContactState<S::State>) -> Vec<f64> {
        state.rows.pressures(&state.forces.normal)
    }

    /// The wanted pressure per contact node, MPa, where the deviation from it is minimised.
    pub fn wanted(&self) -> Option<&[f64]> {
        match self {
            Self::Pressure(objective) => objective.cost().wanted(),
            Self::Field(_) => None,
        }
    }

    /// The limit of the largest contact pressure, MPa, if there is one.
    pub fn peak_limit(&self) -> Option<f64> {
        match self {
            Self::Pressure(objective) => objective.cost().peak_limit(),
            Self::Field(_) => None,
        }
    }

    /// The least value that a total normal force leaves possible, unit of Θ; none for functions of the displacements, and
    /// where normals or areas change with the shape.
    pub fn lower_bound(&self, total_force: f64) -> Option<f64> {
        match self {
            Self::Pressure(objective) if self.solver().problem().geometry.is_fixed() => {
                objective.cost().lower_bound(total_force)
            }
            Self::Pressure(_) | Self::Field(_) => None,
        }
    }

    /// The unit of Θ, such as `MPa^{4}·mm^{2}`.
    pub fn unit(&self) -> String {
        match self {
            Self::Pressure(objective) => objective.cost().unit(),
            Self::Field(objective) => objective.cost().unit().into(),
        }
    }

    /// A value of Θ as a pressure, where Θ is a sum of powers of pressures.
    pub fn pressure_root(&self, value: f64) -> Option<PressureRoot> {
        match self {
            Self::Pressure(objective) => objective.cost().pressure_root(value),
            Self::Field(_) => None,
        }
    }

    /// p where Θ is (Σσ^p)^{1/p} in place of Σσ^p, else 1.
    pub fn root(&self) -> f64 {
        match self {
            Self::Pressure(objective) => objective.cost().root(),
            Self::Field(_) => 1.0,
        }
    }

    /// As [`PressureCost::norm_of_root`]; none for functions of the displacements.
    pub fn norm_of_root(&self) -> Option<(f64, String)> {
        match self {
            Self::Pressure(objective) => objective.cost().norm_of_root(),
            Self::Field(_) => None,
        }
    }

    /// As [`PressureCost::norm_in_mpa`]; none for functions of the displacements.
    pub fn norm_in_mpa(&self, value: f64) -> Option<f64> {
        match self {
            Self::Pressure(objective) => objective.cost().norm_in_mpa(value),
            Self::Field(_) => None,
        }
    }

    /// The contact areas of a state, where the open area is what is minimised.
    pub fn contact_areas(&self, state: &ContactState<S::State>) -> Option<ContactAreas> {
        match self {
            Self::Pressure(objective) => objective.cost().contact_areas(state),
            Self::Field(_) => None,
        }
    }

    /// Half of the mean distance between a surface and its counterpart, the length on which contact changes, but at
    /// least a thousandth and at most half of the smallest extent of the body, mm: bodies that touch everywhere have no
    /// distance, and deform.
    pub fn first_step(&self, start: &Vector) -> f64 {
        let problem = self.solver().problem();
        let positions = problem.positions(start.as_slice());
        let rows = positions.as_ref().ok().and_then(|positions| problem.rows(positions).ok());
        let gaps = rows.iter().flat_map(|rows| rows.gaps());
        let (sum, count) = gaps.fold((0.0, 0), |(sum, count), gap| (sum + gap.abs(), count + 1));
        let length = sum / (2 * count.max(1)) as f64;
        let extent = smallest_extent(&problem.map.positions(start.as_slice()));
        length.max(LEAST_FIRST_STEP * extent).min(LARGEST_FIRST_STEP * extent)
    }

    /// Coordinates of the controls for the optimizer. For heights, a change of their mean by the height itself is as long
    /// in them as a change of shape by the first step: bodies that contact holds follow the surface as a whole, so that Θ
    /// hardly depends on its mean height. Other controls are their own coordinates.
    ///
    /// M = I + (κ − 1)/n · 1 1ᵀ, κ = max(1, mean height / first step), stretches the mean by κ and keeps differences.
    pub fn coordinates(&self, start: &Vector, first_step: f64) -> Matrix {
        let count = start.len();
        let is_height = self.solver().problem().scene.heights().is_some();
        let stretch = if is_height { (start.mean().abs() / first_step).max(1.0) } else { 1.0 };
        Matrix::from_fn(count, count, |i, j| (stretch - 1.0) / count as f64 + f64::from(u8::from(i == j)))
    }
}

impl<S: ContactSolver> NonsmoothObjective for ContactObjective<S> {
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

    fn constraint_kinds(&self) -> &[ConstraintKind] {
        match self {
            Self::Pressure(objective) => objective.constraint_kinds(),
            Self::Field(objective) => objective.constraint_kinds(),
        }
    }

    fn evaluate(&self, request: &Request<'_, ContactWarmStart>) -> Result<Answer<ContactWarmStart>, OracleError> {
        match self {
            Self::Pressure(objective) => objective.evaluate(request),
            Self::Field(objective) => objective.evaluate(request),
        }
    }
}
