//! From a shape to its contact state and coderivative by direct condensation.

use crate::body::mesh::{Block, Subdomain};
use crate::body::shape_force::shape_forces;
use crate::body::shape_sensitivity::column_sensitivities;
use crate::direct::compliant_body::CompliantBody;
use crate::direct::compliant_contact::CompliantContact;
use crate::direct::condensation::{CondensationPattern, CondensedBody};
use crate::direct::displacement_load::CondensedLoad;
use crate::direct::newton::{FLOOR_REACHED, Reached};
use crate::equilibrium::certificate::law_residuals;
use crate::equilibrium::law::Linearization;
use crate::equilibrium::modes::RigidScene;
use crate::equilibrium::{
    Configuration, ContactForces, ContactProblem, ContactSolver, ContactState, ContactWarmStart, Diagnosis, Kink,
    Residuals, Sensitivities, SolvedBody, SolverState, Stage, Tangents, ValueError, Work,
};
use crate::error::ContactError;
use crate::linear::vector::norm;
use crate::scene::BodyScene;
use crate::solvers::SolverKind;
use crate::work_estimate::{MAX_PRODUCTS, WorkEstimate};
use faer::Mat;
use nonsmooth::interruption::interrupted;
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
    lower: CondensationPattern,
    upper: Option<CondensationPattern>,
    fixed: OnceLock<Arc<CompliantBody>>,
    /// Held contact dofs, per body.
    pub(super) held: Vec<Vec<bool>>,
}

/// A solved shape with all that its coderivative needs.
#[derive(Debug)]
pub struct DirectState {
    pub(super) block: Block,
    pub(super) contact: CompliantContact,
    pub(super) solution: CondensedSolution,
    /// Force that residuals are relative to, N; zero for bodies at rest.
    load: f64,
    /// Displacements of the whole bodies, once they have been asked for.
    pub(super) displacements: Vec<OnceLock<Vec<f64>>>,
}

/// The solution in physical units.
#[derive(Debug)]
pub(super) struct CondensedSolution {
    /// Forces and amplitudes, dimensionless.
    pub(super) unknowns: Vec<f64>,
    /// Contact displacements of all bodies, mm.
    pub(super) displacement: Vec<f64>,
    pub(super) forces: Vec<f64>,
    pub(super) linearizations: Vec<Linearization>,
}

impl DirectSolver {
    /// Analyses the bodies of a problem.
    ///
    /// # Errors
    /// [`ContactError::Factorization`] when a symbolic analysis fails.
    pub fn new(problem: Arc<ContactProblem>) -> Result<Self, ContactError> {
        let (scene, grid) = (&problem.scene, &problem.grid);
        let lower = CondensationPattern::new(grid, &scene.lower, grid.cells[2])?;
        let upper = match &scene.upper {
            Some(upper) => Some(CondensationPattern::new(grid, &upper.body, 0)?),
            None => None,
        };
        let held = |(scene, layer): (&BodyScene, usize)| {
            grid.columns().flat_map(|(i, j)| scene.held(grid, [i, j, layer])).collect()
        };
        let held = problem.bodies().zip([grid.cells[2], 0]).map(held).collect();
        Ok(Self { problem, lower, upper, fixed: OnceLock::new(), held })
    }

    /// The contact problem in the forces of given controls: the data of the state, for other methods.
    ///
    /// # Errors
    /// [`ContactError`]: inverted elements, no equilibrium of rigid bodies, a failing factorisation.
    pub fn contact(&self, controls: &[f64]) -> Result<CompliantContact, ContactError> {
        Ok(self.condense(Configuration::new(&self.problem, controls)?)?.0)
    }

    /// Condenses all bodies of a shape; also its lower block, the load (zero at rest) and the number of factorisations.
    fn condense(&self, configuration: Configuration) -> Result<(CompliantContact, Block, f64, usize), ContactError> {
        Stage::Factorization.enter()?;
        let lower = self.lower.condense(&configuration.blocks[0], &self.problem.scene.lower)?;
        let lower = Arc::new(self.compliant(lower, &configuration.rigid, 0));
        let (upper, factorizations) = self.upper_body(&configuration)?;
        let load = configuration.load(contact_stiffness(&lower, upper.as_deref()));
        let bodies = std::iter::once(lower).chain(upper).collect();
        let unit = if load > 0.0 { load } else { 1.0 };
        let contact = CompliantContact::new(Arc::clone(&self.problem), bodies, &configuration.gaps, unit);
        let mut blocks = configuration.blocks;
        Ok((contact, blocks.swap_remove(0), load, 1 + factorizations))
    }

    fn compliant(&self, condensed: CondensedBody, rigid: &RigidScene, body: usize) -> CompliantBody {
        let sign = if body == 0 { 1.0 } else { -1.0 };
        CompliantBody::new(condensed, rigid.own_motions(body), &self.problem.boundary, &self.held[body], sign)
    }

    /// The upper body, which keeps its shape: it is factored at the first call and shared afterwards. Also the number
    /// of factorisations done.
    fn upper_body(&self, configuration: &Configuration) -> Result<(Option<Arc<CompliantBody>>, usize), ContactError> {
        let (Some(pattern), Some(scene)) = (&self.upper, &self.problem.scene.upper) else { return Ok((None, 0)) };
        if let Some(body) = self.fixed.get() {
            return Ok((Some(Arc::clone(body)), 0));
        }
        let condensed = pattern.condense(&configuration.blocks[1], &scene.body)?;
        let body = Arc::new(self.compliant(condensed, &configuration.rigid, 1));
        // Another thread may have been first; its factor is the same.
        Ok((Some(Arc::clone(self.fixed.get_or_init(|| body))), 1))
    }

    /// The state of a shape to a relative residual, from contact displacements of a similar shape or from nothing.
    pub(crate) fn solve_configuration(
        &self,
        configuration: Configuration,
        start: Option<&[f64]>,
        tolerance: f64,
    ) -> Result<ContactState<DirectState>, ContactError> {
        let (mut contact, block, load, factorizations) = self.condense(configuration)?;
        Stage::Contact.enter()?;
        let (solution, work, programs) = if load > 0.0 {
            // Why there is no state is asked only where none was found.
            let found = Self::equilibrium(&mut contact, start, tolerance);
            found.map_err(|error| match error {
                // Where rounding hides the state, it hides a proof as well.
                ContactError::BeyondPrecision { .. } | ContactError::Interrupted => error,
                error => refusal(&contact).unwrap_or(error),
            })?
        } else {
            (contact.at_rest(), Work::default(), 0)
        };
        let displacements = contact.bodies.iter().map(|_| OnceLock::new()).collect();
        let state = DirectState { block, contact, solution, load, displacements };
        let forces = state.forces();
        forces.residuals.check(tolerance)?;
        Ok(ContactState {
            forces,
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
        start: Option<&[f64]>,
        tolerance: f64,
    ) -> Result<(CondensedSolution, Work, usize), ContactError> {
        let size: usize = contact.bodies.iter().map(|body| body.free.len()).sum();
        let start = start.filter(|start| start.len() == size).map(|start| contact.unknowns_near(start));
        let max_steps = WorkEstimate::of(&contact.problem.scene).condensed_steps_per_products(MAX_PRODUCTS);
        let reached = contact.equilibrium(start.as_deref(), tolerance, max_steps);
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
        [3 * self.problem.grid.node_count() * self.held.len(), self.problem.boundary.row_count]
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
            return Ok(Sensitivities::at_rest(self.problem.grid.column_count()));
        }
        let clock = Instant::now();
        Stage::Adjoint.enter()?;
        let solution = &state.solution;
        let loads = displacements.map_or_else(Vec::new, |displacements| self.condensed_loads(state, displacements));
        let adjoint = state.contact.adjoint(&solution.unknowns, &solution.linearizations, direction, &loads);
        let value_error = ValueError::from_terms(&adjoint.error_terms, direction, &solution.forces);
        let value_error = value_error.with_displacements(state.size_of(&loads));
        let u = state.displacement(0);
        let none = || vec![0.0; u.len()];
        let load = loads.into_iter().next().map_or_else(none, |load| load.full);
        let p = state.extend_under(0, &adjoint.displacement, &adjoint.multipliers, &load);
        let adjoint_seconds = clock.elapsed().as_secs_f64();
        Stage::ShapeDerivative.enter()?;
        let heights = self.height_sensitivities(state, u, &p, &adjoint.multipliers);
        if heights.iter().any(|height| !height.is_finite()) {
            return Err(ContactError::NotFinite { what: "adjoint of the condensed state" });
        }
        let shape_seconds = clock.elapsed().as_secs_f64() - adjoint_seconds;
        Ok(Sensitivities { heights, applications: 0, adjoint_seconds, shape_seconds, value_error })
    }

    fn tangents(&self, state: &DirectState, changes: &[Vec<f64>], _tolerance: f64) -> Result<Tangents, ContactError> {
        self.check(state)?;
        self.problem.check_changes(changes)?;
        let rows = self.problem.boundary.row_count;
        if state.load == 0.0 {
            return Ok(Tangents::at_rest(rows, changes));
        }
        Stage::Adjoint.enter()?;
        let (solution, lower) = (&state.solution, &state.contact.bodies[0]);
        let u = state.displacement(0);
        let (grid, scene) = (&self.problem.grid, &self.problem.scene.lower);
        let whole = Subdomain::whole(grid);
        let forces = shape_forces(&state.block, &whole, &scene.material, &scene.loads, u, changes);
        let forces = Mat::from_fn(u.len(), changes.len(), |dof, column| forces[column][dof]);
        let loads = lower.condensed.condense_loads(forces, &self.lower.held);
        let tangents = state.contact.tangents(&solution.linearizations, &loads, changes);
        let entries = tangents.forces.iter().chain(&tangents.openings).flatten();
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
        state.contact.diagnose(&state.solution.linearizations)
    }

    fn estimate_contraction(&self, state: &DirectState, _max_products: usize) -> Result<f64, ContactError> {
        self.check(state)?;
        if state.load == 0.0 {
            return Ok(0.0);
        }
        Ok(state.contact.estimate_contraction(&state.solution.unknowns, &state.solution.linearizations))
    }

    fn force_rounding(&self, state: &DirectState) -> Result<f64, ContactError> {
        self.check(state)?;
        if state.load == 0.0 {
            return Ok(0.0);
        }
        let (contact, solution) = (&state.contact, &state.solution);
        let upper = self.problem.upper_block()?;
        let blocks = std::iter::once(&state.block).chain(&upper);
        let patterns = std::iter::once(&self.lower).chain(&self.upper);
        let parts = contact.bodies.iter().zip(patterns).zip(self.problem.bodies().zip(blocks));
        let delta =
            parts.map(|((body, pattern), (scene, block))| body.refinement(pattern, scene, block, &solution.forces));
        Ok(contact.change_of_forces(&solution.linearizations, &delta.collect::<Vec<_>>()))
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
        let (expected, found) =
            (3 * self.problem.boundary.points.len() * self.held.len(), state.solution.displacement.len());
        if expected != found || state.block.grid != self.problem.grid {
            return Err(ContactError::ForeignState { what: "contact dofs", expected, found });
        }
        Ok(())
    }

    /// ∂J/∂u of all bodies as loads on them.
    fn condensed_loads(&self, state: &DirectState, displacements: &[f64]) -> Vec<CondensedLoad> {
        let bodies = state.contact.bodies.iter().zip(std::iter::once(&self.lower).chain(&self.upper));
        let loads = displacements.chunks_exact(3 * self.problem.grid.node_count());
        bodies.zip(loads).map(|((body, pattern), load)| CondensedLoad::new(body, pattern, load)).collect()
    }

    /// Element sums over the lower body, per contact node: displacements u, their adjoint p, packed multipliers η.
    fn height_sensitivities(&self, state: &DirectState, u: &[f64], p: &[f64], eta: &[f64]) -> Vec<f64> {
        let (grid, lower) = (&self.problem.grid, &self.problem.scene.lower);
        let whole = Subdomain::whole(grid);
        let mut heights = vec![0.0; grid.column_count()];
        for (column, value) in column_sensitivities(&state.block, &whole, &lower.material, &lower.loads, u, p) {
            heights[column] += value;
        }
        // The gap F² − F_α falls as the surface rises.
        for (height, point) in heights.iter_mut().zip(&self.problem.boundary.points) {
            *height -= eta[point.start];
        }
        heights
    }
}

impl SolverState for DirectState {
    fn warm_start(&self) -> ContactWarmStart {
        ContactWarmStart::Displacements(self.solution.displacement.clone())
    }
}

impl CompliantContact {
    /// The state of bodies that nothing loads and nothing penetrates: no forces, no displacements.
    fn at_rest(&self) -> CondensedSolution {
        let unknowns = vec![0.0; self.row_count() + self.resultant.len()];
        let linearizations = self.linearize(&self.residual(&unknowns, 0.0).1);
        let (forces, displacement) = self.dimensional(&unknowns);
        CondensedSolution { unknowns, displacement, forces, linearizations }
    }
}

impl DirectState {
    /// Σ|l_i u_i| of loads on all bodies.
    fn size_of(&self, loads: &[CondensedLoad]) -> f64 {
        let products = loads
            .iter()
            .enumerate()
            .map(|(body, load)| load.full.iter().zip(self.displacement(body)).map(|(l, u)| (l * u).abs()).sum::<f64>());
        products.sum()
    }

    fn forces(&self) -> ContactForces {
        let (contact, solution) = (&self.contact, &self.solution);
        let boundary = &contact.problem.boundary;
        let (residual, arguments) = contact.residual(&solution.unknowns, 0.0);
        let status = boundary.points.iter().zip(&solution.linearizations);
        let status = status.map(|(point, linearization)| linearization.status(point)).collect();
        let length = contact.unit * contact.load;
        let jumps: Vec<f64> = contact.jumps(&solution.unknowns, 0.0).iter().map(|jump| jump * length).collect();
        let imbalance = contact.bodies.iter().map(|body| body.imbalance(&solution.forces)).fold(0.0, f64::hypot);
        let residuals = Residuals {
            equilibrium: imbalance / contact.load,
            newton: norm(&residual),
            ..law_residuals(boundary, &solution.forces, &jumps, 1.0 / contact.unit, contact.load)
        };
        let mut forces = solution.forces.clone();
        for (point, linearization) in boundary.points.iter().zip(&solution.linearizations) {
            if *linearization == Linearization::Open {
                forces[point.start..point.start + point.row_count()].fill(0.0);
            }
        }
        ContactForces::unpack(boundary, &forces, &jumps, status, residuals, Kink::of(boundary, &arguments))
    }
}

/// The proof that there is no equilibrium, where one is found.
#[cfg(feature = "interior-point")]
fn refusal(contact: &CompliantContact) -> Option<ContactError> {
    contact.refusal()
}

/// Proofs need cone programs.
#[cfg(not(feature = "interior-point"))]
fn refusal(_contact: &CompliantContact) -> Option<ContactError> {
    None
}

/// Mean normal stiffness of the contact nodes, bodies in series, N/mm.
fn contact_stiffness(lower: &CompliantBody, upper: Option<&CompliantBody>) -> f64 {
    let count = lower.condensed.schur.nrows() / 3;
    let diagonal = |body: &CompliantBody, node: usize| body.condensed.schur[(3 * node + 2, 3 * node + 2)];
    let sum: f64 = (0..count)
        .map(|node| match upper {
            Some(upper) => 1.0 / (1.0 / diagonal(lower, node) + 1.0 / diagonal(upper, node)),
            None => diagonal(lower, node),
        })
        .sum();
    sum / count as f64
}
