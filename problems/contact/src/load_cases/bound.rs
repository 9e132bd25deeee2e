//! A limit of one case as a constraint of the optimizer, where it is no function of the outputs.

use crate::contact_shape::unit_changes;
use crate::cost::{
    FieldCost, FieldMeasure, FieldPiece, Limit, LimitSide, LimitedQuantity, PressureCost, PressureMeasure, volume,
    volume_gradient,
};
use crate::equilibrium::{ContactProblem, ContactState};
use crate::error::SceneError;
use crate::load_cases::{CaseStates, LoadCases};
use nonsmooth::composite::OuterFunction;
use nonsmooth::{ConstraintKind, Cost, CostGradient, OracleError, Vector};

/// A limit in one case, on the mesh of that case.
#[derive(Debug)]
pub struct Bound {
    /// The limit, with its case.
    pub limit: Limit,
    /// The number of the case; that of the first for the volume.
    pub case: usize,
    quantity: Quantity,
    kind: ConstraintKind,
}

/// What is bounded, on the mesh of the case.
#[derive(Debug)]
enum Quantity {
    /// The peak pressure, a function of the outputs.
    PeakPressure,
    LoadedArea(PressureCost),
    Field(FieldCost),
    /// The volume over this one, mm³.
    Volume(f64),
}

/// Value and gradient of a constraint, and further linearizations at the point.
pub(crate) struct Linearized {
    pub value: f64,
    pub gradient: Vector,
    pub pieces: Vec<(f64, Vector)>,
}

impl Bound {
    /// All limits of some cases with these names and problems, in the order of the constraints of the optimizer: peak
    /// pressures first, case by case.
    ///
    /// # Errors
    /// As [`PressureCost::new`] and [`FieldCost::new`]; [`SceneError::OutOfRange`] for a limit of an unknown case, and
    /// for a bound that means nothing.
    pub fn all(limits: &[Limit], cases: &[(&str, &ContactProblem)]) -> Result<Vec<Self>, SceneError> {
        let names: Vec<&str> = cases.iter().map(|(name, _)| *name).collect();
        let limits = Limit::of_cases(limits, &names)?;
        let bounds = limits.into_iter().map(|(limit, case)| Self::new(limit, case, cases[case].1));
        bounds.collect()
    }

    fn new(mut limit: Limit, case: usize, problem: &ContactProblem) -> Result<Self, SceneError> {
        let start = || volume(problem, &problem.scene.start());
        let quantity = match &limit.quantity {
            LimitedQuantity::PeakPressure => Quantity::PeakPressure,
            &LimitedQuantity::LoadedArea { pressure } => {
                Quantity::LoadedArea(PressureCost::new(PressureMeasure::OpenArea { pressure }, problem)?)
            }
            LimitedQuantity::Field(measure) => Quantity::Field(FieldCost::named("limit", measure.clone(), problem)?),
            LimitedQuantity::RelativeVolume => Quantity::Volume(start()),
            LimitedQuantity::Volume => Quantity::Volume(1.0),
        };
        let kind = limit.kind()?;
        limit.typical = match &limit.quantity {
            LimitedQuantity::Field(FieldMeasure::Displacement { .. }) => problem.typical_displacement(),
            LimitedQuantity::Field(FieldMeasure::Compliance) => problem.load() * problem.typical_displacement(),
            _ => 0.0,
        };
        Ok(Self { limit, case, quantity, kind })
    }

    /// What it asks of the optimizer.
    pub fn kind(&self) -> ConstraintKind {
        self.kind
    }

    /// The constraint with its gradient where the shape alone decides it; `problem`: that of its case.
    pub fn of_shape(&self, problem: &ContactProblem, control: &Vector) -> Option<(f64, Vector)> {
        let Quantity::Volume(unit) = self.quantity else { return None };
        let value = self.limit.constraint(volume(problem, control.as_slice()) / unit);
        Some((value, volume_gradient(problem, control.as_slice()) * (self.limit.sign() / unit)))
    }

    /// Whether it depends on the displacements, and whether it has further linearizations then.
    pub(crate) fn fields(&self) -> [bool; 2] {
        match &self.quantity {
            Quantity::Field(cost) => [true, !cost.is_smooth() && self.has_pieces()],
            _ => [false; 2],
        }
    }

    /// Whether pieces below the largest one are linearizations of the constraint: it is a maximum of them.
    fn has_pieces(&self) -> bool {
        let least =
            matches!(self.limit.quantity, LimitedQuantity::Field(FieldMeasure::Displacement { least: true, .. }));
        (self.limit.side == LimitSide::AtLeast) == least
    }

    /// The limited quantity at a state of its case.
    pub(crate) fn value<S>(&self, problem: &ContactProblem, control: &Vector, state: &ContactState<S>) -> f64 {
        match &self.quantity {
            Quantity::PeakPressure => {
                let pressures = state.rows.pressures(&state.forces.normal).into_iter();
                pressures.fold(f64::NEG_INFINITY, f64::max)
            }
            Quantity::LoadedArea(open) => state.rows.area() - open.value_of(state),
            Quantity::Field(cost) => Cost::value(cost, control, state),
            Quantity::Volume(unit) => volume(problem, control.as_slice()) / unit,
        }
    }

    /// The constraint at the states of a shape.
    ///
    /// # Errors
    /// [`OracleError`] of the adjoint.
    pub(crate) fn linearized(
        &self,
        cases: &LoadCases,
        control: &Vector,
        states: &CaseStates,
    ) -> Result<Linearized, OracleError> {
        let (problem, state) = (cases.case(self.case).problem(), &states[self.case]);
        if let Some((value, gradient)) = self.of_shape(problem, control) {
            return Ok(Linearized { value, gradient, pieces: Vec::new() });
        }
        let value = self.limit.constraint(self.value(problem, control, state));
        let gradient = match &self.quantity {
            Quantity::Field(cost) => {
                if let Some(found) = self.by_tangents(cost, cases, states) {
                    return Ok(found);
                }
                cases.gradient(self.case, states, &Cost::gradient(cost, control, state))?
            }
            Quantity::LoadedArea(open) => {
                let outputs = open.outputs(false);
                let [forces, areas] = [&state.forces.normal, &state.rows.areas()];
                let weights = OuterFunction::subgradient(open, &outputs.values(forces, areas).into());
                let [by_force, by_area] = outputs.pull_back(forces, areas, weights.as_slice());
                let by_area: Vec<f64> = by_area.iter().map(|slope| 1.0 - slope).collect();
                let mut dual = Vector::zeros(cases.dual_count(self.case));
                problem
                    .boundary
                    .contact_points()
                    .iter()
                    .zip(by_force)
                    .for_each(|(point, slope)| dual[point.start] = -slope);
                let positions = problem.pull_back_areas(&state.rows, &by_area);
                let explicit = Vector::from_vec(problem.map.pull_back(&positions));
                cases.gradient(self.case, states, &CostGradient { control: explicit, state: dual })?
            }
            // A function of the outputs, and one of the shape.
            Quantity::PeakPressure | Quantity::Volume(_) => Vector::zeros(control.len()),
        };
        Ok(Linearized { value, gradient: gradient * self.limit.sign(), pieces: Vec::new() })
    }

    /// By forward derivatives of the displacements: all points near the extreme one. None where these are not known.
    fn by_tangents(&self, cost: &FieldCost, cases: &LoadCases, states: &CaseStates) -> Option<Linearized> {
        let tangents = states.tangents(self.case).filter(|_| self.has_pieces())?;
        let map = &cases.case(self.case).problem().map;
        let changes = unit_changes(states.control.len());
        let velocities = map.velocities(&changes);
        let pieces = cost.pieces_of(states[self.case].bodies.as_deref()?);
        let row = |piece: &FieldPiece| Vector::from_vec(piece.row(tangents, &velocities)) * self.limit.sign();
        let mut linear = pieces.iter().map(|piece| (self.limit.constraint(piece.value), row(piece)));
        let (value, gradient) = linear.next()?;
        Some(Linearized { value, gradient, pieces: linear.collect() })
    }
}
