//! A contact solver whose kind is chosen when the program runs. Where the kind is known, [`ContactSolver`] is used directly.

use crate::direct::DirectSolver;
use crate::equilibrium::{
    AnyState, ContactProblem, ContactSolver, ContactState, ContactWarmStart, Diagnosis, Sensitivities, SolvedBody,
    SolverState,
};
use crate::error::ContactError;
use crate::solver_kind::SolverKind;
use crate::tfeti::{DualMethod, PreconditionerKind, Recycling, TotalFeti};
use std::any::Any;
use std::sync::Arc;

/// A contact solver of any kind.
pub type AnySolver = dyn ContactSolver<State = AnyState>;

/// The solver of a kind; `preconditioner` is for total FETI.
///
/// # Errors
/// [`ContactError::Factorization`] when a symbolic analysis fails.
pub fn any_solver(
    problem: Arc<ContactProblem>,
    kind: SolverKind,
    preconditioner: PreconditionerKind,
) -> Result<Box<AnySolver>, ContactError> {
    let torn = |problem, method| TotalFeti::new(problem, preconditioner, method).map(erase);
    match kind {
        SolverKind::Newton => torn(problem, DualMethod::Newton(Recycling::default())),
        SolverKind::AugmentedLagrangian => torn(problem, DualMethod::SuccessiveApproximations),
        SolverKind::Direct => DirectSolver::new(problem).map(erase),
    }
}

/// Forgets the kind of a solver.
pub fn erase<S: ContactSolver + 'static>(solver: S) -> Box<AnySolver> {
    Box::new(Erased(solver))
}

/// A solver that looks whether a state is its own.
#[derive(Debug)]
struct Erased<S>(S);

fn own<S: SolverState>(state: &AnyState) -> Result<&S, ContactError> {
    let state: &dyn Any = state.as_ref();
    state.downcast_ref().ok_or(ContactError::OtherSolver)
}

impl<S: ContactSolver> ContactSolver for Erased<S> {
    type State = AnyState;

    fn problem(&self) -> &ContactProblem {
        self.0.problem()
    }

    fn sizes(&self) -> [usize; 2] {
        self.0.sizes()
    }

    fn left_out(&self) -> Option<&'static str> {
        self.0.left_out()
    }

    fn solve(
        &self,
        controls: &[f64],
        start: Option<&ContactWarmStart>,
        tolerance: f64,
    ) -> Result<ContactState<AnyState>, ContactError> {
        Ok(self.0.solve(controls, start, tolerance)?.map(|solution| Box::new(solution) as AnyState))
    }

    fn sensitivities(
        &self,
        state: &AnyState,
        direction: &[f64],
        tolerance: f64,
    ) -> Result<Sensitivities, ContactError> {
        self.0.sensitivities(own(state)?, direction, tolerance)
    }

    fn diagnose(&self, state: &AnyState) -> Result<Diagnosis, ContactError> {
        self.0.diagnose(own(state)?)
    }

    fn bodies(&self, state: &AnyState) -> Result<Vec<SolvedBody>, ContactError> {
        self.0.bodies(own(state)?)
    }

    fn strain_energy(&self, state: &AnyState) -> Option<f64> {
        self.0.strain_energy(own(state).ok()?)
    }
}
