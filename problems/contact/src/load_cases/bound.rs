//! A quantity of one case on its mesh: a limit as a constraint of the optimizer, or what is told.

use crate::contact_shape::unit_changes;
use crate::cost::{Limit, LimitSide, Quantity, Reported, ShapeFunction, StateCost, StatePiece, StateView};
use crate::equilibrium::{ContactProblem, ContactState};
use crate::error::SceneError;
use crate::load_cases::{CaseStates, LoadCases};
use nonsmooth::{ConstraintKind, OracleError, Vector};

/// A limit in one case, on the mesh of that case.
#[derive(Debug)]
pub struct Bound {
    /// The limit, with its case.
    pub limit: Limit,
    /// The number of the case; that of the first for functions of the shape.
    pub case: usize,
    rated: Rated,
    kind: ConstraintKind,
}

/// A report in one case, on the mesh of that case.
#[derive(Debug)]
pub struct Told {
    /// The report, with its case.
    pub report: Reported,
    /// As [`Bound::case`].
    pub case: usize,
    rated: Rated,
}

/// A quantity on the mesh of a case.
#[derive(Debug)]
enum Rated {
    State(Box<StateCost>),
    Shape(ShapeFunction),
}

impl Rated {
    fn new(place: &str, quantity: &Quantity, problem: &ContactProblem) -> Result<Self, SceneError> {
        if let Some(shape) = ShapeFunction::new(place, quantity, problem)? {
            return Ok(Self::Shape(shape));
        }
        let field = || format!("{place}.quantity");
        let refused = || SceneError::out_of_range(field(), quantity.name(), "a quantity of states or shapes");
        Ok(Self::State(Box::new(StateCost::new(place, quantity, problem)?.ok_or_else(refused)?)))
    }

    fn needs_displacements(&self) -> bool {
        matches!(self, Self::State(state) if state.needs_displacements())
    }

    fn value<S>(&self, problem: &ContactProblem, control: &Vector, state: &ContactState<S>) -> f64 {
        match self {
            Self::State(own) => own.value(problem, StateView::of(state)),
            Self::Shape(own) => own.value(problem, control.as_slice()),
        }
    }
}

impl Told {
    /// All reports of some cases with these names and problems.
    ///
    /// # Errors
    /// As [`StateCost::new`]; [`SceneError::OutOfRange`] for a report of an unknown case.
    pub fn all(reports: &[Reported], cases: &[(&str, &ContactProblem)]) -> Result<Vec<Self>, SceneError> {
        let names: Vec<&str> = cases.iter().map(|(name, _)| *name).collect();
        let mut all = Vec::new();
        for (index, report) in reports.iter().enumerate() {
            let place = format!("report[{index}]");
            for (report, case) in report.in_cases(&place, &names)? {
                let rated = Rated::new(&place, &report.quantity, cases[case].1)?;
                all.push(Self { report, case, rated });
            }
        }
        Ok(all)
    }

    /// Whether it depends on the displacements.
    pub(crate) fn needs_displacements(&self) -> bool {
        self.rated.needs_displacements()
    }

    /// The quantity at a state of its case.
    pub(crate) fn value<S>(&self, problem: &ContactProblem, control: &Vector, state: &ContactState<S>) -> f64 {
        self.rated.value(problem, control, state)
    }
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
    /// As [`StateCost::new`]; [`SceneError::OutOfRange`] for a limit of an unknown case, and
    /// for a bound that means nothing.
    pub fn all(limits: &[Limit], cases: &[(&str, &ContactProblem)]) -> Result<Vec<Self>, SceneError> {
        let names: Vec<&str> = cases.iter().map(|(name, _)| *name).collect();
        let limits = Limit::of_cases(limits, &names)?;
        let bounds = limits.into_iter().map(|(limit, case)| Self::new(limit, case, cases[case].1));
        bounds.collect()
    }

    fn new(mut limit: Limit, case: usize, problem: &ContactProblem) -> Result<Self, SceneError> {
        let kind = limit.kind()?;
        let rated = Rated::new("limit", &limit.quantity, problem)?;
        if let Rated::State(state) = &rated {
            limit.typical = state.typical(problem);
        }
        Ok(Self { limit, case, rated, kind })
    }

    /// What it asks of the optimizer.
    pub fn kind(&self) -> ConstraintKind {
        self.kind
    }

    /// The constraint with its gradient where the shape alone decides it; `problem`: that of its case.
    pub fn of_shape(&self, problem: &ContactProblem, control: &Vector) -> Option<(f64, Vector)> {
        let Rated::Shape(shape) = &self.rated else { return None };
        let value = self.limit.constraint(shape.value(problem, control.as_slice()));
        Some((value, shape.gradient(problem, control.as_slice()) * self.limit.sign()))
    }

    /// Whether it depends on the displacements, and whether it has further linearizations then.
    pub(crate) fn fields(&self) -> [bool; 2] {
        [self.rated.needs_displacements(), self.pieces_of().is_some()]
    }

    /// The quantity where pieces below the largest one are linearizations of the constraint: it is a maximum of them.
    fn pieces_of(&self) -> Option<&StateCost> {
        let Rated::State(state) = &self.rated else { return None };
        let least = matches!(self.limit.quantity, Quantity::Displacement { least: true, .. });
        (state.has_pieces() && (self.limit.side == LimitSide::AtLeast) == least).then_some(state)
    }

    /// The limited quantity at a state of its case.
    pub(crate) fn value<S>(&self, problem: &ContactProblem, control: &Vector, state: &ContactState<S>) -> f64 {
        self.rated.value(problem, control, state)
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
        let of_quantity = self.quantity_pieces(cases, control, states)?.into_iter();
        let mut linear = of_quantity.map(|(value, slope)| (self.limit.constraint(value), slope * self.limit.sign()));
        let Some((value, gradient)) = linear.next() else {
            let reason = format!("no value of {}", self.limit.quantity.name());
            return Err(OracleError::OutsideDomain { reason });
        };
        Ok(Linearized { value, gradient, pieces: linear.collect() })
    }

    /// Values and gradients of the limited quantity at the states of a shape: one where it is smooth or where forward
    /// derivatives are not known, else those of all points near the extreme one, which comes first.
    ///
    /// # Errors
    /// [`OracleError`] of the adjoint.
    pub(crate) fn quantity_pieces(
        &self,
        cases: &LoadCases,
        control: &Vector,
        states: &CaseStates,
    ) -> Result<Vec<(f64, Vector)>, OracleError> {
        let problem = cases.case(self.case).problem();
        let own = match &self.rated {
            Rated::State(own) => own,
            Rated::Shape(shape) => {
                let value = shape.value(problem, control.as_slice());
                return Ok(vec![(value, shape.gradient(problem, control.as_slice()))]);
            }
        };
        if let Some(found) = self.by_tangents(cases, states) {
            return Ok(found);
        }
        let at = StateView::of(&states[self.case]);
        let gradient = cases.gradient(self.case, states, &own.gradient(problem, at).pulled(problem))?;
        Ok(vec![(own.value(problem, at), gradient)])
    }

    /// By forward derivatives of the displacements: all points near the extreme one. None where these are not known.
    fn by_tangents(&self, cases: &LoadCases, states: &CaseStates) -> Option<Vec<(f64, Vector)>> {
        let (own, tangents) = (self.pieces_of()?, states.tangents(self.case)?);
        let problem = cases.case(self.case).problem();
        let changes = unit_changes(states.control.len());
        let velocities = problem.map.velocities(&changes);
        let pieces = own.pieces(problem, StateView::of(&states[self.case]));
        let row = |piece: &StatePiece| (piece.value, Vector::from_vec(piece.row(tangents, &velocities)));
        Some(pieces.iter().map(row).collect()).filter(|rows: &Vec<_>| !rows.is_empty())
    }
}
