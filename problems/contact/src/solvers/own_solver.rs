//! The contact solver of one process: total FETI, direct condensation, or the choice between them.
//!
//! The choice takes what an estimate of both ways says is faster: total FETI, for at most 1.6 times the operations of a
//! state by direct condensation, and direct condensation where it finds no state, or none that is clearly
//! accurate; or direct condensation first. This comes first as well where total FETI loses digits (nearly
//! incompressible standard bricks, bricks of extreme shape), and for a shape similar to one that needed it. Jacobians
//! that will be wanted count. Sizes and counted work alone decide, so that a resumed run repeats the choice. Bodies too
//! large to be condensed leave total FETI alone.

use crate::direct::{CondensedShelf, DirectSolver, DirectState};
use crate::equilibrium::{
    Configuration, ContactProblem, ContactState, ContactWarmStart, Failed, MAX_RESIDUAL, Sensitivities, Tangents,
    TangentsOf,
};
use crate::error::ContactError;
use crate::memory;
use crate::solvers::call::{Call, Reply};
use crate::solvers::own_state::OwnState;
use crate::solvers::{SolverKind, Wanted};
use crate::tfeti::{DualMethod, TornOptions, TornState, TotalFeti};
use crate::work_estimate::WorkEstimate;
use std::sync::{Arc, OnceLock};

/// Products with F that total FETI is always allowed: states of the smallest scenes take some tens.
const MIN_PRODUCTS: usize = 100;
/// Share of [`MAX_RESIDUAL`] above which a state of total FETI is found anew by direct condensation: the two solvers
/// measure forces and lengths in different units, a defect of the gluing grows along a slender body, and bodies that a
/// few nodes hold enlarge what is left by some 4000. States of ordinary scenes stand at 2e-13.
const COMFORTABLE_SHARE: f64 = 1e-4;
/// Estimated time of total FETI over that of direct condensation above which the latter comes first: estimates are
/// rough, and what total FETI finds has residuals that know of all rounding.
const CLEARLY_SLOWER: f64 = 1.25;

/// Total FETI and direct condensation, each prepared when it is needed.
#[derive(Debug)]
pub struct OwnSolver {
    problem: Arc<ContactProblem>,
    options: TornOptions,
    condensed: Arc<CondensedShelf>,
    torn: OnceLock<TotalFeti>,
    direct: OnceLock<DirectSolver>,
    order: Order,
}

/// Which solvers may work on a shape.
#[derive(Debug)]
enum Order {
    Torn(DualMethod),
    Direct,
    /// Total FETI for at most so many products with F, then direct condensation.
    TornFirst(usize),
    /// Direct condensation for a reason, then total FETI for at most so many products with F.
    DirectFirst(usize, String),
}

impl Order {
    /// The order of `auto`.
    fn chosen(problem: &ContactProblem, options: &TornOptions, wanted: Wanted) -> Self {
        let scene = &problem.scene;
        if memory::estimate(scene, SolverKind::Direct, options.preconditioner, 0, 1).of_cases(1)
            > memory::MAX_CONDENSED_BYTES
        {
            return Self::Torn(DualMethod::default());
        }
        let estimate = WorkEstimate::of(scene);
        let max_products = estimate.most_products().max(MIN_PRODUCTS);
        let columns = if wanted == Wanted::Jacobians { problem.map.control_count() } else { 0 };
        let [direct, torn] = estimate.seconds(problem, columns);
        // Clusters are asked for by those who want total FETI. Processes have no part in the choice: it is that of one.
        let is_slower = options.clusters.is_none() && torn > CLEARLY_SLOWER * direct;
        let share = || format!("it takes an estimated share of {:.2} of the time", direct / torn);
        let cheaper = is_slower.then(share);
        match problem.ill_conditioned().or(cheaper) {
            Some(reason) => Self::DirectFirst(max_products, reason),
            None => Self::TornFirst(max_products),
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

impl From<TotalFeti> for OwnSolver {
    fn from(solver: TotalFeti) -> Self {
        let (problem, order) = (Arc::clone(&solver.model().problem), Order::Torn(DualMethod::default()));
        let options = TornOptions::default();
        Self { problem, options, condensed: Arc::default(), torn: solver.into(), direct: OnceLock::new(), order }
    }
}

impl From<DirectSolver> for OwnSolver {
    fn from(solver: DirectSolver) -> Self {
        let (problem, options) = (Arc::clone(&solver.problem), TornOptions::default());
        let (condensed, order) = (Arc::default(), Order::Direct);
        Self { problem, options, condensed, torn: OnceLock::new(), direct: solver.into(), order }
    }
}

impl OwnSolver {
    /// Prepares the solver of a kind, or the one that comes first; `condensed`: where solvers by direct condensation
    /// find the factors of each other.
    ///
    /// # Errors
    /// [`ContactError::Factorization`] when a symbolic analysis fails, [`ContactError::Clusters`].
    pub fn new(
        problem: Arc<ContactProblem>,
        kind: SolverKind,
        (options, condensed): (TornOptions, Arc<CondensedShelf>),
        wanted: Wanted,
    ) -> Result<Self, ContactError> {
        let order = match kind {
            SolverKind::Auto => Order::chosen(&problem, &options, wanted),
            SolverKind::Newton => Order::Torn(DualMethod::default()),
            SolverKind::AugmentedLagrangian => Order::Torn(DualMethod::SuccessiveApproximations),
            SolverKind::Direct => Order::Direct,
        };
        let solver = Self { problem, options, condensed, torn: OnceLock::new(), direct: OnceLock::new(), order };
        match solver.order {
            Order::Direct | Order::DirectFirst(..) => solver.direct().map(|_| ())?,
            Order::Torn(_) | Order::TornFirst(_) => solver.torn().map(|_| ())?,
        }
        Ok(solver)
    }

    fn torn(&self) -> Result<&TotalFeti, ContactError> {
        let method = match self.order {
            Order::Direct => return Err(ContactError::OtherSolver),
            Order::Torn(method) => method,
            Order::TornFirst(_) | Order::DirectFirst(..) => DualMethod::default(),
        };
        let build = || TotalFeti::new(Arc::clone(&self.problem), self.options.clone());
        prepared(&self.torn, || Ok(build()?.with_method(method)))
    }

    fn direct(&self) -> Result<&DirectSolver, ContactError> {
        match self.order {
            Order::Torn(_) => Err(ContactError::OtherSolver),
            _ => {
                prepared(&self.direct, || DirectSolver::sharing(Arc::clone(&self.problem), Arc::clone(&self.condensed)))
            }
        }
    }

    fn directly(
        &self,
        controls: &[f64],
        start: Option<&ContactWarmStart>,
        tolerance: f64,
        max_products: usize,
        reason: String,
    ) -> Result<ContactState<OwnState>, ContactError> {
        match self.direct()?.solve(controls, start, tolerance) {
            Ok(state) => Ok(condensed(state, reason)),
            Err(error) if error.ends_the_search() && !proves_friction_too_weak(&error) => Err(error),
            Err(error) => match self.torn()?.attempt(controls, None, tolerance, Some(max_products)) {
                Ok(state) => {
                    let reason = Some(format!("direct condensation failed: {error}"));
                    Ok(ContactState { reason, ..state.map(OwnState::from) })
                }
                Err(_) if proves_friction_too_weak(&error) => Err(error),
                Err(failed) => Err(unsolved(failed, error)),
            },
        }
    }

    fn torn_then_direct(
        &self,
        controls: &[f64],
        start: Option<&ContactWarmStart>,
        tolerance: f64,
        max_products: usize,
    ) -> Result<ContactState<OwnState>, ContactError> {
        let mut found = false;
        let failed = match self.torn()?.attempt(controls, start, tolerance, Some(max_products)) {
            Ok(state) => {
                found = true;
                match state.forces.residuals.within(tolerance.max(COMFORTABLE_SHARE * MAX_RESIDUAL)) {
                    Err(error) => Failed { error: Box::new(error), work: state.work() },
                    Ok(_) => return Ok(state.map(OwnState::from)),
                }
            }
            Err(failed) if failed.error.ends_the_search() => return Err(*failed.error),
            Err(failed) => failed,
        };
        match self.direct()?.solve(controls, None, tolerance) {
            Ok(state) => {
                let work = state.work.after(failed.work);
                // Total FETI may have found a state whose residuals are near the limit.
                let what = if found { "is not clearly accurate" } else { "failed" };
                Ok(ContactState { work, ..condensed(state, format!("total FETI {what}: {}", failed.error)) })
            }
            // Nothing proves that there is no state where one was found, be it to few digits.
            Err(error) if error.ends_the_search() && !(found && proves_friction_too_weak(&error)) => Err(error),
            Err(error) => Err(unsolved(failed, error)),
        }
    }

    /// Solves the shape of a total FETI state by direct condensation, for derivatives that total FETI does not find.
    fn condensed(&self, state: &TornState) -> Result<(&DirectSolver, DirectState), ContactError> {
        let configuration = Configuration::of(&self.problem, state.positions.clone())?;
        let direct = self.direct()?;
        Ok((direct, direct.solve_configuration(configuration, None, 0.0)?.solution))
    }

    /// Sensitivities of a total FETI state, by direct condensation where total FETI does not find them for the products
    /// that a state by direct condensation costs.
    fn torn_sensitivities(
        &self,
        state: &TornState,
        direction: &[f64],
        tolerance: f64,
    ) -> Result<Sensitivities, ContactError> {
        let torn = self.torn()?;
        let (Order::TornFirst(max_products) | Order::DirectFirst(max_products, _)) = self.order else {
            return torn.sensitivities(state, direction, tolerance);
        };
        let failed = match torn.sensitivities_within(state, direction, tolerance, max_products) {
            Ok(found) => return Ok(found),
            Err(error) if error.ends_the_search() => return Err(error),
            Err(error) => error,
        };
        let (direct, condensed) = self.condensed(state)?;
        let found = direct.sensitivities(&condensed, direction)?;
        let applications = if let ContactError::NotConverged { iterations, .. } = failed { iterations } else { 0 };
        Ok(Sensitivities { applications, ..found })
    }

    /// Tangents of a total FETI state, by direct condensation where total FETI does not find them.
    fn torn_tangents(
        &self,
        state: &TornState,
        changes: &[Vec<f64>],
        of: TangentsOf,
        tolerance: f64,
    ) -> Result<Tangents, ContactError> {
        match self.torn()?.tangents(state, changes, of, tolerance) {
            Err(error) if !matches!(self.order, Order::Torn(_)) && !error.ends_the_search() => {
                let (direct, condensed) = self.condensed(state)?;
                direct.tangents(&condensed, changes, of)
            }
            result => result,
        }
    }
}

impl OwnSolver {
    pub fn problem(&self) -> &ContactProblem {
        &self.problem
    }

    /// The sizes of a solver that is prepared, total FETI first.
    pub fn sizes(&self) -> [usize; 2] {
        let direct = || self.direct.get().map_or([0; 2], DirectSolver::sizes);
        self.torn.get().map_or_else(direct, TotalFeti::sizes)
    }

    /// What the solver that comes first leaves out.
    pub fn left_out(&self) -> Option<&'static str> {
        match self.order {
            Order::Direct | Order::DirectFirst(..) => self.direct.get().map(DirectSolver::left_out),
            Order::Torn(_) | Order::TornFirst(_) => self.torn.get()?.left_out(),
        }
    }

    /// As [`Solver::solve`](crate::solvers::Solver::solve).
    pub fn solve(
        &self,
        controls: &[f64],
        start: Option<&ContactWarmStart>,
        tolerance: f64,
    ) -> Result<ContactState<OwnState>, ContactError> {
        let similar = matches!(start, Some(ContactWarmStart::Forces(_)));
        match &self.order {
            Order::Torn(_) => Ok(self.torn()?.solve(controls, start, tolerance)?.map(OwnState::from)),
            Order::Direct => Ok(self.direct()?.solve(controls, start, tolerance)?.map(OwnState::from)),
            Order::TornFirst(max_products) | Order::DirectFirst(max_products, _) if similar => {
                self.directly(controls, start, tolerance, *max_products, "a similar shape needed it".to_owned())
            }
            Order::DirectFirst(max_products, reason) => {
                self.directly(controls, start, tolerance, *max_products, reason.clone())
            }
            Order::TornFirst(max_products) => self.torn_then_direct(controls, start, tolerance, *max_products),
        }
    }

    /// Answers a question about a state. Where there are several processes, all of them are asked.
    pub fn perform(&self, state: &OwnState, call: &Call) -> Result<Reply, ContactError> {
        match state {
            OwnState::Torn(state) => self.torn_reply(state, call),
            OwnState::Direct(state) => self.direct_reply(state, call),
        }
    }

    fn torn_reply(&self, state: &TornState, call: &Call) -> Result<Reply, ContactError> {
        let torn = self.torn()?;
        Ok(match call {
            Call::Sensitivities(dual, tolerance) => {
                Reply::Sensitivities(self.torn_sensitivities(state, dual, *tolerance)?)
            }
            Call::Tangents(changes, of, tolerance) => {
                Reply::Tangents(self.torn_tangents(state, changes, *of, *tolerance)?)
            }
            Call::Diagnose => Reply::Diagnose(torn.diagnose(state)?),
            Call::Contraction(products) => Reply::Contraction(torn.estimate_contraction(state, *products)?),
            // The residuals of total FETI know of its rounding.
            Call::ForceRounding => Reply::ForceRounding(0.0),
            Call::Bodies => Reply::Bodies(torn.bodies(state)?),
        })
    }

    fn direct_reply(&self, state: &DirectState, call: &Call) -> Result<Reply, ContactError> {
        let direct = self.direct()?;
        Ok(match call {
            Call::Sensitivities(dual, _) => Reply::Sensitivities(direct.sensitivities(state, dual)?),
            Call::Tangents(changes, of, _) => Reply::Tangents(direct.tangents(state, changes, *of)?),
            Call::Diagnose => Reply::Diagnose(direct.diagnose(state)?),
            Call::Contraction(_) => Reply::Contraction(direct.estimate_contraction(state)?),
            Call::ForceRounding => Reply::ForceRounding(direct.force_rounding(state)?),
            Call::Bodies => Reply::Bodies(direct.bodies(state)?),
        })
    }
}

/// A state by direct condensation, with the reason for that solver before its own remark.
fn condensed(state: ContactState<DirectState>, reason: String) -> ContactState<OwnState> {
    let reason = std::iter::once(reason).chain(state.reason.clone()).collect::<Vec<_>>().join("; ");
    ContactState { reason: Some(reason), ..state.map(OwnState::from) }
}

fn proves_friction_too_weak(error: &ContactError) -> bool {
    matches!(error, ContactError::FrictionTooWeak { .. })
}

fn unsolved(torn: Failed, direct: ContactError) -> ContactError {
    let products = torn.work.dual_operator_applications;
    ContactError::Unsolved { torn: torn.error, products, direct: Box::new(direct) }
}
