//! Total FETI as a contact solver: semismooth Newton, or the paper's successive approximations.

use crate::communication::Communication;
use crate::equilibrium::{
    ContactProblem, ContactSolver, ContactState, ContactWarmStart, Diagnosis, Failed, Sensitivities, SolvedBody,
    SolverState, Tangents,
};
use crate::error::ContactError;
use crate::solver_kind::SolverKind;
use crate::tfeti::dual::TornContact;
use crate::tfeti::{
    AugmentedLagrangianSettings, NewtonSettings, PreconditionerKind, Recycling, TornOptions, TornSolver, TornState,
};
use std::sync::Arc;
use std::sync::atomic::AtomicUsize;

/// How the dual problem is solved. The state is the same, whichever method found it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum DualMethod {
    /// Semismooth Newton.
    Newton(Recycling),
    /// Successive approximations of the slip bound, dual QPs by SMALSE-M and MPGP.
    SuccessiveApproximations,
}

/// A contact problem torn into subdomains, with the method for its dual problem.
#[derive(Debug)]
pub struct TotalFeti {
    solver: TornSolver,
    method: DualMethod,
}

impl TotalFeti {
    /// Tears the bodies of a problem.
    ///
    /// # Errors
    /// [`ContactError::Factorization`] when a symbolic analysis fails.
    pub fn new(
        problem: Arc<ContactProblem>,
        preconditioner: PreconditionerKind,
        method: DualMethod,
    ) -> Result<Self, ContactError> {
        Self::with_options(problem, method, TornOptions { preconditioner, ..TornOptions::default() })
    }

    /// As [`TotalFeti::new`], in one process of several; see [`TornSolver::with_communication`].
    ///
    /// # Errors
    /// As [`TotalFeti::new`].
    pub fn with_communication(
        problem: Arc<ContactProblem>,
        preconditioner: PreconditionerKind,
        method: DualMethod,
        communication: Arc<dyn Communication>,
    ) -> Result<Self, ContactError> {
        Self::with_options(problem, method, TornOptions { preconditioner, communication, ..TornOptions::default() })
    }

    /// As [`TotalFeti::new`], with all options of the tearing.
    ///
    /// # Errors
    /// As [`TornSolver::with_options`].
    pub fn with_options(
        problem: Arc<ContactProblem>,
        method: DualMethod,
        options: TornOptions,
    ) -> Result<Self, ContactError> {
        Ok(Self { solver: TornSolver::with_options(problem, options)?, method })
    }

    /// Solves one shape with at most so many products with F in Newton's method; a failure says what work it cost.
    pub(crate) fn attempt(
        &self,
        controls: &[f64],
        start: Option<&ContactWarmStart>,
        tolerance: f64,
        max_products: Option<usize>,
    ) -> Result<ContactState<TornState>, Failed> {
        let start = match start {
            Some(ContactWarmStart::Multipliers(multipliers)) => Some(multipliers.as_slice()),
            _ => None,
        };
        let (solution, forces, work, solver, counts) = match self.method {
            DualMethod::Newton(recycling) => {
                let settings = NewtonSettings::to(tolerance);
                let max_products = max_products.unwrap_or(settings.max_products);
                let settings = NewtonSettings { recycling, max_products, ..settings };
                let method = |contact: &TornContact<'_>| Ok((contact.solve(start, &settings)?, ()));
                let (solution, forces, work, ()) = self.solver.attempt(controls, tolerance, method)?;
                (solution, forces, work, SolverKind::Newton, None)
            }
            DualMethod::SuccessiveApproximations => {
                let settings = AugmentedLagrangianSettings::to(tolerance);
                let method = |contact: &TornContact<'_>| contact.solve_by_successive_approximations(start, &settings);
                let (solution, forces, work, counts) = self.solver.attempt(controls, tolerance, method)?;
                (solution, forces, work, SolverKind::AugmentedLagrangian, Some(counts))
            }
        };
        Ok(ContactState {
            forces,
            load: solution.load(),
            solver,
            reason: None,
            contraction: counts.map(|counts| counts.contraction).filter(|f| *f > 0.0),
            stages: Some(solution.seconds()),
            work: counts.map_or(work, |counts| counts.added_to(work)),
            adjoint_applications: AtomicUsize::new(0),
            solution,
            bodies: None,
        })
    }

    /// As [`ContactSolver::sensitivities`], with at most so many products with F.
    pub(crate) fn sensitivities_within(
        &self,
        state: &TornState,
        direction: &[f64],
        tolerance: f64,
        max_products: usize,
    ) -> Result<Sensitivities, ContactError> {
        self.solver.sensitivities_within(state, direction, tolerance, max_products)
    }
}

impl SolverState for TornState {
    fn warm_start(&self) -> ContactWarmStart {
        ContactWarmStart::Multipliers(self.multipliers())
    }
}

impl ContactSolver for TotalFeti {
    type State = TornState;

    fn problem(&self) -> &ContactProblem {
        self.solver.problem()
    }

    fn sizes(&self) -> [usize; 2] {
        let model = self.solver.model();
        [model.total_dofs, model.constraints.total_equality_count + model.problem.boundary.row_count]
    }

    fn left_out(&self) -> Option<&'static str> {
        (self.solver.model().constraints.gluing_count == 0).then_some("gluing (one subdomain per body)")
    }

    fn solve(
        &self,
        controls: &[f64],
        start: Option<&ContactWarmStart>,
        tolerance: f64,
    ) -> Result<ContactState<TornState>, ContactError> {
        self.attempt(controls, start, tolerance, None).map_err(|failed| *failed.error)
    }

    fn sensitivities(
        &self,
        state: &TornState,
        direction: &[f64],
        tolerance: f64,
    ) -> Result<Sensitivities, ContactError> {
        self.solver.sensitivities(state, direction, tolerance)
    }

    fn tangents(&self, state: &TornState, changes: &[Vec<f64>], tolerance: f64) -> Result<Tangents, ContactError> {
        self.solver.tangents(state, changes, tolerance)
    }

    fn diagnose(&self, state: &TornState) -> Result<Diagnosis, ContactError> {
        self.solver.diagnose(state)
    }

    fn estimate_contraction(&self, state: &TornState, max_products: usize) -> Result<f64, ContactError> {
        self.solver.estimate_contraction(state, max_products)
    }

    fn bodies(&self, state: &TornState) -> Result<Vec<SolvedBody>, ContactError> {
        self.solver.bodies(state)
    }
}
