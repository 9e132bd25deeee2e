//! A contact solver whose work all processes of a run share; in a single process, the solver itself.

use crate::commands::processes::announcement::{Id, Shape, Task};
use crate::commands::processes::leader::Leader;
use contact::contact_shape::{AnySolver, AnyState};
use contact::equilibrium::{
    ContactProblem, ContactSolver, ContactState, ContactWarmStart, Diagnosis, Sensitivities, SolvedBody, SolverState,
    Tangents,
};
use contact::error::ContactError;
use std::sync::Arc;

/// A contact solver. Where there are several processes, this is the part of the first: each call is announced to the others, which
/// make the same call.
#[derive(Debug)]
pub struct SharedSolver {
    own: AnySolver,
    shared: Option<Name>,
}

/// What a [`SharedSolver`] keeps of a solved shape.
#[derive(Debug)]
pub struct SharedState {
    own: AnyState,
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

impl From<AnySolver> for SharedSolver {
    /// The solver of the only process.
    fn from(own: AnySolver) -> Self {
        Self { own, shared: None }
    }
}

impl SharedSolver {
    /// The part of the first process of a solver that all processes have prepared.
    pub fn led(own: AnySolver, id: Id, leader: Arc<Leader>) -> Self {
        Self { own, shared: Some(Name { id, leader }) }
    }

    /// A call with a state of this solver.
    fn call<T>(
        &self,
        state: &SharedState,
        task: impl FnOnce(Id, Id) -> Task,
        own: impl FnOnce(&AnySolver, &AnyState) -> Result<T, ContactError>,
        products: impl FnOnce(&T) -> usize,
    ) -> Result<T, ContactError> {
        match (&self.shared, &state.shared) {
            (Some(name), Some(of)) => name.leader.agreed(task(name.id, of.id), || own(&self.own, &state.own), products),
            (None, None) => own(&self.own, &state.own),
            _ => Err(ContactError::OtherSolver),
        }
    }
}

impl SolverState for SharedState {
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

impl ContactSolver for SharedSolver {
    type State = SharedState;

    fn problem(&self) -> &ContactProblem {
        self.own.problem()
    }

    fn sizes(&self) -> [usize; 2] {
        self.own.sizes()
    }

    fn left_out(&self) -> Option<&'static str> {
        self.own.left_out()
    }

    fn solve(
        &self,
        controls: &[f64],
        start: Option<&ContactWarmStart>,
        tolerance: f64,
    ) -> Result<ContactState<SharedState>, ContactError> {
        let own = || self.own.solve(controls, start, tolerance);
        let Some(Name { id, leader }) = &self.shared else {
            return Ok(own()?.map(|own| SharedState { own, shared: None }));
        };
        let of = Name { id: leader.name(), leader: Arc::clone(leader) };
        let shape = Shape { controls: controls.to_vec(), start: start.cloned(), tolerance };
        let products = |state: &ContactState<AnyState>| state.work().dual_operator_applications;
        let state = leader.agreed(Task::Solve(*id, of.id, Box::new(shape)), own, products)?;
        Ok(state.map(|own| SharedState { own, shared: Some(of) }))
    }

    fn sensitivities(
        &self,
        state: &SharedState,
        direction: &[f64],
        tolerance: f64,
    ) -> Result<Sensitivities, ContactError> {
        let task = |solver, state| Task::Sensitivities(solver, state, direction.to_vec(), tolerance);
        let own = |solver: &AnySolver, state: &AnyState| solver.sensitivities(state, direction, tolerance);
        self.call(state, task, own, |result| result.applications)
    }

    fn tangents(&self, state: &SharedState, changes: &[Vec<f64>], tolerance: f64) -> Result<Tangents, ContactError> {
        let task = |solver, state| Task::Tangents(solver, state, changes.to_vec(), tolerance);
        let own = |solver: &AnySolver, state: &AnyState| solver.tangents(state, changes, tolerance);
        self.call(state, task, own, |result| result.applications)
    }

    fn diagnose(&self, state: &SharedState) -> Result<Diagnosis, ContactError> {
        self.call(state, Task::Diagnose, AnySolver::diagnose, |_| 0)
    }

    fn estimate_contraction(&self, state: &SharedState, max_products: usize) -> Result<f64, ContactError> {
        let task = |solver, state| Task::Contraction(solver, state, max_products);
        self.call(state, task, |solver, state| solver.estimate_contraction(state, max_products), |_| 0)
    }

    /// Every process condenses whole bodies, so that none waits for another.
    fn force_rounding(&self, state: &SharedState) -> Result<f64, ContactError> {
        self.own.force_rounding(&state.own)
    }

    fn bodies(&self, state: &SharedState) -> Result<Vec<SolvedBody>, ContactError> {
        self.call(state, Task::Bodies, AnySolver::bodies, |_| 0)
    }
}
