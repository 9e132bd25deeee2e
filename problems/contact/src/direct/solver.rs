//! From a shape to its contact state and coderivative by direct condensation.

use crate::direct::active_system::{ActiveFactor, ActiveSystem, Kept};
use crate::direct::compliant_body::{BodyLoad, BodyRows, CompliantBody, ContactBody, contact_stiffness};
use crate::direct::compliant_contact::CompliantContact;
use crate::direct::condensation::CondensationPattern;
use crate::direct::condensation_key::CondensationKey;
use crate::direct::condensed_shelf::CondensedShelf;
use crate::direct::continuation::Reached;
use crate::direct::continuation::equilibrium;
use crate::direct::forces::{CondensedSolution, forces};
use crate::direct::newton::{FLOOR_REACHED, SPRINGS};
use crate::equilibrium::law::Friction;
use crate::equilibrium::{
    Configuration, ContactProblem, ContactState, ContactWarmStart, ForceUnit, Positions, Stage, Work,
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
    /// Newton steps that a state may take.
    max_steps: usize,
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
    pub(super) load: f64,
    /// The factor of Newton's matrix, once a derivative has been asked for.
    active: OnceLock<ActiveFactor>,
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
        let key = |number| {
            let sides = problem.boundary.points.iter().flat_map(|point| &point.sides);
            let contact: BTreeSet<u32> = sides.filter(|side| side.body == number).map(|side| side.node).collect();
            let contact: Vec<u32> = contact.into_iter().collect();
            CondensationKey::of((&problem.bodies, number), &contact, &shelf.bodies)
        };
        let keys = (0..problem.bodies.len()).map(key).collect::<Result<Vec<_>, ContactError>>()?;
        let patterns = keys.iter().map(|key| Arc::clone(key.pattern())).collect();
        let max_steps = WorkEstimate::of(&problem.scene).condensed_steps_per_products(MAX_PRODUCTS);
        Ok(Self { problem, patterns, keys, shelf, max_steps, fixed: OnceLock::new() })
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
        let known = self.shelf.bodies.find(key, positions);
        let is_new = known.is_none();
        let factored = match known {
            Some(known) => known,
            None => {
                let factors = CompliantBody::new(&self.patterns[number], (body, rigid), number, positions)?;
                let factored = Arc::new(Factored { positions: Arc::clone(positions), factors });
                self.shelf.bodies.put(key, &factored);
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
            ContactBody { body, load, rows: Arc::new(rows) }
        };
        let bodies: Vec<ContactBody> = bodies.map(with_rows).collect();
        let stiffness = contact_stiffness(&self.problem, &bodies);
        let unit = configuration.unit(stiffness);
        let units = [if unit.first() > 0.0 { unit.first() } else { 1.0 }, stiffness.recip()];
        let rows = Arc::clone(&configuration.rows);
        let compliance = self.shelf.compliance(&bodies, boundary.row_count, units[1]);
        let contact = CompliantContact::new(Arc::clone(&self.problem), bodies, (rows, compliance), units);
        Ok((contact, unit, factorizations))
    }

    /// The state of a shape to a relative residual, from the forces and motions of a similar shape or from nothing.
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
            let found = Self::equilibrium(&mut contact, unit, start, (tolerance, self.max_steps));
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
        let state = DirectState { positions, contact, solution, load, active: OnceLock::new(), displacements };
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
        (tolerance, max_steps): (f64, usize),
    ) -> Result<(CondensedSolution, Work, usize), ContactError> {
        let start = start.and_then(|start| contact.unknowns_near(start));
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

impl DirectSolver {
    /// The problem that is solved.
    pub fn problem(&self) -> &ContactProblem {
        &self.problem
    }

    /// Number of degrees of freedom of all bodies, and number of multipliers.
    pub fn sizes(&self) -> [usize; 2] {
        [self.problem.displacement_count(), self.problem.boundary.row_count]
    }

    /// What this solver did not need for its scene, in words.
    pub fn left_out(&self) -> &'static str {
        "tearing, gluing, dual operator (direct condensation)"
    }

    /// As [`Solver::solve`](crate::solvers::Solver::solve).
    ///
    /// # Errors
    /// [`ContactError`]: inverted elements, no equilibrium, no convergence.
    pub fn solve(
        &self,
        controls: &[f64],
        start: Option<&ContactWarmStart>,
        tolerance: f64,
    ) -> Result<ContactState<DirectState>, ContactError> {
        let start = match start {
            Some(ContactWarmStart::Forces(forces)) => Some(forces.as_slice()),
            _ => None,
        };
        self.solve_configuration(Configuration::new(&self.problem, controls)?, start, tolerance)
    }

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
}

impl DirectState {
    /// The factor of Newton's matrix, with the smallest springs.
    pub(super) fn active(&self) -> &ActiveFactor {
        self.active.get_or_init(|| {
            let (contact, linearizations) = (&self.contact, &self.solution.linearizations);
            let system = ActiveSystem::new(contact, linearizations, 0.0, Friction::Coulomb, Kept::Coupled);
            ActiveFactor::new(system, Some(smallest_spring(contact)))
        })
    }

    /// Contact forces and free motions, from which a similar shape can be solved.
    pub fn warm_start(&self) -> ContactWarmStart {
        ContactWarmStart::Forces(self.contact.own_unknowns(&self.solution.unknowns))
    }
}

/// A spring relative to the mean compliance: one that is stiff beside bodies that bend would take a share of the load.
fn smallest_spring(contact: &CompliantContact) -> f64 {
    let points = &contact.problem.boundary.points;
    let normal = points.iter().map(|point| contact.compliance[(point.start, point.start)]).sum::<f64>();
    SPRINGS[0] * (points.len() as f64 / normal).min(1.0)
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
