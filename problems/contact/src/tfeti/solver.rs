//! From a shape to its contact forces and their derivative by TFETI.

use crate::body::mesh::Block;
use crate::communication::Communication;
use crate::equilibrium::certificate::law_residuals;
use crate::equilibrium::law::{self, Linearization};
use crate::equilibrium::{
    Configuration, ContactForces, ContactProblem, Diagnosis, Failed, Kink, Residuals, Sensitivities, SolvedBody, Stage,
    StageSeconds, Tangents, Work,
};
use crate::error::ContactError;
use crate::linear::vector::dot;
use crate::tfeti::derivative::{DisplacementLoad, MovedSurface, height_sensitivities};
use crate::tfeti::dual::{CoarseSpace, DualOperator, Precision, Preconditioner, TornContact, TornSolution};
use crate::tfeti::newton::NewtonSettings;
use crate::tfeti::torn::{
    Constraints, PreconditionerKind, TornModel, TornOptions, TornSystem, TornVector, whole_bodies,
};
use crate::work_estimate::MAX_PRODUCTS;
use std::sync::Arc;
use std::time::Instant;

/// The TFETI solver of one problem.
#[derive(Debug)]
pub struct TornSolver {
    model: TornModel,
    preconditioner: PreconditionerKind,
    precision: Precision,
}

/// A solved shape with all that its derivative needs.
#[derive(Debug)]
pub struct TornState {
    blocks: Vec<Block>,
    system: TornSystem,
    space: CoarseSpace,
    constraints: Arc<Constraints>,
    solution: TornSolution,
    displacement: TornVector,
    gaps: Vec<f64>,
    stiffness: f64,
    load: f64,
    seconds: StageSeconds,
}

/// Laps of wall-clock time.
struct Clock(Instant);

impl Clock {
    fn start() -> Self {
        Self(Instant::now())
    }

    /// Seconds since the last lap.
    fn lap(&mut self) -> f64 {
        let seconds = self.0.elapsed().as_secs_f64();
        self.0 = Instant::now();
        seconds
    }
}

/// c relative to the assembled diagonal of the contact nodes: the Schur complement's diagonal is about half of it.
const STIFFNESS_SHARE: f64 = 0.5;
/// Smallest share of c that flat or tall bricks leave: with less, displacements count too little against forces.
const SMALLEST_SHARE: f64 = 0.01;

impl TornSolver {
    /// Tears the bodies of a problem.
    ///
    /// # Errors
    /// [`ContactError::Factorization`] when a symbolic analysis fails.
    pub fn new(problem: Arc<ContactProblem>, preconditioner: PreconditionerKind) -> Result<Self, ContactError> {
        Self::with_options(problem, TornOptions { preconditioner, ..TornOptions::default() })
    }

    /// As [`TornSolver::new`], for one process of several: each solves the same problem and works on its own subdomains. All processes
    /// call the same functions of the solver in the same order.
    ///
    /// # Errors
    /// As [`TornSolver::new`].
    pub fn with_communication(
        problem: Arc<ContactProblem>,
        preconditioner: PreconditionerKind,
        communication: Arc<dyn Communication>,
    ) -> Result<Self, ContactError> {
        Self::with_options(problem, TornOptions { preconditioner, communication, ..TornOptions::default() })
    }

    /// As [`TornSolver::with_communication`], with all options of the tearing.
    ///
    /// # Errors
    /// As [`TornSolver::new`], and [`ContactError::Clusters`].
    pub fn with_options(problem: Arc<ContactProblem>, options: TornOptions) -> Result<Self, ContactError> {
        let preconditioner = options.preconditioner;
        let model = TornModel::new(problem, options)?;
        Ok(Self { model, preconditioner, precision: Precision::default() })
    }

    /// The same solver with another precision of the products with search directions.
    #[must_use]
    pub fn with_precision(mut self, precision: Precision) -> Self {
        self.precision = precision;
        self
    }

    /// The problem that it solves.
    pub fn problem(&self) -> &ContactProblem {
        &self.model.problem
    }

    /// The torn model.
    pub fn model(&self) -> &TornModel {
        &self.model
    }

    /// Solves one shape to a relative residual by Newton's method; `start`: multipliers of a similar shape.
    ///
    /// # Errors
    /// [`ContactError`]: inverted elements, no equilibrium, no convergence.
    pub fn solve(
        &self,
        controls: &[f64],
        start: Option<&[f64]>,
        tolerance: f64,
    ) -> Result<(TornState, ContactForces, Work), ContactError> {
        self.solve_with(controls, start, &NewtonSettings::to(tolerance))
    }

    /// As [`TornSolver::solve`], with all settings of Newton's method.
    ///
    /// # Errors
    /// As [`TornSolver::solve`].
    pub fn solve_with(
        &self,
        controls: &[f64],
        start: Option<&[f64]>,
        settings: &NewtonSettings,
    ) -> Result<(TornState, ContactForces, Work), ContactError> {
        let (state, forces, work, ()) =
            self.solve_by(controls, settings.tolerance, |contact| Ok((contact.solve(start, settings)?, ())))?;
        Ok((state, forces, work))
    }

    /// Solves one shape by any method on the contact problem in the multipliers, and passes on what else the method returns
    /// (its default for bodies at rest, where there is nothing to solve).
    ///
    /// # Errors
    /// [`ContactError`]: inverted elements, no equilibrium, what the method returns, and [`ContactError::Inaccurate`] when the
    /// residuals of its state are above both 1e-8 and four times `allowed`.
    pub fn solve_by<T: Default>(
        &self,
        controls: &[f64],
        allowed: f64,
        method: impl FnOnce(&TornContact<'_>) -> Result<(TornSolution, T), ContactError>,
    ) -> Result<(TornState, ContactForces, Work, T), ContactError> {
        self.attempt(controls, allowed, method).map_err(|failed| *failed.error)
    }

    /// As [`TornSolver::solve_by`]; a failure says what work it cost.
    pub(crate) fn attempt<T: Default>(
        &self,
        controls: &[f64],
        allowed: f64,
        method: impl FnOnce(&TornContact<'_>) -> Result<(TornSolution, T), ContactError>,
    ) -> Result<(TornState, ContactForces, Work, T), Failed> {
        let mut clock = Clock::start();
        let mut seconds = StageSeconds::default();
        let configuration = Configuration::new(self.problem(), controls)?;
        seconds.equilibrium = clock.lap();
        Stage::Factorization.enter()?;
        let system = self.model.factorize(&configuration.blocks)?;
        seconds.factorization = clock.lap();
        Stage::CoarseSpace.enter()?;
        let grounded = self.model.grounded_amplitudes(&system, &configuration);
        let space = CoarseSpace::new(&self.model, &system, grounded)?;
        let stiffness = STIFFNESS_SHARE * self.flat_or_tall_share() * self.model.contact_stiffness(&system);
        let load = configuration.load(stiffness);
        seconds.coarse_space = clock.lap();
        Stage::Contact.enter()?;
        let scales = [stiffness, if load > 0.0 { load } else { 1.0 }];
        let contact = self.contact(&system, &space, &configuration.gaps, scales);
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
        let loaded = operator.loaded_displacement();
        let displacement = operator.displacement(loaded, &iterate.multipliers, &iterate.amplitudes);
        let forces = forces(&contact, &solution);
        let work = work(solution.steps);
        forces.residuals.check(allowed).map_err(|error| Failed { error: Box::new(error), work })?;
        seconds.recovery = clock.lap();
        let Configuration { blocks, gaps, .. } = configuration;
        let constraints = Arc::clone(&self.model.constraints);
        let state =
            TornState { blocks, space, constraints, solution, displacement, gaps, stiffness, load, system, seconds };
        Ok((state, forces, work, returned))
    }

    /// What flat or tall bricks leave of c: the diagonal of K is their largest stiffness, and most displacements of the
    /// boundary meet a smaller one.
    fn flat_or_tall_share(&self) -> f64 {
        self.problem().flat_or_tall().map_or(1.0, |ratio| ratio.recip().max(SMALLEST_SHARE))
    }

    /// The contact problem of a factored shape; `scales` are c and the load.
    fn contact<'a>(
        &'a self,
        system: &'a TornSystem,
        space: &'a CoarseSpace,
        gaps: &'a [f64],
        scales: [f64; 2],
    ) -> TornContact<'a> {
        let operator = DualOperator::new(&self.model, system);
        let preconditioner = Preconditioner::new(&self.model, system, self.preconditioner, scales[0]);
        TornContact::new(operator, space, preconditioner, gaps, scales, self.precision)
    }

    /// The contact problem of a state; none for bodies at rest.
    ///
    /// # Errors
    /// [`ContactError::ForeignState`] for a state of another mesh.
    fn contact_of<'a>(&'a self, state: &'a TornState) -> Result<Option<TornContact<'a>>, ContactError> {
        self.check(state)?;
        let contact = || self.contact(&state.system, &state.space, &state.gaps, [state.stiffness, state.load]);
        Ok((state.load > 0.0).then(contact))
    }

    fn check(&self, state: &TornState) -> Result<(), ContactError> {
        let (expected, found) = (self.model.interface.torn_count(), state.displacement.0.len());
        if expected != found || state.blocks.iter().any(|block| block.grid != self.problem().grid) {
            return Err(ContactError::ForeignState { what: "torn dofs", expected, found });
        }
        Ok(())
    }

    /// Contraction factor at a solved shape.
    ///
    /// # Errors
    /// [`ContactError::NotConverged`], [`ContactError::Unheld`], [`ContactError::ForeignState`] for a state of another mesh.
    pub fn diagnose(&self, state: &TornState) -> Result<Diagnosis, ContactError> {
        match self.contact_of(state)? {
            Some(contact) => contact.diagnose(&state.solution.linearizations),
            None => Ok(Diagnosis { contraction: 0.0, condition: None }),
        }
    }

    /// A rough contraction factor at a solved shape, by at most so many products with F.
    ///
    /// # Errors
    /// [`ContactError::Unheld`], [`ContactError::ForeignState`] for a state of another mesh.
    pub fn estimate_contraction(&self, state: &TornState, max_products: usize) -> Result<f64, ContactError> {
        let Some(contact) = self.contact_of(state)? else { return Ok(0.0) };
        contact.estimate_contraction(&state.solution, max_products)
    }

    /// Sensitivities of the column heights for a dual: j = ∂J/∂λ in packed physical rows, then l = ∂J/∂u over the nodes of all bodies where
    /// J depends on the displacements. Where there are several processes, all of them call it.
    ///
    /// # Errors
    /// [`ContactError::NotConverged`] from the adjoint, [`ContactError::ForeignState`] for a state or a dual of another mesh.
    pub fn sensitivities(
        &self,
        state: &TornState,
        direction: &[f64],
        tolerance: f64,
    ) -> Result<Sensitivities, ContactError> {
        self.sensitivities_within(state, direction, tolerance, MAX_PRODUCTS)
    }

    /// As [`TornSolver::sensitivities`], with at most so many products with F.
    pub(crate) fn sensitivities_within(
        &self,
        state: &TornState,
        direction: &[f64],
        tolerance: f64,
        max_products: usize,
    ) -> Result<Sensitivities, ContactError> {
        let mut clock = Clock::start();
        let (direction, loads) = self.problem().parts_of(direction)?;
        let Some(contact) = self.contact_of(state)? else {
            return Ok(Sensitivities::at_rest(self.problem().grid.column_count()));
        };
        Stage::Adjoint.enter()?;
        let constraints = &self.model.constraints;
        let mut scaled = constraints.zeros();
        let scales = constraints.contact_scales(contact.boundary);
        for ((scaled, physical), nu) in scaled.contact_mut().iter_mut().zip(direction).zip(scales) {
            *scaled = physical / nu;
        }
        let iterate = &state.solution.iterate;
        // A sensitivity of J over the height of the body, or over its displacement where that is larger; below the rounding of
        // this scale, no residual means anything.
        let heights = &state.blocks[0].upper;
        let height = heights.iter().sum::<f64>() / heights.len() as f64;
        let load = loads.map(|loads| DisplacementLoad::new(&contact.operator, loads, &state.displacement));
        let [work, size] = load.as_ref().map_or([0.0; 2], |load| load.products);
        let natural = (dot(scaled.contact(), iterate.multipliers.contact()).abs() + work.abs())
            / (contact.stiffness * height + contact.load);
        let linearizations = &state.solution.linearizations;
        let adjoint = contact.adjoint(linearizations, &scaled, load.as_ref(), tolerance, natural, max_products)?;
        let value_error = contact.value_error(iterate, &adjoint, &scaled).with_displacements(size);
        let adjoint_seconds = clock.lap();
        Stage::ShapeDerivative.enter()?;
        let heights = height_sensitivities(&self.model, &state.blocks[0], &state.displacement, &adjoint);
        let (applications, shape_seconds) = (contact.operator.applications(), clock.lap());
        Ok(Sensitivities { heights, applications, adjoint_seconds, shape_seconds, value_error })
    }

    /// Forward derivatives of a state for changes of the heights of the contact nodes, mm, one vector per change.
    ///
    /// # Errors
    /// [`ContactError::NotConverged`] from the linearized problems, [`ContactError::ForeignState`] for a state of another mesh or
    /// changes of another surface.
    pub fn tangents(&self, state: &TornState, changes: &[Vec<f64>], tolerance: f64) -> Result<Tangents, ContactError> {
        let expected = self.problem().grid.column_count();
        if let Some(found) = changes.iter().map(Vec::len).find(|found| *found != expected) {
            return Err(ContactError::ForeignState { what: "heights of contact nodes", expected, found });
        }
        let Some(contact) = self.contact_of(state)? else {
            return Ok(Tangents::at_rest(self.problem().boundary.row_count, changes));
        };
        Stage::Adjoint.enter()?;
        let surface = MovedSurface {
            lower: &state.blocks[0],
            displacement: &state.displacement,
            linearizations: &state.solution.linearizations,
        };
        contact.tangents(surface, changes, tolerance)
    }

    /// All bodies of a solved shape, lower first; torn copies of a node averaged. Where there are several processes, all of them call it,
    /// and the first one alone gets the bodies, the others none.
    ///
    /// # Errors
    /// [`ContactError::ForeignState`] for a state of another mesh.
    pub fn bodies(&self, state: &TornState) -> Result<Vec<SolvedBody>, ContactError> {
        self.check(state)?;
        Ok(whole_bodies(&self.model, &state.blocks, &state.displacement))
    }
}

/// The contact forces of a solution in physical units, with their certificates: the image of its last iterate is a fresh
/// product F λ.
fn forces(contact: &TornContact<'_>, solution: &TornSolution) -> ContactForces {
    let (boundary, iterate) = (contact.boundary, &solution.iterate);
    let (mut forces, mut jumps) = (iterate.multipliers.contact().to_vec(), iterate.jumps.contact().to_vec());
    let scales = contact.operator.model.constraints.contact_scales(boundary);
    for ((force, jump), nu) in forces.iter_mut().zip(&mut jumps).zip(scales) {
        *force /= nu;
        *jump *= nu;
    }
    let residuals = Residuals {
        equilibrium: contact.imbalance(&iterate.multipliers),
        newton: solution.residual,
        ..law_residuals(boundary, &forces, &jumps, contact.stiffness, contact.load)
    };
    let status = boundary.points.iter().zip(&solution.linearizations);
    let status = status.map(|(point, linearization)| linearization.status(point)).collect();
    let kink = Kink::of(boundary, &contact.arguments(iterate));
    let forces = admissible_forces(contact, &forces, &solution.linearizations);
    ContactForces::unpack(boundary, &forces, &jumps, status, residuals, kink)
}

/// Forces brought into the friction cone, and to zero at open nodes: what the iteration leaves outside is of the size of its
/// residual.
fn admissible_forces(contact: &TornContact<'_>, forces: &[f64], linearizations: &[Linearization]) -> Vec<f64> {
    let mut admissible = vec![0.0; forces.len()];
    for (point, linearization) in contact.boundary.points.iter().zip(linearizations) {
        if *linearization != Linearization::Open {
            let rows = point.start..point.start + point.row_count();
            law::project(&forces[rows.clone()], contact.boundary.friction, &mut admissible[rows]);
        }
    }
    admissible
}

impl TornState {
    /// λ over all rows, to start a similar problem from. Where there are several processes, all of them call it.
    pub fn multipliers(&self) -> Vec<f64> {
        self.constraints.whole(&self.solution.iterate.multipliers, self.space.distribution())
    }

    /// The bodies, lower first.
    pub(crate) fn blocks(&self) -> &[Block] {
        &self.blocks
    }

    /// Displacements over the torn dofs of this process, then its ghosts, mm.
    pub fn displacement(&self) -> &[f64] {
        &self.displacement.0
    }

    /// Force that residuals are relative to, N; zero for bodies at rest.
    pub fn load(&self) -> f64 {
        self.load
    }

    /// Seconds of the stages of the state.
    pub fn seconds(&self) -> StageSeconds {
        self.seconds
    }
}
