//! The objective Θ of a contact problem: a measure of the states of a shape, and its first step.

use crate::body::mesh::smallest_extent;
use crate::contact_shape::{ContactShape, ContactState, ContactWarmStart};
pub use crate::cost::PressureRoot;
use crate::cost::{ContactAreas, FieldCost, Limit, LimitSide, LimitedQuantity, Measure, PressureCost, VolumeLimits};
use crate::equilibrium::{ContactProblem, ContactSolver};
use crate::error::SceneError;
use crate::solvers::AnySolver;
use nonsmooth::composite::OuterFunction;
use nonsmooth::{
    Answer, CompositeObjective, ConstraintEvaluation, ConstraintKind, Cost, CostGradient, Evaluation, Matrix,
    NonsmoothObjective, OracleError, OutputJacobian, ReducedObjective, Request, StateSolver, Vector,
};

/// Least first step over the smallest extent of the body. Ten times as much costs evaluations on flat bodies.
const LEAST_FIRST_STEP: f64 = 1e-3;
/// Largest first step over the smallest extent of the body: bodies close larger gaps by moving as a whole, which says
/// nothing about their shape.
const LARGEST_FIRST_STEP: f64 = 0.5;

/// Θ of a scene: a measure of the contact state that the controls lead to, with limits beside it. Where a pressure norm
/// may lie outside the range of doubles, Θ is its p-th root.
#[derive(Debug)]
pub struct ContactObjective<S: ContactSolver = AnySolver> {
    measured: Measured<S>,
    limits: Vec<Limit>,
    volume: VolumeLimits,
    kinds: Vec<ConstraintKind>,
}

/// A measure of the states of a map.
#[derive(Debug)]
enum Measured<S: ContactSolver> {
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
    /// The cost of a measure with the limits that go with the contact pressures.
    ///
    /// # Errors
    /// As [`PressureCost::new`] and [`FieldCost::new`]; [`SceneError::OutOfRange`] for a limit of the pressure beside a
    /// function of the displacements, and for two.
    pub fn new(measure: Measure, limits: &[Limit], problem: &ContactProblem) -> Result<Self, SceneError> {
        let peak: Vec<&Limit> = limits.iter().filter(|limit| limit.quantity == LimitedQuantity::PeakPressure).collect();
        let refused = |allowed: &str| Err(SceneError::out_of_range("limit", "peak-pressure", allowed));
        Ok(match (measure, peak.as_slice()) {
            (_, [_, _, ..]) => return refused("one limit of the peak pressure"),
            (Measure::Pressure(measure), peak) => {
                let cost = PressureCost::new(measure, problem)?.normalised_for(problem);
                match peak {
                    [limit] if limit.side != LimitSide::AtMost => return refused("at most a bound"),
                    [limit, ..] => Self::Pressure(cost.limited(limit.bound)?),
                    [] => Self::Pressure(cost),
                }
            }
            (Measure::Field(_), [_]) => return refused("none beside a function of the displacements"),
            (Measure::Field(measure), []) => Self::Field(FieldCost::new(measure, problem)?),
        })
    }
}

impl<S: ContactSolver> ContactObjective<S> {
    /// A measure of the states of a map, with limits beside it.
    ///
    /// # Errors
    /// As [`ContactCost::new`]; [`SceneError::OutOfRange`] for bounds of the volume that are not finite and > 0.
    pub fn new(shape: ContactShape<S>, measure: Measure, limits: &[Limit]) -> Result<Self, SceneError> {
        let limits = Limit::in_order(limits);
        let volume = VolumeLimits::new(&limits, shape.problem())?;
        let measured = match ContactCost::new(measure, &limits, shape.problem())? {
            ContactCost::Pressure(cost) => {
                Measured::Pressure(CompositeObjective::new(shape.with_outputs(cost.outputs()), cost))
            }
            ContactCost::Field(cost) => Measured::Field(ReducedObjective::new(shape.with_displacements(), cost)),
        };
        let kinds = limits.iter().map(Limit::kind).collect();
        Ok(Self { measured, limits, volume, kinds })
    }

    /// The limits, in the order of the constraints of the optimizer.
    pub fn limits(&self) -> &[Limit] {
        &self.limits
    }

    /// The values of the limited quantities at a state already found, in the order of [`Self::limits`].
    pub fn limited_values(&self, control: &Vector, state: &ContactState<S::State>) -> Vec<f64> {
        let of_state = self.limits.iter().filter(|limit| !limit.quantity.is_of_shape());
        let peak = || self.pressures(state).into_iter().fold(f64::NEG_INFINITY, f64::max);
        let mut values: Vec<f64> = of_state.map(|_| peak()).collect();
        values.extend(self.volume.values(self.solver().problem(), control));
        values
    }

    /// Adds the constraints of the shape to those of an evaluation.
    fn add_constraints(&self, control: &Vector, evaluation: &mut Evaluation<ContactWarmStart>) {
        let own = self.volume.constraints(self.solver().problem(), control);
        if own.is_empty() {
            return;
        }
        let known = evaluation.constraints.take();
        let known =
            known.unwrap_or_else(|| ConstraintEvaluation::new(Vector::zeros(0), Matrix::zeros(0, control.len())));
        let (first, count) = (known.values.len(), known.values.len() + own.len());
        let mut jacobian = known.jacobian.resize_vertically(count, 0.0);
        let mut values = known.values.resize_vertically(count, 0.0);
        for (index, (value, gradient)) in own.into_iter().enumerate() {
            values[first + index] = value;
            jacobian.set_row(first + index, &gradient.transpose());
        }
        evaluation.constraints = Some(ConstraintEvaluation { values, jacobian, pieces: known.pieces });
    }

    /// The map from controls to contact states.
    pub fn solver(&self) -> &ContactShape<S> {
        match &self.measured {
            Measured::Pressure(objective) => objective.solver(),
            Measured::Field(objective) => objective.solver(),
        }
    }

    /// Θ at a state already found.
    pub fn value(&self, control: &Vector, state: &ContactState<S::State>) -> f64 {
        match &self.measured {
            Measured::Pressure(objective) => objective.value(state),
            Measured::Field(objective) => objective.cost().value(control, state),
        }
    }

    /// The gradients of the cost by the controls at a fixed state, and by the state at fixed controls, y*: what the
    /// coderivative is asked for.
    pub fn cost_gradient(&self, control: &Vector, state: &ContactState<S::State>) -> CostGradient {
        match &self.measured {
            Measured::Pressure(objective) => objective.cost_gradient(control, state),
            Measured::Field(objective) => objective.cost().gradient(control, state),
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
        match &self.measured {
            Measured::Pressure(objective) => objective.differentiate(control, state),
            Measured::Field(objective) => objective.differentiate(control, state),
        }
    }

    /// The derivative of Θ by the position of every node of the lower body along the axes at a state already found,
    /// unit of Θ per mm; 0 for nodes that no control moves.
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
        let explicit = match (&self.measured, &state.bodies) {
            (Measured::Field(objective), Some(bodies)) => objective.cost().gradient_of(bodies).positions,
            (Measured::Field(_), None) => return Ok(positions),
            (Measured::Pressure(objective), _) => {
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
        match &self.measured {
            Measured::Pressure(objective) => objective.cost().wanted(),
            Measured::Field(_) => None,
        }
    }

    /// Why Θ does not change near a state of contact, where more is known than that its derivative is zero.
    pub(crate) fn why_flat(&self, state: &ContactState<S::State>) -> Option<String> {
        match &self.measured {
            Measured::Pressure(objective) => objective.cost().why_flat(state),
            Measured::Field(_) => None,
        }
    }

    /// The least value that a total normal force leaves possible, unit of Θ; none for functions of the displacements,
    /// and where normals or areas change with the shape.
    pub fn lower_bound(&self, total_force: f64) -> Option<f64> {
        match &self.measured {
            Measured::Pressure(objective) if self.solver().problem().geometry.is_fixed() => {
                objective.cost().lower_bound(total_force)
            }
            Measured::Pressure(_) | Measured::Field(_) => None,
        }
    }

    /// The unit of Θ, such as `MPa^{4}·mm^{2}`.
    pub fn unit(&self) -> String {
        match &self.measured {
            Measured::Pressure(objective) => objective.cost().unit(),
            Measured::Field(objective) => objective.cost().unit().into(),
        }
    }

    /// A value of Θ as a pressure, where Θ is a sum of powers of pressures.
    pub fn pressure_root(&self, value: f64) -> Option<PressureRoot> {
        match &self.measured {
            Measured::Pressure(objective) => objective.cost().pressure_root(value),
            Measured::Field(_) => None,
        }
    }

    /// p where Θ is (Σσ^p)^{1/p} in place of Σσ^p, else 1.
    pub fn root(&self) -> f64 {
        match &self.measured {
            Measured::Pressure(objective) => objective.cost().root(),
            Measured::Field(_) => 1.0,
        }
    }

    /// As [`PressureCost::norm_of_root`]; none for functions of the displacements.
    pub fn norm_of_root(&self) -> Option<(f64, String)> {
        match &self.measured {
            Measured::Pressure(objective) => objective.cost().norm_of_root(),
            Measured::Field(_) => None,
        }
    }

    /// As [`PressureCost::norm_in_mpa`]; none for functions of the displacements.
    pub fn norm_in_mpa(&self, value: f64) -> Option<f64> {
        match &self.measured {
            Measured::Pressure(objective) => objective.cost().norm_in_mpa(value),
            Measured::Field(_) => None,
        }
    }

    /// The contact areas of a state, where the open area is what is minimised.
    pub fn contact_areas(&self, state: &ContactState<S::State>) -> Option<ContactAreas> {
        match &self.measured {
            Measured::Pressure(objective) => objective.cost().contact_areas(state),
            Measured::Field(_) => None,
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

    /// Coordinates of the controls for the optimizer. For heights, a change of their mean by the height itself is as
    /// long in them as a change of shape by the first step: bodies that contact holds follow the surface as a whole, so
    /// that Θ hardly depends on its mean height. Other controls are their own coordinates.
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
        match &self.measured {
            Measured::Pressure(objective) => objective.outer(),
            Measured::Field(objective) => objective.outer(),
        }
    }

    fn constraint_kinds(&self) -> &[ConstraintKind] {
        &self.kinds
    }

    fn evaluate(&self, request: &Request<'_, ContactWarmStart>) -> Result<Answer<ContactWarmStart>, OracleError> {
        let mut answer = match &self.measured {
            Measured::Pressure(objective) => objective.evaluate(request),
            Measured::Field(objective) => objective.evaluate(request),
        }?;
        let (Answer::Accurate(evaluation) | Answer::NoDescent(evaluation)) = &mut answer;
        self.add_constraints(request.point, evaluation);
        Ok(answer)
    }
}
