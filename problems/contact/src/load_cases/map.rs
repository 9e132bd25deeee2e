//! Controls ↦ the states of all cases, as one state problem of the framework.

use crate::contact_shape::{ContactShape, ContactState, ContactWarmStart};
use crate::cost::{ShapeFunction, StateCost, StateView};
use crate::equilibrium::TangentsOf;
use crate::load_cases::case::named;
use crate::load_cases::threads::on_all;
use crate::load_cases::{CaseCost, CaseStates, CasesCost, LoadCase};
use nonsmooth::composite::{InactiveConstraints, Linearization};
use nonsmooth::{
    Accuracy, Coderivative, CostGradient, InputError, Matrix, OracleError, OutputJacobian, Sensitivity, StateSolver,
    Vector,
};
use std::ops::Range;

/// The control-to-states map of some cases that share their shape. The dual of its states is that of the cases, one
/// after the other ([`crate::contact_shape`]); so are its outputs, after which the function of the shape follows that
/// is the objective, and the rows of its bending where that counts.
#[derive(Debug)]
pub struct LoadCases {
    cases: Vec<OneCase>,
    /// A function of the shape that follows as an output.
    of_shape: Option<ShapeFunction>,
    /// Linear functions of the controls that follow as outputs.
    fairness: Option<Matrix>,
}

/// A case as the map needs it.
#[derive(Debug)]
struct OneCase {
    name: String,
    shape: ContactShape,
    /// Whether functions of the pressures are outputs.
    with_pressures: bool,
    /// Whether the measure is an output of its own, after the pressures.
    field: Option<StateCost>,
    /// Whether forward derivatives of the displacements are wanted with the Jacobian.
    with_tangents: bool,
}

impl OneCase {
    fn outputs(&self, state: &ContactState) -> Vec<f64> {
        let mut outputs = if self.with_pressures { self.shape.outputs(state).as_slice().to_vec() } else { Vec::new() };
        let value = |field: &StateCost| field.value(self.shape.problem(), StateView::of(state));
        outputs.extend(self.field.iter().map(value));
        outputs
    }
}

impl LoadCases {
    /// The map of some cases with the outputs of a cost; `fields` says of each whether its limits depend on the
    /// displacements, and whether some of these have kinks.
    pub(crate) fn new(cases: Vec<LoadCase>, cost: &CasesCost, fields: &[[bool; 2]]) -> Self {
        let one = |(index, LoadCase { name, shape, .. }): (usize, LoadCase)| {
            let (pressures, [in_limits, with_tangents]) = (cost.pressures(index), fields[index]);
            let field = match cost.case(index) {
                CaseCost::State(state) => Some(StateCost::clone(state)),
                CaseCost::Pressure(_) | CaseCost::Shape(_) => None,
            };
            let with_pressures = pressures.is_some();
            let shape = shape.with_outputs(pressures.unwrap_or_default());
            let needed = in_limits || field.as_ref().is_some_and(StateCost::needs_displacements);
            let shape = if needed { shape.with_displacements() } else { shape };
            OneCase { name, shape, with_pressures, field, with_tangents }
        };
        let (of_shape, fairness) = (cost.of_shape().cloned(), cost.fairness().cloned());
        Self { cases: cases.into_iter().enumerate().map(one).collect(), of_shape, fairness }
    }

    /// Number of different cases.
    pub fn count(&self) -> usize {
        self.cases.len()
    }

    /// The map of one case alone.
    pub fn case(&self, index: usize) -> &ContactShape {
        &self.cases[index].shape
    }

    /// What failures and reports call a case.
    pub fn name(&self, index: usize) -> &str {
        &self.cases[index].name
    }

    /// Does something for the cases of a range: at the same time, or in turn where several processes share the work.
    fn on_all<T: Send>(
        &self,
        cases: Range<usize>,
        work: impl Fn(usize) -> Result<T, OracleError> + Sync,
    ) -> Result<Vec<T>, OracleError> {
        let (first, in_turn) = (cases.start, self.cases[0].shape.contact_solver().is_shared());
        let results = on_all(cases.len(), in_turn, |number| work(first + number)).into_iter();
        results.zip(&self.cases[cases]).map(|(result, case)| result.map_err(|error| named(&case.name, error))).collect()
    }

    /// Number of entries of the dual of a case.
    pub(crate) fn dual_count(&self, index: usize) -> usize {
        let shape = &self.cases[index].shape;
        let problem = shape.problem();
        problem.boundary.row_count + if shape.holds_displacements() { problem.displacement_count() } else { 0 }
    }

    /// The part of a dual that belongs to a case.
    fn part(&self, index: usize, dual: &Vector) -> Vector {
        let first: usize = (0..index).map(|other| self.dual_count(other)).sum();
        dual.rows(first, self.dual_count(index)).into_owned()
    }

    /// The gradient of a function of one case, from its explicit derivative and its dual there.
    ///
    /// # Errors
    /// [`OracleError`] of the adjoint, with the name of the case.
    pub(crate) fn gradient(
        &self,
        index: usize,
        states: &CaseStates,
        dual: &CostGradient,
    ) -> Result<Vector, OracleError> {
        let case = &self.cases[index];
        let found = case.shape.coderivative(&states.control, &states[index], &dual.state);
        Ok(&dual.control + found.map_err(|error| named(&case.name, error))?.element)
    }

    /// The dual and the explicit derivative of Σ weights·outputs of a case.
    fn case_dual(&self, index: usize, control: &Vector, states: &CaseStates, weights: &[f64]) -> CostGradient {
        let (case, state) = (&self.cases[index], &states[index]);
        let mut sum =
            CostGradient { control: Vector::zeros(control.len()), state: Vector::zeros(self.dual_count(index)) };
        let count = weights.len() - usize::from(case.field.is_some());
        if case.with_pressures {
            let own = case.shape.output_dual(control, state, &Vector::from_column_slice(&weights[..count]));
            sum.control += own.control;
            let mut rows = sum.state.rows_mut(0, own.state.len());
            rows += own.state;
        }
        if let (Some(field), Some(&weight)) = (&case.field, weights.last()) {
            let problem = case.shape.problem();
            let CostGradient { control, state } = field.gradient(problem, StateView::of(state)).pulled(problem);
            sum.control += control * weight;
            let mut own = sum.state.rows_mut(0, state.len());
            own += state * weight;
        }
        sum
    }

    /// Outputs of a case with their Jacobian, and the slacks of its open nodes.
    fn linearize_case(
        &self,
        index: usize,
        control: &Vector,
        states: &CaseStates,
        accuracy: Accuracy,
    ) -> Result<Linearization, OracleError> {
        let (case, state) = (&self.cases[index], &states[index]);
        let mut known = if case.with_pressures || case.with_tangents {
            let of = if case.with_tangents { TangentsOf::Displacements } else { TangentsOf::Contact };
            let tangents = case.shape.tangents(state, of, accuracy)?;
            let known = case.shape.linearize_by(control, state, &tangents)?;
            if case.with_tangents {
                states.keep_tangents(index, tangents);
            }
            known
        } else {
            let (outputs, jacobian) = (Vector::zeros(0), Matrix::zeros(0, control.len()));
            Linearization { outputs, jacobian, accuracy: 0.0, inactive: None }
        };
        if !case.with_pressures {
            (known.outputs, known.jacobian) = (Vector::zeros(0), Matrix::zeros(0, control.len()));
        }
        if case.field.is_some() {
            let mut weights = vec![0.0; known.outputs.len() + 1];
            weights[known.outputs.len()] = 1.0;
            let dual = self.case_dual(index, control, states, &weights);
            let row = dual.control + case.shape.coderivative(control, state, &dual.state)?.element;
            let value = states.outputs(index).last().copied().unwrap_or(f64::NAN);
            known.outputs = known.outputs.push(value);
            let last = known.jacobian.nrows();
            known.jacobian = known.jacobian.insert_row(last, 0.0);
            known.jacobian.set_row(last, &row.transpose());
        }
        Ok(known)
    }

    /// The derivative of Σ weights·outputs by the positions of the nodes of all bodies, at states already found.
    ///
    /// # Errors
    /// As [`ContactShape::position_sensitivity`].
    pub(crate) fn position_sensitivity(
        &self,
        control: &Vector,
        states: &CaseStates,
        weights: &Vector,
    ) -> Result<Vec<[f64; 3]>, OracleError> {
        let problem = self.cases[0].shape.problem();
        let mut sum = problem.no_sensitivities();
        let mut add = |positions: &[[f64; 3]], factor: f64| {
            let moved = sum.iter_mut().zip(positions);
            moved.for_each(|(sum, own)| (0..3).for_each(|axis| sum[axis] += factor * own[axis]));
        };
        let mut first = 0;
        for (index, case) in self.cases.iter().enumerate() {
            let (state, count) = (&states[index], states.outputs(index).len());
            let own = &weights.as_slice()[first..first + count];
            first += count;
            if own.iter().all(|weight| *weight == 0.0) {
                continue;
            }
            let dual = self.case_dual(index, control, states, own).state;
            let (positions, _) = case.shape.position_sensitivity(state, &dual).map_err(|e| named(&case.name, e))?;
            add(&positions, 1.0);
            let pressures = count - usize::from(case.field.is_some());
            if case.with_pressures {
                let own = Vector::from_column_slice(&own[..pressures]);
                add(&case.shape.output_position_gradient(state, &own), 1.0);
            }
            if let Some(field) = &case.field {
                add(&field.gradient(case.shape.problem(), StateView::of(state)).positions, own[pressures]);
            }
        }
        if let Some(shape) = &self.of_shape {
            add(&shape.slope(problem, control.as_slice()), weights[first]);
        }
        Ok(sum)
    }

    fn check(&self, control: &Vector) -> Result<(), OracleError> {
        Ok(InputError::check_vector("control", self.control_dimension(), control)?)
    }
}

impl StateSolver for LoadCases {
    type State = CaseStates;
    type WarmStart = Vec<ContactWarmStart>;

    fn control_dimension(&self) -> usize {
        self.cases[0].shape.control_dimension()
    }

    /// Each case begins at its own state of the warm start.
    fn solve(
        &self,
        control: &Vector,
        start: Option<&Vec<ContactWarmStart>>,
        accuracy: Accuracy,
    ) -> Result<Self::State, OracleError> {
        self.check(control)?;
        let state = |index: usize| {
            let case = &self.cases[index];
            let state = case.shape.solve(control, start.and_then(|start| start.get(index)), accuracy)?;
            let outputs = case.outputs(&state);
            Ok((state, outputs))
        };
        // The others take over the factors of the first.
        let mut states = self.on_all(0..1, state)?;
        states.extend(self.on_all(1..self.cases.len(), state)?);
        Ok(CaseStates::new(control.clone(), states))
    }

    fn warm_start(&self, states: &Self::State) -> Vec<ContactWarmStart> {
        self.cases.iter().zip(&**states).map(|(case, state)| case.shape.warm_start(state)).collect()
    }

    fn work(&self, states: &Self::State) -> usize {
        self.cases.iter().zip(&**states).map(|(case, state)| case.shape.work(state)).sum()
    }
}

impl Coderivative for LoadCases {
    /// The sum over the cases; nothing is solved for a case whose dual is zero.
    fn coderivative(
        &self,
        control: &Vector,
        states: &Self::State,
        direction: &Vector,
    ) -> Result<Sensitivity, OracleError> {
        let expected = (0..self.cases.len()).map(|index| self.dual_count(index)).sum();
        if direction.len() != expected {
            return Err(InputError::Dimension { what: "dual of the states", expected, found: direction.len() }.into());
        }
        let part = |index: usize| {
            let own = self.part(index, direction);
            let is_zero = self.cases.len() > 1 && own.iter().all(|entry| *entry == 0.0);
            let solve = || self.cases[index].shape.coderivative(control, &states[index], &own);
            if is_zero { Ok(Sensitivity::exact(Vector::zeros(control.len()))) } else { solve() }
        };
        let mut parts = self.on_all(0..self.cases.len(), part)?.into_iter();
        let first = parts.next().unwrap_or_else(|| Sensitivity::exact(Vector::zeros(control.len())));
        Ok(parts.fold(first, |sum, part| Sensitivity {
            element: sum.element + part.element,
            error_bound: sum.error_bound + part.error_bound,
        }))
    }
}

impl OutputJacobian for LoadCases {
    fn outputs(&self, states: &Self::State) -> Vector {
        let mut outputs: Vec<f64> = (0..self.cases.len()).flat_map(|index| states.outputs(index)).copied().collect();
        let value = |shape: &ShapeFunction| shape.value(self.cases[0].shape.problem(), states.control.as_slice());
        outputs.extend(self.of_shape.iter().map(value));
        outputs.extend(self.fairness.iter().flat_map(|rows| (rows * &states.control).as_slice().to_vec()));
        Vector::from_vec(outputs)
    }

    fn output_dual(&self, control: &Vector, states: &Self::State, weights: &Vector) -> CostGradient {
        let (mut explicit, mut duals, mut first) = (Vector::zeros(control.len()), Vec::new(), 0);
        for index in 0..self.cases.len() {
            let count = states.outputs(index).len();
            let own = self.case_dual(index, control, states, &weights.as_slice()[first..first + count]);
            explicit += own.control;
            duals.extend_from_slice(own.state.as_slice());
            first += count;
        }
        if let Some(shape) = &self.of_shape {
            explicit += shape.gradient(self.cases[0].shape.problem(), control.as_slice()) * weights[first];
            first += 1;
        }
        if let Some(rows) = &self.fairness {
            explicit += rows.tr_mul(&weights.rows(first, rows.nrows()));
        }
        CostGradient { control: explicit, state: Vector::from_vec(duals) }
    }

    fn linearize(
        &self,
        control: &Vector,
        states: &Self::State,
        accuracy: Accuracy,
    ) -> Result<Linearization, OracleError> {
        self.check(control)?;
        let mut parts =
            self.on_all(0..self.cases.len(), |index| self.linearize_case(index, control, states, accuracy))?;
        if let Some(shape) = &self.of_shape {
            let problem = self.cases[0].shape.problem();
            let outputs = Vector::from_element(1, shape.value(problem, control.as_slice()));
            let slope = shape.gradient(problem, control.as_slice());
            let jacobian = Matrix::from_row_slice(1, control.len(), slope.as_slice());
            parts.push(Linearization { outputs, jacobian, accuracy: 0.0, inactive: None });
        }
        if let Some(rows) = &self.fairness {
            let (outputs, jacobian) = (rows * control, rows.clone());
            parts.push(Linearization { outputs, jacobian, accuracy: 0.0, inactive: None });
        }
        Ok(stacked(parts, control.len()))
    }
}

/// Linearizations one below the other.
fn stacked(parts: Vec<Linearization>, dimension: usize) -> Linearization {
    let empty = || (Vector::zeros(0), Matrix::zeros(0, dimension));
    let ((outputs, jacobian), mut inactive, mut accuracy) = (empty(), None, 0.0_f64);
    let mut sum = (outputs, jacobian);
    let below = |(values, rows): (Vector, Matrix), (more, further): (Vector, Matrix)| {
        let (own, count) = (values.len(), values.len() + more.len());
        let mut values = values.resize_vertically(count, 0.0);
        let mut rows = rows.resize_vertically(count, 0.0);
        values.rows_mut(own, more.len()).copy_from(&more);
        rows.rows_mut(own, more.len()).copy_from(&further);
        (values, rows)
    };
    for part in parts {
        accuracy = accuracy.max(part.accuracy);
        sum = below(sum, (part.outputs, part.jacobian));
        if let Some(own) = part.inactive {
            let known: InactiveConstraints = inactive.unwrap_or_else(|| {
                let (slacks, jacobian) = empty();
                InactiveConstraints { slacks, jacobian }
            });
            let (slacks, jacobian) = below((known.slacks, known.jacobian), (own.slacks, own.jacobian));
            inactive = Some(InactiveConstraints { slacks, jacobian });
        }
    }
    Linearization { outputs: sum.0, jacobian: sum.1, accuracy, inactive }
}
