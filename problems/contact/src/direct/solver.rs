//! From a shape to its contact state and coderivative by direct condensation.

use crate::body::mesh::{Block, Subdomain};
use crate::body::shape_sensitivity::column_sensitivities;
use crate::direct::condensation::{CondensationPattern, CondensedBody};
use crate::direct::newton::{CondensedContact, CondensedSolution};
use crate::equilibrium::certificate::law_residuals;
use crate::equilibrium::law::Linearization;
use crate::equilibrium::{
    Configuration, ContactForces, ContactProblem, ContactSolver, ContactState, ContactWarmStart, Diagnosis, Kink,
    Residuals, Sensitivities, SolvedBody, SolverState, Stage, ValueError, Work, modes,
};
use crate::error::ContactError;
use crate::scene::BodyScene;
use std::sync::atomic::AtomicUsize;
use std::sync::{Arc, OnceLock};
use std::time::Instant;

/// The direct solver of one problem.
#[derive(Debug)]
pub struct DirectSolver {
    pub(super) problem: Arc<ContactProblem>,
    lower: CondensationPattern,
    upper: Option<CondensationPattern>,
    fixed: OnceLock<Arc<CondensedBody>>,
    /// Held contact dofs, per body.
    pub(super) held: Vec<Vec<bool>>,
}

/// The condensed bodies of one shape.
#[derive(Debug)]
pub(super) struct CondensedSystem {
    pub(super) block: Block,
    pub(super) lower: CondensedBody,
    pub(super) upper: Option<Arc<CondensedBody>>,
    grounded: Vec<Vec<f64>>,
    gaps: Vec<f64>,
    stiffness: f64,
    load: f64,
}

/// A solved shape with all that its coderivative needs.
#[derive(Debug)]
pub struct DirectState {
    pub(super) system: CondensedSystem,
    pub(super) solution: CondensedSolution,
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

    /// Condenses all bodies of a shape; also the number of factorisations done.
    fn condense(&self, configuration: &mut Configuration) -> Result<(CondensedSystem, usize), ContactError> {
        Stage::Factorization.enter();
        let rigid = &configuration.rigid;
        let grounded = configuration.grounded.iter().map(|motion| contact_motion(rigid, motion)).collect();
        let lower = self.lower.condense(&configuration.blocks[0], &self.problem.scene.lower)?;
        let (upper, factorizations) = self.upper_body(&configuration.blocks)?;
        let stiffness = contact_stiffness(&lower, upper.as_deref());
        let load = configuration.load(stiffness);
        let gaps = std::mem::take(&mut configuration.gaps);
        let block = configuration.blocks.swap_remove(0);
        Ok((CondensedSystem { block, lower, upper, grounded, gaps, stiffness, load }, 1 + factorizations))
    }

    /// The upper body, which keeps its shape: it is factored at the first call and shared afterwards. Also the number of
    /// factorisations done.
    fn upper_body(&self, blocks: &[Block]) -> Result<(Option<Arc<CondensedBody>>, usize), ContactError> {
        let (Some(pattern), Some(scene)) = (&self.upper, &self.problem.scene.upper) else { return Ok((None, 0)) };
        if let Some(body) = self.fixed.get() {
            return Ok((Some(Arc::clone(body)), 0));
        }
        let body = Arc::new(pattern.condense(&blocks[1], &scene.body)?);
        // Another thread may have been first; its factor is the same.
        Ok((Some(Arc::clone(self.fixed.get_or_init(|| body))), 1))
    }

    fn contact<'a>(&'a self, state: &'a CondensedSystem) -> CondensedContact<'a> {
        CondensedContact {
            bodies: std::iter::once(&state.lower).chain(state.upper.as_deref()).collect(),
            boundary: &self.problem.boundary,
            held: &self.held,
            gaps: &state.gaps,
            stiffness: state.stiffness,
            load: state.load,
            grounded: &state.grounded,
        }
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
        let (system, factorizations) = self.condense(&mut Configuration::new(&self.problem, controls)?)?;
        Stage::Contact.enter();
        let contact = self.contact(&system);
        let solution = if system.load > 0.0 { contact.solve(start, tolerance)? } else { contact.at_rest() };
        let work = Work { newton_steps: solution.steps, factorizations, ..Work::default() };
        let state = DirectState { system, solution };
        Ok(ContactState {
            forces: state.forces(&self.problem),
            load: state.system.load,
            contraction: None,
            stages: None,
            work,
            adjoint_applications: AtomicUsize::new(0),
            solution: state,
        })
    }

    fn sensitivities(
        &self,
        state: &DirectState,
        direction: &[f64],
        _tolerance: f64,
    ) -> Result<Sensitivities, ContactError> {
        if state.system.load == 0.0 {
            return Ok(Sensitivities::at_rest(self.problem.grid.column_count()));
        }
        let clock = Instant::now();
        Stage::Adjoint.enter();
        let contact = self.contact(&state.system);
        let (p, eta) = contact.adjoint(&state.solution.linearizations, direction);
        let terms = contact.weighted_residuals(&state.solution, &p, &eta, direction);
        let value_error = ValueError::from_terms(&terms, direction, &state.solution.forces);
        let size = contact.size();
        let u = self.extend(state, 0, &state.solution.displacement[..size], &state.solution.forces, true);
        let p = self.extend(state, 0, &p[..size], &eta, false);
        let adjoint_seconds = clock.elapsed().as_secs_f64();
        Stage::ShapeDerivative.enter();
        let heights = self.height_sensitivities(state, &u, &p, &eta);
        if heights.iter().any(|height| !height.is_finite()) {
            return Err(ContactError::NotFinite { what: "adjoint of the condensed state" });
        }
        let shape_seconds = clock.elapsed().as_secs_f64() - adjoint_seconds;
        Ok(Sensitivities { heights, applications: 0, adjoint_seconds, shape_seconds, value_error })
    }

    fn diagnose(&self, state: &DirectState) -> Result<Diagnosis, ContactError> {
        if state.system.load == 0.0 {
            return Ok(Diagnosis { contraction: 0.0, condition: None });
        }
        self.contact(&state.system).diagnose(&state.solution.linearizations)
    }

    fn bodies(&self, state: &DirectState) -> Result<Vec<SolvedBody>, ContactError> {
        self.whole_bodies(state)
    }

    fn strain_energy(&self, _state: &DirectState) -> Option<f64> {
        None
    }
}

impl DirectSolver {
    /// Element sums over the lower body, per contact node: displacements u, their adjoint p, packed multipliers η.
    fn height_sensitivities(&self, state: &DirectState, u: &[f64], p: &[f64], eta: &[f64]) -> Vec<f64> {
        let (grid, lower) = (&self.problem.grid, &self.problem.scene.lower);
        let whole = Subdomain { first_cell: [0; 3], cells: grid.cells };
        let mut heights = vec![0.0; grid.column_count()];
        for (column, value) in column_sensitivities(&state.system.block, &whole, &lower.material, &lower.loads, u, p) {
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

impl DirectState {
    fn forces(&self, problem: &ContactProblem) -> ContactForces {
        let (solution, boundary, stiffness) = (&self.solution, &problem.boundary, self.system.stiffness);
        let status = boundary.points.iter().zip(&solution.linearizations);
        let status = status.map(|(point, linearization)| linearization.status(point)).collect();
        let arguments: Vec<f64> =
            solution.forces.iter().zip(&solution.jumps).map(|(force, jump)| force + stiffness * jump).collect();
        let law = law_residuals(boundary, &solution.forces, &solution.jumps, stiffness, self.system.load);
        // Equilibrium holds through the equations φ₁ + φ₂ = 0, whose residual is part of Newton's.
        let residuals = Residuals { equilibrium: solution.residual, newton: solution.residual, ..law };
        let mut forces = solution.forces.clone();
        for (point, linearization) in boundary.points.iter().zip(&solution.linearizations) {
            if *linearization == Linearization::Open {
                forces[point.start..point.start + point.row_count()].fill(0.0);
            }
        }
        ContactForces::unpack(boundary, &forces, &solution.jumps, status, residuals, Kink::of(boundary, &arguments))
    }
}

/// Mean normal stiffness of the contact nodes, bodies in series, N/mm.
fn contact_stiffness(lower: &CondensedBody, upper: Option<&CondensedBody>) -> f64 {
    let count = lower.schur.nrows() / 3;
    let diagonal = |body: &CondensedBody, node: usize| body.schur[(3 * node + 2, 3 * node + 2)];
    let sum: f64 = (0..count)
        .map(|node| match upper {
            Some(upper) => 1.0 / (1.0 / diagonal(lower, node) + 1.0 / diagonal(upper, node)),
            None => diagonal(lower, node),
        })
        .sum();
    sum / count as f64
}

/// A motion of the scene on the contact dofs of all bodies, normalised.
fn contact_motion(rigid: &modes::RigidScene, motion: &modes::Motion) -> Vec<f64> {
    let mut values = Vec::with_capacity(3 * rigid.bodies * rigid.contact.len());
    for (body, coefficients) in motion.chunks_exact(modes::MOTIONS).enumerate() {
        for points in &rigid.contact {
            let basis = modes::motions(points[body], rigid.centre, rigid.length);
            for component in 0..3 {
                values.push(basis.iter().zip(coefficients).map(|(b, c)| b[component] * c).sum());
            }
        }
    }
    let length = crate::linear::vector::norm(&values);
    if length > 0.0 {
        values.iter_mut().for_each(|value| *value /= length);
    }
    values
}
