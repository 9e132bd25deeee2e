//! From a shape to its contact forces by TFETI.

use crate::equilibrium::law::Linearization;
use crate::equilibrium::{
    Configuration, ContactForces, ContactProblem, ContactRows, ContactState, ContactWarmStart, Failed, Kink, Residuals,
    Stage, StageSeconds, Work,
};
use crate::error::ContactError;
use crate::solvers::SolverKind;
use crate::tfeti::dual::{CoarseSpace, DualOperator, Precision, Preconditioner, TornContact, TornSolution};
use crate::tfeti::newton::{self, NewtonSettings, Recycling};
use crate::tfeti::paper::{AugmentedLagrangianSettings, solve_by_successive_approximations};
use crate::tfeti::state::TornState;
use crate::tfeti::torn::{PreconditionerKind, TornModel, TornOptions, TornSystem};
use std::sync::Arc;
use std::sync::atomic::AtomicUsize;
use std::time::Instant;

/// How the dual problem is solved. The state is the same, whichever method found it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum DualMethod {
    /// The semismooth Newton method.
    Newton(Recycling),
    /// Successive approximations of the slip bound, dual QPs by SMALSE-M and MPGP.
    SuccessiveApproximations,
}

impl Default for DualMethod {
    fn default() -> Self {
        Self::Newton(Recycling::default())
    }
}

/// A contact problem torn into subdomains, with the method for its dual problem.
#[derive(Debug)]
pub struct TotalFeti {
    pub(super) model: TornModel,
    preconditioner: PreconditionerKind,
    precision: Precision,
    method: DualMethod,
}

/// Laps of wall-clock time.
pub(super) struct Clock(Instant);

impl Clock {
    pub(super) fn start() -> Self {
        Self(Instant::now())
    }

    /// Seconds since the last lap.
    pub(super) fn lap(&mut self) -> f64 {
        let seconds = self.0.elapsed().as_secs_f64();
        self.0 = Instant::now();
        seconds
    }
}

impl TotalFeti {
    /// Tears the bodies of a problem. Where there are several processes, each solves the same problem and works on its
    /// own subdomains, and all of them call the same functions of the solver in the same order.
    ///
    /// # Errors
    /// [`ContactError::Factorization`] when a symbolic analysis fails, [`ContactError::Clusters`].
    pub fn new(problem: Arc<ContactProblem>, options: TornOptions) -> Result<Self, ContactError> {
        let preconditioner = options.preconditioner;
        let model = TornModel::new(problem, options)?;
        Ok(Self { model, preconditioner, precision: Precision::default(), method: DualMethod::default() })
    }

    /// Replaces the method for the dual problem.
    #[must_use]
    pub fn with_method(self, method: DualMethod) -> Self {
        Self { method, ..self }
    }

    /// Replaces the precision of the products with search directions.
    #[must_use]
    pub fn with_precision(self, precision: Precision) -> Self {
        Self { precision, ..self }
    }

    /// The torn model of all shapes.
    pub fn model(&self) -> &TornModel {
        &self.model
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
        match self.method {
            DualMethod::Newton(recycling) => {
                let settings = NewtonSettings::to(tolerance);
                let max_products = max_products.unwrap_or(settings.max_products);
                let settings = NewtonSettings { recycling, max_products, ..settings };
                let method = |contact: &TornContact<'_>| Ok((newton::solve(contact, start, &settings)?, ()));
                let (state, ()) = self.attempt_by(SolverKind::Newton, controls, tolerance, method)?;
                Ok(state)
            }
            DualMethod::SuccessiveApproximations => {
                let settings = AugmentedLagrangianSettings::to(tolerance);
                let method = |contact: &TornContact<'_>| solve_by_successive_approximations(contact, start, &settings);
                let (state, counts) = self.attempt_by(SolverKind::AugmentedLagrangian, controls, tolerance, method)?;
                Ok(ContactState {
                    contraction: Some(counts.contraction).filter(|factor| *factor > 0.0),
                    work: counts.added_to(state.work),
                    ..state
                })
            }
        }
    }

    /// Solves one shape by any method on the contact problem in the multipliers, and passes on what else the method
    /// returns (its default for bodies at rest, where there is nothing to solve). `solver`: the method, for the state.
    ///
    /// # Errors
    /// [`ContactError`]: inverted elements, no equilibrium, what the method returns, and [`ContactError::Inaccurate`]
    /// when the residuals of its state are above both 1e-8 and four times `allowed`.
    pub fn solve_by<T: Default>(
        &self,
        solver: SolverKind,
        controls: &[f64],
        allowed: f64,
        method: impl FnOnce(&TornContact<'_>) -> Result<(TornSolution, T), ContactError>,
    ) -> Result<(ContactState<TornState>, T), ContactError> {
        self.attempt_by(solver, controls, allowed, method).map_err(|failed| *failed.error)
    }

    /// As [`TotalFeti::solve_by`]; a failure says what work it cost.
    fn attempt_by<T: Default>(
        &self,
        solver: SolverKind,
        controls: &[f64],
        allowed: f64,
        method: impl FnOnce(&TornContact<'_>) -> Result<(TornSolution, T), ContactError>,
    ) -> Result<(ContactState<TornState>, T), Failed> {
        let mut clock = Clock::start();
        let mut seconds = StageSeconds::default();
        let configuration = Configuration::new(&self.model.problem, controls)?;
        seconds.equilibrium = clock.lap();
        Stage::Factorization.enter()?;
        let system = self.model.factorize(&configuration)?;
        seconds.factorization = clock.lap();
        Stage::CoarseSpace.enter()?;
        let grounded = self.model.grounded_amplitudes(&system, &configuration);
        let space = CoarseSpace::new(&self.model, &system, grounded)?;
        let stiffness = self.model.problem.diagonal_share() * self.model.contact_stiffness(&system);
        let unit = configuration.unit(stiffness);
        let load = unit.first();
        seconds.coarse_space = clock.lap();
        Stage::Contact.enter()?;
        let scales = [stiffness, if load > 0.0 { load } else { 1.0 }];
        let mut contact = self.contact(&system, &space, &configuration.rows, scales);
        contact.unit = Some(unit);
        let work = |newton_steps| Work {
            newton_steps,
            dual_operator_applications: contact.operator.applications(),
            factorizations: system.factorizations,
            ..Work::default()
        };
        let solved = if load > 0.0 { method(&contact) } else { Ok((contact.at_rest(), T::default())) };
        let (solution, returned) = solved.map_err(|error| Failed { error: Box::new(error), work: work(0) })?;
        seconds.coarse_space += contact.space.seconds();
        seconds.newton = clock.lap() - contact.space.seconds();
        Stage::Recovery.enter()?;
        let (operator, iterate) = (&contact.operator, &solution.iterate);
        let load = contact.finer(iterate).map_or(load, |(finer, _)| finer.load);
        let loaded = operator.loaded_displacement();
        let displacement = operator.displacement(loaded, &iterate.multipliers, &iterate.amplitudes);
        let forces = forces(&contact, &solution, &configuration, if load > 0.0 { load } else { contact.load });
        let work = work(solution.steps);
        forces.residuals.check(allowed).map_err(|error| Failed { error: Box::new(error), work })?;
        seconds.recovery = clock.lap();
        let Configuration { positions, rows, .. } = configuration;
        let constraints = Arc::clone(&self.model.constraints);
        let state = TornState { positions, rows, space, constraints, solution, displacement, stiffness, load, system };
        Ok((solved_state(solver, state, forces, seconds, work), returned))
    }

    /// The contact problem of a factored shape; `scales` are c and the load.
    fn contact<'a>(
        &'a self,
        system: &'a TornSystem,
        space: &'a CoarseSpace,
        rows: &'a ContactRows,
        scales: [f64; 2],
    ) -> TornContact<'a> {
        let operator = DualOperator::new(&self.model, system);
        let preconditioner = Preconditioner::new(&self.model, system, self.preconditioner, scales[0]);
        TornContact::new(operator, space, preconditioner, rows, scales, self.precision)
    }

    /// The contact problem of a state; none for bodies at rest.
    ///
    /// # Errors
    /// [`ContactError::ForeignState`] for a state of another mesh.
    pub(super) fn contact_of<'a>(&'a self, state: &'a TornState) -> Result<Option<TornContact<'a>>, ContactError> {
        self.check(state)?;
        let contact = || self.contact(&state.system, &state.space, &state.rows, [state.stiffness, state.load]);
        Ok((state.load > 0.0).then(contact))
    }

    pub(super) fn check(&self, state: &TornState) -> Result<(), ContactError> {
        let (expected, found) = (self.model.interface.torn_count(), state.displacement.0.len());
        if expected != found {
            return Err(ContactError::ForeignState { what: "torn dofs", expected, found });
        }
        Ok(())
    }
}

/// The contact forces of a solution in physical units, with certificates by a new product F λ with the last iterate.
fn forces(
    contact: &TornContact<'_>,
    solution: &TornSolution,
    configuration: &Configuration,
    load: f64,
) -> ContactForces {
    let (boundary, iterate) = (contact.boundary, &solution.iterate);
    let scales = contact.operator.model.constraints.contact_scales(boundary);
    let forces = contact.contact_forces(&iterate.multipliers);
    let jumps: Vec<f64> = iterate.jumps.contact().iter().zip(scales).map(|(jump, nu)| jump * nu).collect();
    let status = boundary.points.iter().zip(&solution.linearizations);
    let status = status.map(|(point, linearization)| linearization.status(point)).collect();
    let kink = Kink::of(boundary, &contact.arguments(iterate));
    let forces = admissible_forces(contact, &forces, &solution.linearizations);
    let found = configuration.residuals(&contact.operator.model.problem, &forces, &jumps, contact.stiffness);
    // Subdomains are in equilibrium as well as bodies.
    let imbalance = contact.imbalance(&iterate.multipliers) * contact.load / load;
    let equilibrium = found.equilibrium.max(imbalance);
    let residuals = Residuals { equilibrium, newton: solution.residual, ..found };
    ContactForces::unpack(boundary, contact.rows, &forces, &jumps, status, residuals, kink)
}

/// Forces brought into the friction cone, and to zero at open nodes: as much lies outside as the residual.
fn admissible_forces(contact: &TornContact<'_>, forces: &[f64], linearizations: &[Linearization]) -> Vec<f64> {
    let mut admissible = vec![0.0; forces.len()];
    for (point, linearization) in contact.boundary.points.iter().zip(linearizations) {
        if *linearization != Linearization::Open {
            let rows = point.rows();
            point.project(&forces[rows.clone()], &mut admissible[rows]);
        }
    }
    admissible
}

/// A state with its forces, without what is found on demand.
fn solved_state(
    solver: SolverKind,
    solution: TornState,
    forces: ContactForces,
    seconds: StageSeconds,
    work: Work,
) -> ContactState<TornState> {
    ContactState {
        forces,
        rows: Arc::clone(&solution.rows),
        load: solution.load,
        solver,
        reason: None,
        contraction: None,
        stages: Some(seconds),
        work,
        adjoint_applications: AtomicUsize::new(0),
        solution,
        bodies: None,
    }
}
