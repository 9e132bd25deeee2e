//! The objective Θ of a contact problem: a measure of the states of a shape in all load cases, and its first step.

use crate::body::mesh::smallest_extent;
use crate::contact_shape::{ContactShape, ContactState, ContactWarmStart};
pub use crate::cost::PressureRoot;
use crate::cost::{Limit, PressureCost, Quantity, Reported};
use crate::error::SceneError;
use crate::load_cases::{Bound, CaseCost, CaseStates, CasesCost, LoadCase, LoadCases, Over, Told, WeightedCase};
use crate::scene::Scene;
use crate::shape::LatticeShape;
use nonsmooth::ConstraintPiece;
use nonsmooth::composite::OuterFunction;
use nonsmooth::{
    Answer, CompositeObjective, ConstraintEvaluation, ConstraintKind, CostGradient, Evaluation, Matrix,
    NonsmoothObjective, OracleError, OutputJacobian, Request, StateSolver, Vector,
};

/// Least first step over the smallest extent of the body. Ten times as much costs evaluations on flat bodies.
const LEAST_FIRST_STEP: f64 = 1e-3;
/// Largest first step over the smallest extent of the body: bodies close larger gaps by moving as a whole, which says
/// nothing about their shape.
const LARGEST_FIRST_STEP: f64 = 0.5;

/// Θ of a scene: a measure of the contact states that the controls lead to, one per load case, with limits beside it.
/// Where a pressure norm may lie outside the range of doubles, Θ is made of p-th roots.
#[derive(Debug)]
pub struct ContactObjective {
    composed: CompositeObjective<LoadCases, CasesCost>,
    /// The limits in the order of the constraints of the optimizer: those that are functions of the outputs first.
    bounds: Vec<Bound>,
    /// What is told beside them.
    told: Vec<Told>,
    kinds: Vec<ConstraintKind>,
}

impl ContactObjective {
    /// A quantity of the states of one map, with limits beside it.
    ///
    /// # Errors
    /// As [`of_cases`](Self::of_cases).
    pub fn new(shape: ContactShape, quantity: Quantity, limits: &[Limit]) -> Result<Self, SceneError> {
        let case = LoadCase { name: String::new(), weight: 1.0, shape, quantity };
        Self::of_cases(vec![case], Over::Worst, limits, &[])
    }

    /// Some load cases of one shape, at least one, rated together. A limit of no case holds in each of them, and a
    /// report of no case is told in each.
    ///
    /// # Errors
    /// As [`CasesCost::new`]; [`SceneError::OutOfRange`] for a limit of an unknown case, a bound that means nothing,
    /// and cases whose controls differ in number.
    pub fn of_cases(
        cases: Vec<LoadCase>,
        over: Over,
        limits: &[Limit],
        reports: &[Reported],
    ) -> Result<Self, SceneError> {
        let parts = cases.iter().map(|case| WeightedCase {
            name: &case.name,
            weight: case.weight,
            quantity: case.quantity.clone(),
            problem: case.shape.problem(),
        });
        let parts: Vec<WeightedCase<'_>> = parts.collect();
        let cost = CasesCost::new(&parts, over, limits)?;
        let named: Vec<_> = parts.iter().map(|part| (part.name, part.problem)).collect();
        let (bounds, told) = (Bound::all(limits, &named)?, Told::all(reports, &named)?);
        let kinds = bounds.iter().map(Bound::kind).collect();
        let fields = |case: usize| {
            let own = bounds.iter().filter(|bound| bound.case == case).map(Bound::fields);
            let told = told.iter().any(|told| told.case == case && told.needs_displacements());
            own.fold([told, false], |[any, kinks], [field, kink]| [any || field, kinks || kink])
        };
        let fields: Vec<[bool; 2]> = (0..cases.len()).map(fields).collect();
        let map = LoadCases::new(cases, &cost, &fields);
        Ok(Self { composed: CompositeObjective::new(map, cost), bounds, told, kinds })
    }

    /// The limits on their meshes, in the order of the constraints of the optimizer.
    pub(crate) fn bounds(&self) -> &[Bound] {
        &self.bounds
    }

    /// The limits with their cases, in the order of the constraints of the optimizer.
    pub fn limits(&self) -> impl Iterator<Item = &Limit> {
        self.bounds.iter().map(|bound| &bound.limit)
    }

    /// The values of the limited quantities at states already found, in the order of [`Self::limits`].
    pub fn limited_values(&self, control: &Vector, states: &CaseStates) -> Vec<f64> {
        let problem = |case: usize| self.cases().case(case).problem();
        self.bounds.iter().map(|bound| bound.value(problem(bound.case), control, &states[bound.case])).collect()
    }

    /// The reports with their cases and the values of their quantities at states already found.
    pub fn reported(&self, control: &Vector, states: &CaseStates) -> Vec<(&Reported, f64)> {
        let problem = |case: usize| self.cases().case(case).problem();
        let value = |told: &'_ Told| told.value(problem(told.case), control, &states[told.case]);
        self.told.iter().map(|told| (&told.report, value(told))).collect()
    }

    /// Adds the constraints that are no functions of the outputs to those of an evaluation.
    fn add_constraints(
        &self,
        control: &Vector,
        states: &CaseStates,
        evaluation: &mut Evaluation<Vec<ContactWarmStart>>,
    ) -> Result<(), OracleError> {
        let first = self.composed.cost().constraint_kinds().len();
        if self.bounds.len() == first {
            return Ok(());
        }
        let empty = || ConstraintEvaluation::new(Vector::zeros(0), Matrix::zeros(0, control.len()));
        let known = evaluation.constraints.take().unwrap_or_else(empty);
        let count = self.bounds.len();
        let mut jacobian = known.jacobian.resize_vertically(count, 0.0);
        let mut values = known.values.resize_vertically(count, 0.0);
        let mut pieces = known.pieces;
        for (constraint, bound) in self.bounds.iter().enumerate().skip(first) {
            let found = bound.linearized(self.cases(), control, states)?;
            values[constraint] = found.value;
            jacobian.set_row(constraint, &found.gradient.transpose());
            let further = found.pieces.into_iter();
            pieces.extend(further.map(|(value, gradient)| ConstraintPiece { constraint, value, gradient }));
        }
        evaluation.constraints = Some(ConstraintEvaluation { values, jacobian, pieces });
        Ok(())
    }

    /// The map from controls to the states of all cases.
    pub fn cases(&self) -> &LoadCases {
        self.composed.solver()
    }

    /// Θ as a function of the outputs of all cases.
    pub fn cost(&self) -> &CasesCost {
        self.composed.cost()
    }

    /// The map of the first case, whose shape and controls are those of all.
    pub fn solver(&self) -> &ContactShape {
        self.cases().case(0)
    }

    /// The measure of the pressures in a case, where Θ is one.
    fn pressure(&self, case: usize) -> Option<&PressureCost> {
        match self.cost().case(case) {
            CaseCost::Pressure(cost) => Some(cost),
            CaseCost::State(_) | CaseCost::Shape(_) => None,
        }
    }

    /// Θ at states already found.
    pub fn value(&self, states: &CaseStates) -> f64 {
        self.composed.value(states)
    }

    /// The first of the worst cases at states already found.
    pub fn worst(&self, states: &CaseStates) -> usize {
        self.cost().worst(&self.cases().outputs(states))
    }

    /// w_k J_k of every case at states already found: Θ is the largest of them, or their sum.
    pub fn weighted_values(&self, states: &CaseStates) -> Vec<f64> {
        self.cost().weighted(&self.cases().outputs(states))
    }

    /// The gradients of the cost by the controls at fixed states, and by the states at fixed controls, y*: what the
    /// coderivative is asked for.
    pub fn cost_gradient(&self, control: &Vector, states: &CaseStates) -> CostGradient {
        self.composed.cost_gradient(control, states)
    }

    /// Θ and one subgradient at states already found.
    ///
    /// # Errors
    /// As [`CompositeObjective::differentiate`].
    pub fn differentiate(
        &self,
        control: &Vector,
        states: &CaseStates,
    ) -> Result<Evaluation<Vec<ContactWarmStart>>, OracleError> {
        self.composed.differentiate(control, states)
    }

    /// As [`Self::differentiate`], with all limits as constraints c = ±(value − bound) ≤ 0 (= 0 for equalities) in the
    /// order of [`Self::limits`], and their gradients.
    ///
    /// # Errors
    /// As [`Self::differentiate`].
    pub fn differentiate_with_limits(
        &self,
        control: &Vector,
        states: &CaseStates,
    ) -> Result<Evaluation<Vec<ContactWarmStart>>, OracleError> {
        let mut evaluation = self.composed.evaluate_at(&Request::tight(control), states)?;
        self.add_constraints(control, states, &mut evaluation)?;
        Ok(evaluation)
    }

    /// The derivative of Θ by the position of every node of the lower body along the axes at states already found, unit
    /// of Θ per mm; 0 for nodes that no control moves.
    ///
    /// # Errors
    /// As [`ContactShape::position_sensitivity`].
    pub fn position_sensitivity(&self, control: &Vector, states: &CaseStates) -> Result<Vec<[f64; 3]>, OracleError> {
        let weights = self.cost().subgradient(&self.cases().outputs(states));
        self.cases().position_sensitivity(control, states, &weights)
    }

    /// σ per contact node of a case, MPa.
    pub fn pressures(&self, state: &ContactState) -> Vec<f64> {
        state.rows.pressures(&state.forces.normal)
    }

    /// The wanted pressure per contact node in the first case, MPa, where the deviation from it is minimised.
    pub fn wanted(&self) -> Option<&[f64]> {
        self.pressure(0)?.wanted()
    }

    /// Why Θ does not change near states of contact, where more is known than that its derivative is zero.
    pub(crate) fn why_flat(&self, states: &CaseStates) -> Option<String> {
        let worst = self.worst(states);
        self.pressure(worst)?.why_flat(&states[worst])
    }

    /// The least value that the total normal forces of some states leave possible, unit of Θ; none for functions of the
    /// displacements, and where normals or areas change with the shape.
    pub fn lower_bound(&self, states: &CaseStates) -> Option<f64> {
        let bound = |(case, state): (usize, &ContactState)| {
            let fixed = self.cases().case(case).problem().geometry.is_fixed();
            let cost = self.pressure(case).filter(|_| fixed)?;
            Some(self.cost().weight(case) * cost.lower_bound(state.forces.total_normal_force())?)
        };
        let bounds = states.iter().enumerate().map(bound).collect::<Option<Vec<f64>>>()?;
        Some(match self.cost().over() {
            Over::Worst => bounds.into_iter().fold(f64::NEG_INFINITY, f64::max),
            Over::Sum => bounds.into_iter().sum(),
        })
    }

    /// The unit of Θ, such as `MPa^{4}·mm^{2}`.
    pub fn unit(&self) -> String {
        match self.cost().case(0) {
            CaseCost::Pressure(cost) => cost.unit(),
            CaseCost::State(_) | CaseCost::Shape(_) => self.cost().quantity().unit(),
        }
    }

    /// A value of Θ as a pressure, where Θ is a sum of powers of pressures of one case, or of the worst with weight 1.
    pub fn pressure_root(&self, value: f64) -> Option<PressureRoot> {
        let plain = (0..self.cases().count()).all(|case| self.cost().weight(case) == 1.0);
        let alone = self.cases().count() == 1 || self.cost().over() == Over::Worst;
        let alone = alone && self.cost().fairness().is_none();
        self.pressure(0).filter(|_| plain && alone)?.pressure_root(value)
    }

    /// p where Θ is (Σσ^p)^{1/p} in place of Σσ^p, else 1.
    pub fn root(&self) -> f64 {
        self.pressure(0).map_or(1.0, PressureCost::root)
    }

    /// As [`PressureCost::norm_of_root`]; none for several cases and for functions of the displacements.
    pub fn norm_of_root(&self) -> Option<(f64, String)> {
        let plain = self.cases().count() == 1 && self.cost().fairness().is_none();
        self.pressure(0).filter(|_| plain)?.norm_of_root()
    }

    /// As [`PressureCost::norm_in_mpa`], under the conditions of [`pressure_root`](Self::pressure_root).
    pub fn norm_in_mpa(&self, value: f64) -> Option<f64> {
        self.pressure_root(value).map(|root| root.value)
    }

    /// Half of the mean distance between a surface and its counterpart in the first case, the length on which contact
    /// changes, but at least a thousandth and at most half of the smallest extent of the body, mm: bodies that touch
    /// everywhere have no distance, and deform.
    pub fn first_step(&self, start: &Vector) -> f64 {
        let problem = self.solver().problem();
        let positions = problem.positions(start.as_slice());
        let rows = positions.as_ref().ok().and_then(|positions| problem.rows(positions).ok());
        let nodes = rows.iter().flat_map(|rows| rows.contact_nodes()).filter(|node| node.is_covered);
        let gaps = nodes.map(|node| node.gap);
        let (sum, count) = gaps.fold((0.0, 0), |(sum, count), gap| (sum + gap.abs(), count + 1));
        let length = sum / (2 * count.max(1)) as f64;
        let positions = problem.map.positions(start.as_slice());
        let shaped = problem.map.shaped_bodies().map(|body| smallest_extent(&positions[body]));
        let extent = shaped.fold(f64::INFINITY, f64::min);
        length.max(LEAST_FIRST_STEP * extent).min(LARGEST_FIRST_STEP * extent)
    }

    /// Coordinates of the controls for the optimizer. For heights, a change of their mean by the height itself is as
    /// long in them as a change of shape by the first step: bodies that contact holds follow the surface as a whole, so
    /// that Θ hardly depends on its mean height. Other controls are their own coordinates.
    ///
    /// M = I + (κ − 1)/n · 1 1ᵀ, κ = max(1, mean height / first step), stretches the mean of the n heights of a body by
    /// κ and keeps differences.
    pub fn coordinates(&self, start: &Vector, first_step: f64) -> Matrix {
        let counts: Vec<usize> = self.scene().shapes().map(LatticeShape::control_count).collect();
        self.net_coordinates(start, &counts, first_step)
    }

    /// As [`coordinates`](Self::coordinates), of the controls of coarser nets: so many of every body with controls.
    pub fn net_coordinates(&self, start: &Vector, counts: &[usize], first_step: f64) -> Matrix {
        let variables = counts.iter().sum();
        let mut coordinates = Matrix::identity(variables, variables);
        let (mut row, mut first) = (0, 0);
        for (shape, &count) in self.scene().shapes().zip(counts) {
            let own = shape.control_count();
            if shape.face().is_some() {
                let stretch = (start.rows(row, own).mean().abs() / first_step).max(1.0);
                coordinates.view_mut((first, first), (count, count)).add_scalar_mut((stretch - 1.0) / count as f64);
            }
            (row, first) = (row + own, first + count);
        }
        coordinates
    }

    fn scene(&self) -> &Scene {
        &self.solver().problem().scene
    }
}

impl NonsmoothObjective for ContactObjective {
    type WarmStart = Vec<ContactWarmStart>;

    fn dimension(&self) -> usize {
        self.composed.dimension()
    }

    fn outer(&self) -> Option<&dyn OuterFunction> {
        self.composed.outer()
    }

    fn constraint_kinds(&self) -> &[ConstraintKind] {
        &self.kinds
    }

    fn evaluate(
        &self,
        request: &Request<'_, Vec<ContactWarmStart>>,
    ) -> Result<Answer<Vec<ContactWarmStart>>, OracleError> {
        let states = self.cases().solve(request.point, request.warm_start, request.accuracy)?;
        let mut evaluation = self.composed.evaluate_at(request, &states)?;
        self.add_constraints(request.point, &states, &mut evaluation)?;
        evaluation.work = self.cases().work(&states);
        Ok(Answer::Accurate(evaluation))
    }
}
