//! A contact solver whose kind is chosen when the program runs.

use crate::any_state::AnyState;
use crate::auto_solver::{AutoSolver, Wanted};
use crate::communication::Communication;
use crate::direct::DirectSolver;
use crate::equilibrium::{
    ContactProblem, ContactSolver, ContactState, ContactWarmStart, Diagnosis, Sensitivities, SolvedBody, Tangents,
};
use crate::error::ContactError;
use crate::solver_kind::SolverKind;
use crate::tfeti::{DualMethod, PreconditionerKind, TornOptions, TotalFeti};
use std::sync::Arc;

/// A contact solver of any kind.
#[derive(Debug)]
pub enum AnySolver {
    /// Total FETI.
    Torn(Box<TotalFeti>),
    /// Direct condensation.
    Direct(Box<DirectSolver>),
    /// Whichever of the two finds a state.
    Auto(Box<AutoSolver>),
}

impl From<TotalFeti> for AnySolver {
    fn from(solver: TotalFeti) -> Self {
        Self::Torn(Box::new(solver))
    }
}

impl From<DirectSolver> for AnySolver {
    fn from(solver: DirectSolver) -> Self {
        Self::Direct(Box::new(solver))
    }
}

impl AnySolver {
    /// The solver of a kind, in one process of those that `communication` connects; `preconditioner` is for total FETI, `wanted`
    /// for the choice of `auto`.
    ///
    /// # Errors
    /// [`ContactError::Factorization`] when a symbolic analysis fails.
    pub fn new(
        problem: Arc<ContactProblem>,
        kind: SolverKind,
        preconditioner: PreconditionerKind,
        wanted: Wanted,
        communication: Arc<dyn Communication>,
    ) -> Result<Self, ContactError> {
        let options = TornOptions { preconditioner, communication, ..TornOptions::default() };
        match kind {
            SolverKind::Auto => Ok(Self::Auto(Box::new(AutoSolver::new(problem, options, wanted)?))),
            SolverKind::Newton => TotalFeti::new(problem, options).map(Self::from),
            SolverKind::AugmentedLagrangian => {
                let solver = TotalFeti::new(problem, options)?;
                Ok(Self::from(solver.with_method(DualMethod::SuccessiveApproximations)))
            }
            SolverKind::Direct => DirectSolver::new(problem).map(Self::from),
        }
    }

    fn torn(&self) -> Result<&TotalFeti, ContactError> {
        match self {
            Self::Torn(solver) => Ok(solver),
            Self::Direct(_) => Err(ContactError::OtherSolver),
            Self::Auto(solver) => solver.torn(),
        }
    }

    fn direct(&self) -> Result<&DirectSolver, ContactError> {
        match self {
            Self::Torn(_) => Err(ContactError::OtherSolver),
            Self::Direct(solver) => Ok(solver),
            Self::Auto(solver) => solver.direct(),
        }
    }
}

impl ContactSolver for AnySolver {
    type State = AnyState;

    fn problem(&self) -> &ContactProblem {
        match self {
            Self::Torn(solver) => solver.problem(),
            Self::Direct(solver) => solver.problem(),
            Self::Auto(solver) => solver.problem(),
        }
    }

    fn sizes(&self) -> [usize; 2] {
        match self {
            Self::Torn(solver) => solver.sizes(),
            Self::Direct(solver) => solver.sizes(),
            Self::Auto(solver) => solver.sizes(),
        }
    }

    fn left_out(&self) -> Option<&'static str> {
        match self {
            Self::Torn(solver) => solver.left_out(),
            Self::Direct(solver) => solver.left_out(),
            Self::Auto(solver) => solver.left_out(),
        }
    }

    fn solve(
        &self,
        controls: &[f64],
        start: Option<&ContactWarmStart>,
        tolerance: f64,
    ) -> Result<ContactState<AnyState>, ContactError> {
        match self {
            Self::Torn(solver) => Ok(solver.solve(controls, start, tolerance)?.map(AnyState::from)),
            Self::Direct(solver) => Ok(solver.solve(controls, start, tolerance)?.map(AnyState::from)),
            Self::Auto(solver) => solver.solve(controls, start, tolerance),
        }
    }

    fn sensitivities(
        &self,
        state: &AnyState,
        direction: &[f64],
        tolerance: f64,
    ) -> Result<Sensitivities, ContactError> {
        match state {
            AnyState::Torn(state) => match self {
                Self::Auto(solver) => solver.sensitivities(state, direction, tolerance),
                _ => self.torn()?.sensitivities(state, direction, tolerance),
            },
            AnyState::Direct(state) => self.direct()?.sensitivities(state, direction, tolerance),
        }
    }

    fn tangents(&self, state: &AnyState, changes: &[Vec<f64>], tolerance: f64) -> Result<Tangents, ContactError> {
        match state {
            AnyState::Torn(state) => match self {
                Self::Auto(solver) => solver.tangents(state, changes, tolerance),
                _ => self.torn()?.tangents(state, changes, tolerance),
            },
            AnyState::Direct(state) => self.direct()?.tangents(state, changes, tolerance),
        }
    }

    fn diagnose(&self, state: &AnyState) -> Result<Diagnosis, ContactError> {
        match state {
            AnyState::Torn(state) => self.torn()?.diagnose(state),
            AnyState::Direct(state) => self.direct()?.diagnose(state),
        }
    }

    fn estimate_contraction(&self, state: &AnyState, max_products: usize) -> Result<f64, ContactError> {
        match state {
            AnyState::Torn(state) => self.torn()?.estimate_contraction(state, max_products),
            AnyState::Direct(state) => self.direct()?.estimate_contraction(state, max_products),
        }
    }

    fn force_rounding(&self, state: &AnyState) -> Result<f64, ContactError> {
        match state {
            AnyState::Torn(state) => self.torn()?.force_rounding(state),
            AnyState::Direct(state) => self.direct()?.force_rounding(state),
        }
    }

    fn bodies(&self, state: &AnyState) -> Result<Vec<SolvedBody>, ContactError> {
        match state {
            AnyState::Torn(state) => self.torn()?.bodies(state),
            AnyState::Direct(state) => self.direct()?.bodies(state),
        }
    }
}
