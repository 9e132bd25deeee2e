//! The choice between total FETI and direct condensation.
//!
//! `auto` takes total FETI first, for at most as many products with F as a state by direct condensation costs, and direct
//! condensation where total FETI finds no state, or none that is clearly accurate. It begins with direct condensation where total
//! FETI is known to be slow (nearly incompressible standard bricks, bricks of extreme shape, a shape similar to one that needed
//! it) and where Jacobians are wanted that cost less there. Sizes and counted work alone decide, so that a resumed run repeats
//! the choice. Where bodies are too large to be condensed, total FETI is alone.

use crate::any_state::AnyState;
use crate::direct::{DirectSolver, DirectState};
use crate::equilibrium::{
    Configuration, ContactProblem, ContactSolver, ContactState, ContactWarmStart, Failed, MAX_RESIDUAL, Sensitivities,
    Tangents,
};
use crate::error::ContactError;
use crate::memory;
use crate::solver_kind::SolverKind;
use crate::tfeti::{TornOptions, TornState, TotalFeti};
use crate::work_estimate::WorkEstimate;
use serde::{Deserialize, Serialize};
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
/// Cost of a state by direct condensation, in products with F of as many operations, up to which it takes less time with all its
/// derivatives than one by total FETI: dense operations are the faster ones (docs/scaling.md).
const MAX_PRODUCTS_WITH_JACOBIANS: usize = 1000;

/// What a solver will be asked for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum Wanted {
    /// States and adjoints.
    States,
    /// The Jacobian of all contact forces too.
    Jacobians,
}

/// Total FETI and direct condensation, each prepared when it is needed.
#[derive(Debug)]
pub struct AutoSolver {
    problem: Arc<ContactProblem>,
    options: TornOptions,
    torn: OnceLock<TotalFeti>,
    direct: OnceLock<DirectSolver>,
    /// Why direct condensation comes first, if it does.
    direct_first: Option<String>,
    /// Products with F that total FETI may take before direct condensation; none where the bodies are too large for it.
    max_products: Option<usize>,
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
    pub(crate) fn new(
        problem: Arc<ContactProblem>,
        options: TornOptions,
        wanted: Wanted,
    ) -> Result<Self, ContactError> {
        let scene = &problem.scene;
        let condensable =
            memory::estimate(scene, SolverKind::Direct, options.preconditioner, 0, 1) <= MAX_CONDENSED_BYTES;
        let products = WorkEstimate::of(scene).products_per_condensed_state();
        let max_products = condensable.then(|| products.max(MIN_PRODUCTS));
        let cheaper = wanted == Wanted::Jacobians && products <= MAX_PRODUCTS_WITH_JACOBIANS;
        let cheaper = cheaper.then(|| "Jacobians of all pressures cost least there".to_owned());
        let direct_first = if condensable { problem.ill_conditioned().or(cheaper) } else { None };
        let (torn, direct) = (OnceLock::new(), OnceLock::new());
        let solver = Self { problem, options, torn, direct, direct_first, max_products };
        match solver.direct_first {
            Some(_) => solver.direct().map(|_| ())?,
            None => solver.torn().map(|_| ())?,
        }
        Ok(solver)
    }

    pub(crate) fn torn(&self) -> Result<&TotalFeti, ContactError> {
        prepared(&self.torn, || TotalFeti::new(Arc::clone(&self.problem), self.options.clone()))
    }

    pub(crate) fn direct(&self) -> Result<&DirectSolver, ContactError> {
        prepared(&self.direct, || DirectSolver::new(Arc::clone(&self.problem)))
    }

    /// The state by the solver that comes first for this start, else by the other.
    pub(crate) fn solve(
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
            Err(error) if error.ends_the_search() && !proves_friction_too_weak(&error) => Err(error),
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

    /// Sensitivities of a total FETI state, by direct condensation where total FETI does not find them for the products that a state
    /// by direct condensation costs.
    pub(crate) fn sensitivities(
        &self,
        state: &TornState,
        direction: &[f64],
        tolerance: f64,
    ) -> Result<Sensitivities, ContactError> {
        let torn = self.torn()?;
        let Some(max_products) = self.max_products else { return torn.sensitivities(state, direction, tolerance) };
        let failed = match torn.sensitivities_within(state, direction, tolerance, max_products) {
            Ok(found) => return Ok(found),
            Err(error) if error.ends_the_search() => return Err(error),
            Err(error) => error,
        };
        let (direct, condensed) = self.condensed(state)?;
        let found = direct.sensitivities(&condensed, direction, 0.0)?;
        let applications = if let ContactError::NotConverged { iterations, .. } = failed { iterations } else { 0 };
        Ok(Sensitivities { applications, ..found })
    }

    /// Tangents of a total FETI state, by direct condensation where total FETI does not find them.
    pub(crate) fn tangents(
        &self,
        state: &TornState,
        changes: &[Vec<f64>],
        tolerance: f64,
    ) -> Result<Tangents, ContactError> {
        match self.torn()?.tangents(state, changes, tolerance) {
            Err(error) if self.max_products.is_some() && !error.ends_the_search() => {
                let (direct, condensed) = self.condensed(state)?;
                direct.tangents(&condensed, changes, tolerance)
            }
            result => result,
        }
    }

    /// The problem that it solves.
    pub(crate) fn problem(&self) -> &ContactProblem {
        &self.problem
    }

    /// The sizes of a solver that is prepared, total FETI first.
    pub(crate) fn sizes(&self) -> [usize; 2] {
        let direct = || self.direct.get().map_or([0; 2], ContactSolver::sizes);
        self.torn.get().map_or_else(direct, ContactSolver::sizes)
    }

    /// What the solver that comes first leaves out.
    pub(crate) fn left_out(&self) -> Option<&'static str> {
        match self.direct_first {
            Some(_) => self.direct.get()?.left_out(),
            None => self.torn.get()?.left_out(),
        }
    }

    /// Solves the shape of a total FETI state again by direct condensation, for derivatives that do not converge on total FETI.
    fn condensed(&self, state: &TornState) -> Result<(&DirectSolver, DirectState), ContactError> {
        let configuration = Configuration::of(&self.problem, state.blocks.clone())?;
        let direct = self.direct()?;
        Ok((direct, direct.solve_configuration(configuration, None, 0.0)?.solution))
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
            Err(failed) if self.max_products.is_none() || failed.error.ends_the_search() => {
                return Err(*failed.error);
            }
            Err(failed) => failed,
        };
        match self.direct()?.solve(controls, None, tolerance) {
            Ok(state) => {
                let work = state.work.after(failed.work);
                // It may have found a state that the gate lets pass.
                let what = if found { "is not clearly accurate" } else { "failed" };
                Ok(ContactState { work, ..condensed(state, format!("total FETI {what}: {}", failed.error)) })
            }
            // Nothing proves that there is no state where one was found, be it to few digits.
            Err(error) if error.ends_the_search() && !(found && proves_friction_too_weak(&error)) => Err(error),
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

fn unsolved(torn: Failed, direct: ContactError) -> ContactError {
    let products = torn.work.dual_operator_applications;
    ContactError::Unsolved { torn: torn.error, products, direct: Box::new(direct) }
}
