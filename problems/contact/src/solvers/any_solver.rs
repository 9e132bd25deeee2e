//! A contact solver whose kind is chosen when the program runs, and whose work all processes of a run share.

use crate::direct::DirectSolver;
use crate::equilibrium::{
    ContactProblem, ContactSolver, ContactState, ContactWarmStart, Diagnosis, Sensitivities, SolvedBody, SolverState,
    Tangents, TangentsOf,
};
use crate::error::ContactError;
use crate::solvers::announcement::{Id, Shape, Task};
use crate::solvers::leader::Leader;
use crate::solvers::own_solver::OwnSolver;
use crate::solvers::own_state::OwnState;
use crate::tfeti::{TornState, TotalFeti};
use std::sync::Arc;

/// A contact solver of any kind. Where there are several processes, this is the part of the first: each call is
/// announced to the others, which make the same call.
#[derive(Debug)]
pub struct AnySolver {
    own: OwnSolver,
    shared: Option<Name>,
}

/// What an [`AnySolver`] keeps of a solved shape.
#[derive(Debug)]
pub struct AnyState {
    own: OwnState,
    shared: Option<Name>,
}

/// The name of a solver or a state in all processes, which may forget it with this value.
#[derive(Debug)]
struct Name {
    id: Id,
    leader: Arc<Leader>,
}

impl Drop for Name {
    fn drop(&mut self) {
        self.leader.release(self.id);
    }
}

impl From<OwnSolver> for AnySolver {
    /// The solver of the only process.
    fn from(own: OwnSolver) -> Self {
        Self { own, shared: None }
    }
}

impl From<TotalFeti> for AnySolver {
    fn from(solver: TotalFeti) -> Self {
        OwnSolver::from(solver).into()
    }
}

impl From<DirectSolver> for AnySolver {
    fn from(solver: DirectSolver) -> Self {
        OwnSolver::from(solver).into()
    }
}

impl AnyState {
    /// The state of total FETI; none of direct condensation.
    pub fn torn(&self) -> Option<&TornState> {
        match &self.own {
            OwnState::Torn(state) => Some(state),
            OwnState::Direct(_) => None,
        }
    }
}

impl AnySolver {
    /// The part of the first process of a solver that all processes have prepared.
    pub(super) fn led(own: OwnSolver, id: Id, leader: Arc<Leader>) -> Self {
        Self { own, shared: Some(Name { id, leader }) }
    }

    /// A call with a state of this solver.
    fn call<T>(
        &self,
        state: &AnyState,
        task: impl FnOnce(Id, Id) -> Task,
        own: impl FnOnce(&OwnSolver, &OwnState) -> Result<T, ContactError>,
        products: impl FnOnce(&T) -> usize,
    ) -> Result<T, ContactError> {
        match (&self.shared, &state.shared) {
            (Some(name), Some(of)) => name.leader.agreed(task(name.id, of.id), || own(&self.own, &state.own), products),
            (None, None) => own(&self.own, &state.own),
            _ => Err(ContactError::OtherSolver),
        }
    }
}

impl SolverState for AnyState {
    fn warm_start(&self) -> ContactWarmStart {
        match &self.shared {
            None => self.own.warm_start(),
            Some(name) => name
                .leader
                .together(Task::WarmStart(name.id), || self.own.warm_start())
                .expect("invariant: a name has a form in bytes"),
        }
    }
}

impl ContactSolver for AnySolver {
    type State = AnyState;

    fn problem(&self) -> &ContactProblem {
        self.own.problem()
    }

    fn sizes(&self) -> [usize; 2] {
        self.own.sizes()
    }

    fn left_out(&self) -> Option<&'static str> {
        self.own.left_out()
    }

    fn is_shared(&self) -> bool {
        self.shared.is_some()
    }

    fn solve(
        &self,
        controls: &[f64],
        start: Option<&ContactWarmStart>,
        tolerance: f64,
    ) -> Result<ContactState<AnyState>, ContactError> {
        let own = || self.own.solve(controls, start, tolerance);
        let Some(Name { id, leader }) = &self.shared else {
            return Ok(own()?.map(|own| AnyState { own, shared: None }));
        };
        let of = Name { id: leader.name(), leader: Arc::clone(leader) };
        let shape = Shape { controls: controls.to_vec(), start: start.cloned(), tolerance };
        let products = |state: &ContactState<OwnState>| state.work().dual_operator_applications;
        let state = leader.agreed(Task::Solve(*id, of.id, Box::new(shape)), own, products)?;
        Ok(state.map(|own| AnyState { own, shared: Some(of) }))
    }

    fn sensitivities(
        &self,
        state: &AnyState,
        direction: &[f64],
        tolerance: f64,
    ) -> Result<Sensitivities, ContactError> {
        let task = |solver, state| Task::Sensitivities(solver, state, direction.to_vec(), tolerance);
        let own = |solver: &OwnSolver, state: &OwnState| solver.sensitivities(state, direction, tolerance);
        self.call(state, task, own, |result| result.applications)
    }

    fn tangents(
        &self,
        state: &AnyState,
        changes: &[Vec<f64>],
        of: TangentsOf,
        tolerance: f64,
    ) -> Result<Tangents, ContactError> {
        let task = |solver, state| Task::Tangents(solver, state, changes.to_vec(), of, tolerance);
        let own = |solver: &OwnSolver, state: &OwnState| solver.tangents(state, changes, of, tolerance);
        self.call(state, task, own, |result| result.applications)
    }

    fn diagnose(&self, state: &AnyState) -> Result<Diagnosis, ContactError> {
        self.call(state, Task::Diagnose, OwnSolver::diagnose, |_| 0)
    }

    fn estimate_contraction(&self, state: &AnyState, max_products: usize) -> Result<f64, ContactError> {
        let task = |solver, state| Task::Contraction(solver, state, max_products);
        self.call(state, task, |solver, state| solver.estimate_contraction(state, max_products), |_| 0)
    }

    /// Every process condenses whole bodies, so that none waits for another.
    fn force_rounding(&self, state: &AnyState) -> Result<f64, ContactError> {
        self.own.force_rounding(&state.own)
    }

    fn bodies(&self, state: &AnyState) -> Result<Vec<SolvedBody>, ContactError> {
        self.call(state, Task::Bodies, OwnSolver::bodies, |_| 0)
    }
}
