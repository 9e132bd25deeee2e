//! A contact solver whose kind is chosen when the program runs, and the choice between total FETI and direct condensation.
//!
//! `auto` takes total FETI first, for at most as many products with F as a state by direct condensation costs, and direct
//! condensation where total FETI finds no state, or none that is clearly accurate. It begins with direct condensation where total
//! FETI is known to be slow (nearly incompressible standard bricks, bricks of extreme shape, a shape similar to one that needed
//! it) and where Jacobians are wanted that cost less there. Sizes and counted work alone decide, so that a resumed run repeats
//! the choice. Where bodies are too large to be condensed, total FETI is alone.

use crate::body::elasticity::Formulation;
use crate::communication::Communication;
use crate::direct::{DirectSolver, DirectState};
use crate::equilibrium::{
    Configuration, ContactProblem, ContactSolver, ContactState, ContactWarmStart, Diagnosis, Failed, MAX_RESIDUAL,
    Sensitivities, SolvedBody, SolverState, Tangents,
};
use crate::error::ContactError;
use crate::memory;
use crate::solver_kind::SolverKind;
use crate::tfeti::{DualMethod, PreconditionerKind, Recycling, TornState, TotalFeti};
use crate::work_estimate::WorkEstimate;
use std::sync::{Arc, OnceLock};

/// Estimated bytes up to which bodies are condensed without being asked for. A constant: what the machine has free must not
/// change a result.
const MAX_CONDENSED_BYTES: f64 = 4e9;
/// Products with F that total FETI is always allowed: states of the smallest scenes take some tens.
const MIN_PRODUCTS: usize = 100;
/// Share of [`MAX_RESIDUAL`] above which a state of total FETI is found anew by direct condensation: the two solvers measure
/// forces and lengths in different units, a defect of the gluing grows along a slender body, and bodies that a few nodes hold enlarge
/// what is left by some 4000. States of ordinary scenes stand at 2e-13.
const COMFORTABLE_SHARE: f64 = 1e-4;
/// Poisson's ratio of standard bricks from which total FETI takes hundreds of products and more.
const LOCKING: f64 = 0.499;

/// Cost of a state by direct condensation, in products with F of as many operations, up to which it takes less time with all its
/// derivatives than one by total FETI: dense operations are the faster ones (docs/scaling.md).
const MAX_PRODUCTS_WITH_JACOBIANS: usize = 1000;

/// What a solver will be asked for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Wanted {
    /// States and adjoints.
    States,
    /// The Jacobian of all contact forces too.
    Jacobians,
}

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

/// Total FETI and direct condensation, each prepared when it is needed.
#[derive(Debug)]
pub struct AutoSolver {
    problem: Arc<ContactProblem>,
    preconditioner: PreconditionerKind,
    communication: Arc<dyn Communication>,
    torn: OnceLock<TotalFeti>,
    direct: OnceLock<DirectSolver>,
    /// Why direct condensation comes first, if it does.
    direct_first: Option<String>,
    /// Products with F that total FETI may take before direct condensation; none where the bodies are too large for it.
    max_products: Option<usize>,
}

/// What a solver of any kind keeps of a solved shape.
#[derive(Debug)]
pub enum AnyState {
    /// By total FETI.
    Torn(Box<TornState>),
    /// By direct condensation.
    Direct(Box<DirectState>),
}

impl SolverState for AnyState {
    fn warm_start(&self) -> ContactWarmStart {
        match self {
            Self::Torn(state) => state.warm_start(),
            Self::Direct(state) => state.warm_start(),
        }
    }
}

impl From<TornState> for AnyState {
    fn from(state: TornState) -> Self {
        Self::Torn(Box::new(state))
    }
}

impl From<DirectState> for AnyState {
    fn from(state: DirectState) -> Self {
        Self::Direct(Box::new(state))
    }
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
        let torn = |problem, method| {
            TotalFeti::with_communication(problem, preconditioner, method, Arc::clone(&communication)).map(Self::from)
        };
        match kind {
            SolverKind::Auto => AutoSolver::new(problem, preconditioner, wanted, Arc::clone(&communication))
                .map(|solver| Self::Auto(Box::new(solver))),
            SolverKind::Newton => torn(problem, DualMethod::Newton(Recycling::default())),
            SolverKind::AugmentedLagrangian => torn(problem, DualMethod::SuccessiveApproximations),
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

/// What a cell holds, built at the first call.
fn prepared<T>(cell: &OnceLock<T>, build: impl FnOnce() -> Result<T, ContactError>) -> Result<&T, ContactError> {
    if let Some(value) = cell.get() {
        return Ok(value);
    }
    let value = build()?;
    // Another thread may have been first; its value is the same.
    Ok(cell.get_or_init(|| value))
}

impl AutoSolver {
    /// Prepares the solver that comes first.
    fn new(
        problem: Arc<ContactProblem>,
        preconditioner: PreconditionerKind,
        wanted: Wanted,
        communication: Arc<dyn Communication>,
    ) -> Result<Self, ContactError> {
        let scene = &problem.scene;
        let condensable = memory::estimate(scene, SolverKind::Direct, preconditioner, 0, 1) <= MAX_CONDENSED_BYTES;
        let products = WorkEstimate::of(scene).products_per_condensed_state();
        let max_products = condensable.then(|| products.max(MIN_PRODUCTS));
        let cheaper = wanted == Wanted::Jacobians && products <= MAX_PRODUCTS_WITH_JACOBIANS;
        let cheaper = cheaper.then(|| "Jacobians of all pressures cost least there".to_owned());
        let direct_first = if condensable { slow_for_total_feti(&problem).or(cheaper) } else { None };
        let (torn, direct) = (OnceLock::new(), OnceLock::new());
        let solver = Self { problem, preconditioner, communication, torn, direct, direct_first, max_products };
        match solver.direct_first {
            Some(_) => solver.direct().map(|_| ())?,
            None => solver.torn().map(|_| ())?,
        }
        Ok(solver)
    }

    fn torn(&self) -> Result<&TotalFeti, ContactError> {
        let method = DualMethod::Newton(Recycling::default());
        prepared(&self.torn, || {
            let communication = Arc::clone(&self.communication);
            TotalFeti::with_communication(Arc::clone(&self.problem), self.preconditioner, method, communication)
        })
    }

    fn direct(&self) -> Result<&DirectSolver, ContactError> {
        prepared(&self.direct, || DirectSolver::new(Arc::clone(&self.problem)))
    }

    /// The state by the solver that comes first for this start, else by the other.
    fn solve(
        &self,
        controls: &[f64],
        start: Option<&ContactWarmStart>,
        tolerance: f64,
    ) -> Result<ContactState<AnyState>, ContactError> {
        let similar = matches!(start, Some(ContactWarmStart::Displacements(_)));
        let reason = if similar { Some("a similar shape needed it".to_owned()) } else { self.direct_first.clone() };
        let Some(reason) = reason else { return self.torn_then_direct(controls, start, tolerance) };
        match self.direct()?.solve(controls, start, tolerance) {
            Ok(state) => Ok(condensed(state, reason)),
            Err(error) if error.is_about_the_problem() && !proves_friction_too_weak(&error) => Err(error),
            Err(error) => match self.torn()?.attempt(controls, None, tolerance, self.max_products) {
                Ok(state) => {
                    let reason = Some(format!("direct condensation failed: {error}"));
                    Ok(ContactState { reason, ..state.map(AnyState::from) })
                }
                Err(_) if proves_friction_too_weak(&error) => Err(error),
                Err(failed) => Err(unsolved(failed, error)),
            },
        }
    }

    /// Solves the shape of a total FETI state again by direct condensation, for derivatives that do not converge on total FETI.
    fn condensed(&self, state: &TornState) -> Result<(&DirectSolver, ContactState<DirectState>), ContactError> {
        let configuration = Configuration::of(&self.problem, state.blocks().to_vec())?;
        let direct = self.direct()?;
        Ok((direct, direct.solve_configuration(configuration, None, 0.0)?))
    }

    fn torn_then_direct(
        &self,
        controls: &[f64],
        start: Option<&ContactWarmStart>,
        tolerance: f64,
    ) -> Result<ContactState<AnyState>, ContactError> {
        let mut found = false;
        let failed = match self.torn()?.attempt(controls, start, tolerance, self.max_products) {
            Ok(state) => {
                found = true;
                let comfortable = state.forces.residuals.within(tolerance.max(COMFORTABLE_SHARE * MAX_RESIDUAL));
                match (comfortable, self.max_products) {
                    (Err(error), Some(_)) => Failed { error: Box::new(error), work: state.work() },
                    _ => return Ok(state.map(AnyState::from)),
                }
            }
            Err(failed) if self.max_products.is_none() || failed.error.is_about_the_problem() => {
                return Err(*failed.error);
            }
            Err(failed) => failed,
        };
        match self.direct()?.solve(controls, None, tolerance) {
            Ok(state) => {
                let work = state.work.after(failed.work);
                Ok(ContactState { work, ..condensed(state, format!("total FETI failed: {}", failed.error)) })
            }
            // Nothing proves that there is no state where one was found, be it to few digits.
            Err(error) if error.is_about_the_problem() && !(found && proves_friction_too_weak(&error)) => Err(error),
            Err(error) => Err(unsolved(failed, error)),
        }
    }
}

/// A state by direct condensation, with the reason for that solver before its own remark.
fn condensed(state: ContactState<DirectState>, reason: String) -> ContactState<AnyState> {
    let reason = std::iter::once(reason).chain(state.reason.clone()).collect::<Vec<_>>().join("; ");
    ContactState { reason: Some(reason), ..state.map(AnyState::from) }
}

fn proves_friction_too_weak(error: &ContactError) -> bool {
    matches!(error, ContactError::FrictionTooWeak { .. })
}

/// Why total FETI would be slow for a scene, if it would.
fn slow_for_total_feti(problem: &ContactProblem) -> Option<String> {
    let locking = problem.bodies().map(|body| body.material).filter(|m| m.formulation() == Formulation::Standard);
    let ratio = locking.map(|material| material.poisson_ratio()).fold(f64::NEG_INFINITY, f64::max);
    if ratio >= LOCKING {
        return Some(format!("Poisson's ratio {ratio} is nearly incompressible"));
    }
    problem.extreme_aspect().map(|aspect| format!("bricks have edges 1 : {aspect:.0}"))
}

fn unsolved(torn: Failed, direct: ContactError) -> ContactError {
    let products = torn.work.dual_operator_applications;
    ContactError::Unsolved { torn: torn.error, products, direct: Box::new(direct) }
}

impl ContactSolver for AnySolver {
    type State = AnyState;

    fn problem(&self) -> &ContactProblem {
        match self {
            Self::Torn(solver) => solver.problem(),
            Self::Direct(solver) => solver.problem(),
            Self::Auto(solver) => &solver.problem,
        }
    }

    fn sizes(&self) -> [usize; 2] {
        match self {
            Self::Torn(solver) => solver.sizes(),
            Self::Direct(solver) => solver.sizes(),
            Self::Auto(solver) => solver
                .torn
                .get()
                .map_or_else(|| solver.direct.get().map_or([0; 2], ContactSolver::sizes), ContactSolver::sizes),
        }
    }

    fn left_out(&self) -> Option<&'static str> {
        match self {
            Self::Torn(solver) => solver.left_out(),
            Self::Direct(solver) => solver.left_out(),
            Self::Auto(solver) => match &solver.direct_first {
                Some(_) => solver.direct.get()?.left_out(),
                None => solver.torn.get()?.left_out(),
            },
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
            AnyState::Torn(state) => match (self.torn()?.sensitivities(state, direction, tolerance), self) {
                (Err(_), Self::Auto(solver)) if solver.max_products.is_some() => {
                    let (direct, state) = solver.condensed(state)?;
                    direct.sensitivities(&state.solution, direction, 0.0)
                }
                (result, _) => result,
            },
            AnyState::Direct(state) => self.direct()?.sensitivities(state, direction, tolerance),
        }
    }

    fn tangents(&self, state: &AnyState, changes: &[Vec<f64>], tolerance: f64) -> Result<Tangents, ContactError> {
        match state {
            AnyState::Torn(state) => match (self.torn()?.tangents(state, changes, tolerance), self) {
                (Err(_), Self::Auto(solver)) if solver.max_products.is_some() => {
                    let (direct, state) = solver.condensed(state)?;
                    direct.tangents(&state.solution, changes, tolerance)
                }
                (result, _) => result,
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

    fn bodies(&self, state: &AnyState) -> Result<Vec<SolvedBody>, ContactError> {
        match state {
            AnyState::Torn(state) => self.torn()?.bodies(state),
            AnyState::Direct(state) => self.direct()?.bodies(state),
        }
    }

    fn strain_energy(&self, state: &AnyState) -> Option<f64> {
        match state {
            AnyState::Torn(state) => self.torn().ok()?.strain_energy(state),
            AnyState::Direct(state) => self.direct().ok()?.strain_energy(state),
        }
    }
}
