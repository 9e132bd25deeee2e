//! From a shape to its contact state and coderivative by direct condensation.

use crate::direct::adjoint::adjoint;
use crate::direct::compliant_body::{BodyLoad, BodyRows, CompliantBody, ContactBody, contact_stiffness};
use crate::direct::compliant_contact::CompliantContact;
use crate::direct::condensation::CondensationPattern;
use crate::direct::condensation_key::{CondensationKey, CondensedShelf};
use crate::direct::continuation::Reached;
use crate::direct::continuation::equilibrium;
use crate::direct::diagnosis::{diagnose, estimate_contraction};
use crate::direct::displacement_load::CondensedLoad;
use crate::direct::displacement_tangents::displacement_tangents;
use crate::direct::force_rounding::change_of_forces;
use crate::direct::forces::{CondensedSolution, forces};
use crate::direct::newton::FLOOR_REACHED;
use crate::direct::tangents::{CondensedTangents, tangents};
use crate::equilibrium::trace_work::TraceWork;
use crate::equilibrium::{
    Configuration, ContactProblem, ContactSolver, ContactState, ContactWarmStart, Diagnosis, ForceUnit, Positions,
    Sensitivities, SolvedBody, SolverState, Stage, Tangents, TangentsOf, ValueError, Work,
};
use crate::error::ContactError;
use crate::linear::vector::norm;
use crate::shelf::Factored;
use crate::solvers::SolverKind;
use crate::work_estimate::{MAX_PRODUCTS, WorkEstimate};
use nonsmooth::interruption::interrupted;
use std::collections::BTreeSet;
use std::sync::atomic::AtomicUsize;
use std::sync::{Arc, OnceLock};
use std::time::Instant;

/// How states are found by Newton's method.
const BY_NEWTON: &str = "semismooth Newton on condensed bodies, with continuation in the contact compliance";
/// How states are found where Newton's method fails.
const BY_PROGRAMS: &str =
    "semismooth Newton on condensed bodies, with continuation in the contact compliance, then from cone programs,";

/// The direct solver of one problem.
#[derive(Debug)]
pub struct DirectSolver {
    pub(crate) problem: Arc<ContactProblem>,
    pub(super) patterns: Vec<Arc<CondensationPattern>>,
    /// What the factors of the bodies depend on beside positions.
    keys: Vec<Arc<CondensationKey>>,
    shelf: Arc<CondensedShelf>,
    /// The bodies of fixed shape, by number.
    fixed: OnceLock<Vec<(usize, CondensedPart)>>,
}

/// A body of a shape without its rows.
type CondensedPart = (Arc<Factored<CompliantBody>>, Arc<BodyLoad>);

/// A solved shape with all that its coderivative needs.
#[derive(Debug)]
pub struct DirectState {
    pub(super) positions: Positions,
    pub(super) contact: CompliantContact,
    pub(super) solution: CondensedSolution,
    /// Force that residuals are relative to, N; zero for bodies at rest.
    load: f64,
    /// Displacements over the dofs of the bodies, once they have been asked for.
    pub(super) displacements: Vec<OnceLock<Vec<f64>>>,
}

impl DirectSolver {
    /// Analyses the bodies of a problem.
    ///
    /// # Errors
    /// [`ContactError::Factorization`] when a symbolic analysis fails.
    pub fn new(problem: Arc<ContactProblem>) -> Result<Self, ContactError> {
        Self::sharing(problem, Arc::default())
    }

    /// As [`DirectSolver::new`], with factors that solvers on one shelf share.
    ///
    /// # Errors
    /// As [`DirectSolver::new`].
    pub fn sharing(problem: Arc<ContactProblem>, shelf: Arc<CondensedShelf>) -> Result<Self, ContactError> {
        let pattern = |(number, body)| {
            let sides = problem.boundary.points.iter().flat_map(|point| &point.sides);
            let contact: BTreeSet<u32> = sides.filter(|side| side.body == number).map(|side| side.node).collect();
            Ok(Arc::new(CondensationPattern::new(body, &contact.into_iter().collect::<Vec<u32>>())?))
        };
        let patterns = problem.bodies.iter().enumerate().map(pattern);
        let patterns = patterns.collect::<Result<Vec<Arc<CondensationPattern>>, ContactError>>()?;
        let key = |(number, pattern): (usize, &Arc<CondensationPattern>)| {
            Arc::new(CondensationKey::new(Arc::clone(&problem.bodies), number, Arc::clone(pattern)))
        };
        let keys = patterns.iter().enumerate().map(key).collect();
        Ok(Self { problem, patterns, keys, shelf, fixed: OnceLock::new() })
    }

    /// The contact problem in the forces of given controls: the data of the state, for other methods.
    ///
    /// # Errors
    /// [`ContactError`]: inverted elements, no equilibrium of rigid bodies, a failing factorisation.
    pub fn contact(&self, controls: &[f64]) -> Result<CompliantContact, ContactError> {
        Ok(self.condense(&Configuration::new(&self.problem, controls)?)?.0)
    }

    /// A body of a shape, and whether it has been factored for it or taken from the shelf.
    fn condense_body(
        &self,
        number: usize,
        configuration: &Configuration,
    ) -> Result<(CondensedPart, bool), ContactError> {
        let (body, key) = (&self.problem.bodies[number], &self.keys[number]);
        let (positions, rigid) = (&configuration.positions[number], &configuration.rigid);
        let known = self.shelf.find(key, positions);
        let is_new = known.is_none();
        let factored = match known {
            Some(known) => known,
            None => {
                let condensed = self.patterns[number].condense(body, positions)?;
                let factors = CompliantBody::new(condensed, (body, rigid), number, positions);
                let factored = Arc::new(Factored { positions: Arc::clone(positions), factors });
                self.shelf.put(key, &factored);
                factored
            }
        };
        let load = Arc::new(factored.factors.loaded(body, rigid, number, positions));
        Ok(((factored, load), is_new))
    }

    /// Condenses all bodies of a shape; also the unit of forces (zero at rest) and the number of factorisations.
    fn condense(&self, configuration: &Configuration) -> Result<(CompliantContact, ForceUnit, usize), ContactError> {
        Stage::Factorization.enter()?;
        let map = &self.problem.map;
        let condensed = |number: usize| Ok((number, self.condense_body(number, configuration)?));
        let mut factorizations = 0;
        let mut bodies: Vec<(usize, CondensedPart)> = Vec::new();
        for number in map.shaped_bodies() {
            let (number, (part, is_new)) = condensed(number)?;
            factorizations += usize::from(is_new);
            bodies.push((number, part));
        }
        if self.fixed.get().is_none() {
            // These bodies keep their shape: they are factored at the first call and shared afterwards.
            let fixed = (0..self.patterns.len()).filter(|&number| !map.shapes(number)).map(condensed);
            let fixed = fixed.collect::<Result<Vec<_>, ContactError>>()?;
            factorizations += fixed.iter().filter(|(_, (_, is_new))| *is_new).count();
            // Another thread may have been first; its factors are the same.
            let _ = self.fixed.set(fixed.into_iter().map(|(number, (part, _))| (number, part)).collect());
        }
        bodies.extend(self.fixed.get().into_iter().flatten().cloned());
        bodies.sort_by_key(|(number, _)| *number);
        let bodies = bodies.into_iter();
        let boundary = &self.problem.boundary;
        let with_rows = |(number, (body, load)): (usize, CondensedPart)| {
            let rows = BodyRows::new(number, &body.factors.condensed, boundary, &configuration.rows);
            ContactBody { body, load, rows }
        };
        let bodies: Vec<ContactBody> = bodies.map(with_rows).collect();
        let stiffness = contact_stiffness(boundary, &bodies);
        let unit = configuration.unit(stiffness);
        let units = [if unit.first() > 0.0 { unit.first() } else { 1.0 }, stiffness.recip()];
        let rows = Arc::clone(&configuration.rows);
        let contact = CompliantContact::new(Arc::clone(&self.problem), bodies, rows, units);
        Ok((contact, unit, factorizations))
    }

    /// The state of a shape to a relative residual, from contact displacements of a similar shape or from nothing.
    pub(crate) fn solve_configuration(
        &self,
        configuration: Configuration,
        start: Option<&[f64]>,
        tolerance: f64,
    ) -> Result<ContactState<DirectState>, ContactError> {
        let (mut contact, unit, factorizations) = self.condense(&configuration)?;
        Stage::Contact.enter()?;
        let (solution, work, programs) = if unit.first() > 0.0 {
            // Why there is no state is asked only where none was found.
            let found = Self::equilibrium(&mut contact, unit, start, tolerance);
            found.map_err(|error| match error {
                // Where rounding hides the state, it hides a proof as well.
                ContactError::BeyondPrecision { .. } | ContactError::Interrupted => error,
                error => refusal(&contact).unwrap_or(error),
            })?
        } else {
            (at_rest(&contact), Work::default(), 0)
        };
        let load = if unit.first() > 0.0 { contact.load } else { 0.0 };
        let displacements = contact.bodies.iter().map(|_| OnceLock::new()).collect();
        let forces = forces(&contact, &solution, &configuration);
        forces.residuals.check(tolerance)?;
        let Configuration { positions, rows, .. } = configuration;
        let state = DirectState { positions, contact, solution, load, displacements };
        Ok(ContactState {
            forces,
            rows,
            load,
            solver: SolverKind::Direct,
            reason: (programs > 0).then(|| format!("{BY_NEWTON}, found no state; cone program {programs} led to it")),
            contraction: None,
            stages: None,
            work: Work { factorizations, ..work },
            adjoint_applications: AtomicUsize::new(0),
            solution: state,
            bodies: None,
        })
    }

    /// The equilibrium of a condensed shape, with the work and the cone programs that it took.
    fn equilibrium(
        contact: &mut CompliantContact,
        unit: ForceUnit,
        start: Option<&[f64]>,
        tolerance: f64,
    ) -> Result<(CondensedSolution, Work, usize), ContactError> {
        let size: usize = contact.bodies.iter().map(|body| body.load.free.len()).sum();
        let start = start.filter(|start| start.len() == size).map(|start| contact.unknowns_near(start));
        let max_steps = WorkEstimate::of(&contact.problem.scene).condensed_steps_per_products(MAX_PRODUCTS);
        let mut reached = equilibrium(contact, start.as_deref(), tolerance, max_steps);
        if reached.solved {
            reached.refine(contact, unit, tolerance);
        }
        let (work, programs) = (reached.work(), reached.programs.as_ref().map_or(0, |programs| programs.count));
        if interrupted() {
            return Err(ContactError::Interrupted);
        }
        if !reached.solved {
            let residual = norm(&contact.residual(&reached.unknowns, 0.0).0);
            let floor = contact.rounding(&reached.unknowns);
            // A state that has not come down to the floor says nothing about rounding.
            if residual <= FLOOR_REACHED * floor {
                let what = "displacements (bodies, gaps or loads of very different size)";
                return Err(ContactError::BeyondPrecision { what, floor, residual, tolerance });
            }
            return Err(ContactError::NotConverged {
                solver: if programs > 0 { BY_PROGRAMS } else { BY_NEWTON },
                residual,
                tolerance,
                iterations: work.dense_factorizations,
                history: reached.history,
            });
        }
        let (forces, displacement) = contact.dimensional(&reached.unknowns);
        let Reached { unknowns, linearizations, .. } = reached;
        Ok((CondensedSolution { unknowns, displacement, forces, linearizations }, work, programs))
    }
}

impl ContactSolver for DirectSolver {
    type State = DirectState;

    fn problem(&self) -> &ContactProblem {
        &self.problem
    }

    fn sizes(&self) -> [usize; 2] {
        [self.problem.displacement_count(), self.problem.boundary.row_count]
    }

    fn left_out(&self) -> Option<&'static str> {
        Some("tearing, gluing, dual operator (direct condensation)")
    }

    fn solve(
        &self,
        controls: &[f64],
        start: Option<&ContactWarmStart>,
        tolerance: f64,
    ) -> Result<ContactState<DirectState>, ContactError> {
        let start = match start {
            Some(ContactWarmStart::Displacements(displacements)) => Some(displacements.as_slice()),
            _ => None,
        };
        self.solve_configuration(Configuration::new(&self.problem, controls)?, start, tolerance)
    }

    fn sensitivities(
        &self,
        state: &DirectState,
        direction: &[f64],
        _tolerance: f64,
    ) -> Result<Sensitivities, ContactError> {
        self.check(state)?;
        let (direction, displacements) = self.problem.parts_of(direction)?;
        if state.load == 0.0 {
            return Ok(Sensitivities::at_rest(&self.problem));
        }
        let clock = Instant::now();
        Stage::Adjoint.enter()?;
        let solution = &state.solution;
        let loads = displacements.map_or_else(Vec::new, |displacements| self.condensed_loads(state, displacements));
        let adjoint = adjoint(&state.contact, &solution.unknowns, &solution.linearizations, direction, &loads);
        let value_error = ValueError::from_terms(&adjoint.error_terms, direction, &solution.forces);
        let value_error = value_error.with_displacements(loads.iter().map(|load| load.size).sum());
        let mut loads: Vec<Vec<f64>> = loads.into_iter().map(|load| load.full).collect();
        let extended = |body: usize| {
            let none = || vec![0.0; state.displacement(body).len()];
            let load = loads.get_mut(body).map_or_else(none, std::mem::take);
            let (own, on_contact) = (&self.problem.bodies[body], &adjoint.displacements[body]);
            let p = state.contact.bodies[body].extend_under(own, on_contact, &adjoint.multipliers, &load);
            (body, p)
        };
        let adjoint_displacements: Vec<(usize, Vec<f64>)> = self.problem.map.shaped_bodies().map(extended).collect();
        let adjoint_seconds = clock.elapsed().as_secs_f64();
        Stage::ShapeDerivative.enter()?;
        let positions = self.shape_derivative(state, &adjoint_displacements, &adjoint);
        if positions.as_flattened().iter().any(|value| !value.is_finite()) {
            return Err(ContactError::NotFinite { what: "adjoint of the condensed state" });
        }
        let shape_seconds = clock.elapsed().as_secs_f64() - adjoint_seconds;
        Ok(Sensitivities { positions, applications: 0, adjoint_seconds, shape_seconds, value_error })
    }

    fn tangents(
        &self,
        state: &DirectState,
        changes: &[Vec<f64>],
        of: TangentsOf,
        _tolerance: f64,
    ) -> Result<Tangents, ContactError> {
        self.check(state)?;
        self.problem.check_changes(changes)?;
        let velocities = self.problem.map.velocities(changes);
        if state.load == 0.0 {
            return Ok(Tangents::at_rest(&self.problem, &state.contact.rows, &velocities, of));
        }
        Stage::Adjoint.enter()?;
        let traces = TraceWork::new(&self.problem, &state.contact.rows, &state.positions);
        let traces = traces.map(|work| work.along(&velocities));
        let forces = self.shape_forces(state, &velocities, traces.as_ref());
        // Condensing them takes their place, so that what needs them again has a copy.
        let kept = (of == TangentsOf::Displacements).then(|| forces.clone());
        let loads = self.shape_loads(state, (&velocities, traces.as_ref()), forces);
        let linearizations = &state.solution.linearizations;
        let mut found = tangents(&state.contact, linearizations, &loads);
        found.tangents.displacements = kept.map(|forces| displacement_tangents(&state.contact, forces, &loads, &found));
        let CondensedTangents { tangents, .. } = found;
        let displacements = tangents.displacements.iter().flatten();
        let entries = tangents.forces.iter().chain(&tangents.openings).chain(displacements).flatten();
        if entries.copied().any(|entry| !entry.is_finite()) {
            return Err(ContactError::NotFinite { what: "tangents of the condensed state" });
        }
        Ok(tangents)
    }

    fn diagnose(&self, state: &DirectState) -> Result<Diagnosis, ContactError> {
        self.check(state)?;
        if state.load == 0.0 {
            return Ok(Diagnosis { contraction: 0.0, condition: None });
        }
        diagnose(&state.contact, &state.solution.linearizations)
    }

    fn estimate_contraction(&self, state: &DirectState, _max_products: usize) -> Result<f64, ContactError> {
        self.check(state)?;
        if state.load == 0.0 {
            return Ok(0.0);
        }
        Ok(estimate_contraction(&state.contact, &state.solution.unknowns, &state.solution.linearizations))
    }

    fn force_rounding(&self, state: &DirectState) -> Result<f64, ContactError> {
        self.check(state)?;
        if state.load == 0.0 {
            return Ok(0.0);
        }
        let (contact, solution) = (&state.contact, &state.solution);
        let parts = contact.bodies.iter().zip(self.problem.bodies.iter().zip(&state.positions));
        let delta = parts.map(|(own, (body, positions))| own.refinement(body, positions, &solution.forces));
        Ok(change_of_forces(contact, &solution.linearizations, &delta.collect::<Vec<_>>()))
    }

    fn bodies(&self, state: &DirectState) -> Result<Vec<SolvedBody>, ContactError> {
        self.whole_bodies(state)
    }
}

impl DirectSolver {
    /// Checks that a state is one of this problem's mesh.
    ///
    /// # Errors
    /// [`ContactError::ForeignState`].
    pub(super) fn check(&self, state: &DirectState) -> Result<(), ContactError> {
        let expected = 3 * self.patterns.iter().map(|pattern| pattern.contact.len()).sum::<usize>();
        let found = state.solution.displacement.len();
        let nodes = self.problem.bodies.iter().zip(&state.positions);
        let mut nodes = nodes.map(|(body, positions)| (body.mesh.node_count(), positions.len()));
        if expected != found || nodes.any(|(own, other)| own > other) {
            return Err(ContactError::ForeignState { what: "contact dofs", expected, found });
        }
        Ok(())
    }

    /// ∂J/∂u of all bodies as loads on them.
    fn condensed_loads(&self, state: &DirectState, displacements: &[f64]) -> Vec<CondensedLoad> {
        let mut rest = displacements;
        let load = |number: usize| {
            let (body, piece) = (&self.problem.bodies[number], &self.patterns[number].piece);
            let (own, others) = rest.split_at(3 * body.mesh.node_count());
            rest = others;
            let mut load = vec![0.0; piece.dof_count()];
            for (node, force) in own.as_chunks::<3>().0.iter().enumerate() {
                piece.add_force(node as u32, *force, &mut load);
            }
            CondensedLoad::new((body, state.contact.bodies[number].stiff()), load, state.displacement(number))
        };
        (0..self.patterns.len()).map(load).collect()
    }
}

impl SolverState for DirectState {
    fn warm_start(&self) -> ContactWarmStart {
        ContactWarmStart::Displacements(self.solution.displacement.clone())
    }
}

/// The state of bodies that nothing loads and nothing penetrates: no forces, no displacements.
fn at_rest(contact: &CompliantContact) -> CondensedSolution {
    let unknowns = vec![0.0; contact.row_count() + contact.resultant.len()];
    let linearizations = contact.linearize(&contact.residual(&unknowns, 0.0).1);
    let (forces, displacement) = contact.dimensional(&unknowns);
    CondensedSolution { unknowns, displacement, forces, linearizations }
}

/// The proof that there is no equilibrium, where one is found.
#[cfg(feature = "interior-point")]
fn refusal(contact: &CompliantContact) -> Option<ContactError> {
    crate::direct::resistance::refusal(contact)
}

/// Proofs need cone programs.
#[cfg(not(feature = "interior-point"))]
fn refusal(_contact: &CompliantContact) -> Option<ContactError> {
    None
}
