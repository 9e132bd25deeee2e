//! The contact solver of a scene: its kind is chosen when the program runs, and all processes of a run share its work.

use crate::direct::DirectSolver;
use crate::equilibrium::{
    ContactProblem, ContactState, ContactWarmStart, Diagnosis, Sensitivities, SolvedBody, Tangents, TangentsOf,
};
use crate::error::ContactError;
use crate::solvers::announcement::{Id, Shape, Task};
use crate::solvers::call::{Call, Reply};
use crate::solvers::leader::Leader;
use crate::solvers::own_solver::OwnSolver;
use crate::solvers::own_state::OwnState;
use crate::tfeti::{TornState, TotalFeti};
use std::sync::Arc;

/// A contact solver of any kind. Where there are several processes, this is the part of the first: each call is
/// announced to the others, which make the same call.
///
/// A state belongs to the solver that found it. That of another mesh is refused with [`ContactError::ForeignState`],
/// that of a solver of another kind with [`ContactError::OtherSolver`].
#[derive(Debug)]
pub struct Solver {
    own: OwnSolver,
    shared: Option<Name>,
}

/// What a [`Solver`] keeps of a solved shape for derivative, diagnosis and displacements.
#[derive(Debug)]
pub struct SolverState {
    own: OwnState,
    shared: Option<Name>,
}

/// The name of a solver or a state in all processes, which may forget it with this value.
#[derive(Debug)]
struct Name {
    id: Id,
    leader: Arc<Leader>,
}

/// Why a reply is of the variant of its call.
const SAME_VARIANT: &str = "invariant: a reply has the variant of its call";

impl Drop for Name {
    fn drop(&mut self) {
        self.leader.release(self.id);
    }
}

impl From<OwnSolver> for Solver {
    /// The solver of the only process.
    fn from(own: OwnSolver) -> Self {
        Self { own, shared: None }
    }
}

impl From<TotalFeti> for Solver {
    fn from(solver: TotalFeti) -> Self {
        OwnSolver::from(solver).into()
    }
}

impl From<DirectSolver> for Solver {
    fn from(solver: DirectSolver) -> Self {
        OwnSolver::from(solver).into()
    }
}

impl SolverState {
    /// The state of total FETI; none of direct condensation.
    pub fn torn(&self) -> Option<&TornState> {
        match &self.own {
            OwnState::Torn(state) => Some(state),
            OwnState::Direct(_) => None,
        }
    }

    /// What a similar shape can be solved from.
    pub fn warm_start(&self) -> ContactWarmStart {
        match &self.shared {
            None => self.own.warm_start(),
            Some(name) => name
                .leader
                .together(Task::WarmStart(name.id), || self.own.warm_start())
                .expect("invariant: a name has a form in bytes"),
        }
    }
}

impl Solver {
    /// The part of the first process of a solver that all processes have prepared.
    pub(super) fn led(own: OwnSolver, id: Id, leader: Arc<Leader>) -> Self {
        Self { own, shared: Some(Name { id, leader }) }
    }

    /// The problem that is solved.
    pub fn problem(&self) -> &ContactProblem {
        self.own.problem()
    }

    /// Number of degrees of freedom of all bodies, and number of multipliers.
    pub fn sizes(&self) -> [usize; 2] {
        self.own.sizes()
    }

    /// What this solver did not need for its scene, in words.
    pub fn left_out(&self) -> Option<&'static str> {
        self.own.left_out()
    }

    /// Whether several processes share the work: all of them must make the same calls in the same order.
    pub fn is_shared(&self) -> bool {
        self.shared.is_some()
    }

    /// Solves one shape to a relative residual, from nothing or from a state of a similar shape. A start of another
    /// kind of solver is not used.
    ///
    /// # Errors
    /// [`ContactError`]: inverted elements, no equilibrium, no convergence.
    pub fn solve(
        &self,
        controls: &[f64],
        start: Option<&ContactWarmStart>,
        tolerance: f64,
    ) -> Result<ContactState<SolverState>, ContactError> {
        let own = || self.own.solve(controls, start, tolerance);
        let Some(Name { id, leader }) = &self.shared else {
            return Ok(own()?.map(|own| SolverState { own, shared: None }));
        };
        let of = Name { id: leader.name(), leader: Arc::clone(leader) };
        let shape = Shape { controls: controls.to_vec(), start: start.cloned(), tolerance };
        let products = |state: &ContactState<OwnState>| state.work().dual_operator_applications;
        let state = leader.agreed(Task::Solve(*id, of.id, Box::new(shape)), own, products)?;
        Ok(state.map(|own| SolverState { own, shared: Some(of) }))
    }

    /// Asks all processes about a state of this solver.
    fn ask(&self, state: &SolverState, call: Call) -> Result<Reply, ContactError> {
        match (&self.shared, &state.shared) {
            (Some(name), Some(of)) => {
                let task = Task::Ask(name.id, of.id, call.clone());
                name.leader.agreed(task, || self.own.perform(&state.own, &call), Reply::products)
            }
            (None, None) => self.own.perform(&state.own, &call),
            _ => Err(ContactError::OtherSolver),
        }
    }

    /// Sensitivities of the positions of the nodes of all bodies for a dual: j = ∂J/∂λ in packed rows, then, where J
    /// depends on the displacements, l = ∂J/∂u with three entries per node of every body, in the order of the scene.
    /// What J depends on the shape itself is not part of them. `tolerance`: relative residual of the adjoint, for
    /// solvers that iterate.
    ///
    /// # Errors
    /// [`ContactError::NotConverged`] from the adjoint, [`ContactError::NotFinite`] when it is singular,
    /// [`ContactError::ForeignState`] for a dual of another size.
    pub fn sensitivities(
        &self,
        state: &SolverState,
        dual: &[f64],
        tolerance: f64,
    ) -> Result<Sensitivities, ContactError> {
        match self.ask(state, Call::Sensitivities(dual.to_vec(), tolerance))? {
            Reply::Sensitivities(found) => Ok(found),
            _ => unreachable!("{SAME_VARIANT}"),
        }
    }

    /// Forward derivative of the contact state for changes of the controls, one vector per change: columns of the
    /// generalized Jacobian that [`sensitivities`](Self::sensitivities) has rows of. `of`: whether displacements of the
    /// bodies are differentiated as well, which costs one more solve per change. `tolerance`: relative residual of the
    /// linearized contact problems, for solvers that iterate.
    ///
    /// # Errors
    /// [`ContactError::NotConverged`] from the linearized problems, [`ContactError::NotFinite`] when they are singular,
    /// [`ContactError::ForeignState`] for changes of another number of controls.
    pub fn tangents(
        &self,
        state: &SolverState,
        changes: &[Vec<f64>],
        of: TangentsOf,
        tolerance: f64,
    ) -> Result<Tangents, ContactError> {
        match self.ask(state, Call::Tangents(changes.to_vec(), of, tolerance))? {
            Reply::Tangents(found) => Ok(found),
            _ => unreachable!("{SAME_VARIANT}"),
        }
    }

    /// Contraction and condition at a solved shape.
    ///
    /// # Errors
    /// [`ContactError`] from the linear systems.
    pub fn diagnose(&self, state: &SolverState) -> Result<Diagnosis, ContactError> {
        match self.ask(state, Call::Diagnose)? {
            Reply::Diagnose(found) => Ok(found),
            _ => unreachable!("{SAME_VARIANT}"),
        }
    }

    /// A rough estimate of the contraction of the slip bounds at a solved shape, for at most so many products with the
    /// dual operator; 0 where no closed node has a friction force (total FETI) or no node is closed (direct
    /// condensation). See method.md section 4.
    ///
    /// # Errors
    /// [`ContactError`] from the linear system.
    pub fn estimate_contraction(&self, state: &SolverState, max_products: usize) -> Result<f64, ContactError> {
        match self.ask(state, Call::Contraction(max_products))? {
            Reply::Contraction(factor) => Ok(factor),
            _ => unreachable!("{SAME_VARIANT}"),
        }
    }

    /// What the solver has lost of the contact forces by the rounding of its own matrices, as a share of the load, to
    /// first order (method.md section 4); zero for total FETI, whose residuals know of it.
    ///
    /// # Errors
    /// [`ContactError::ForeignState`] for a state of another mesh, where it says anything of the state.
    pub fn force_rounding(&self, state: &SolverState) -> Result<f64, ContactError> {
        match self.ask(state, Call::ForceRounding)? {
            Reply::ForceRounding(share) => Ok(share),
            _ => unreachable!("{SAME_VARIANT}"),
        }
    }

    /// All bodies of a solved shape, in the order of the scene.
    ///
    /// # Errors
    /// [`ContactError::ForeignState`] for a state of another mesh.
    pub fn bodies(&self, state: &SolverState) -> Result<Vec<SolvedBody>, ContactError> {
        match self.ask(state, Call::Bodies)? {
            Reply::Bodies(bodies) => Ok(bodies),
            _ => unreachable!("{SAME_VARIANT}"),
        }
    }
}
