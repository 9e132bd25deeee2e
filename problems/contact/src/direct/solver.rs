//! From a shape to its contact state and coderivative by direct condensation.

use crate::body::mesh::{Block, Subdomain};
use crate::body::shape_sensitivity::column_sensitivities;
use crate::direct::condensation::{CondensationPattern, CondensedBody};
use crate::direct::newton::{CondensedContact, CondensedSolution};
use crate::equilibrium::certificate::law_residuals;
use crate::equilibrium::law::Linearization;
use crate::equilibrium::{
    Configuration, ContactForces, ContactProblem, Diagnosis, Kink, Residuals, Stage, ValueError, Work, modes,
};
use crate::error::ContactError;
use crate::scene::BodyScene;
use std::sync::{Arc, OnceLock};

/// The direct solver of one scene.
#[derive(Debug)]
pub struct DirectSolver {
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
    /// Analyses the bodies of a scene.
    ///
    /// # Errors
    /// [`ContactError::Factorization`] when a symbolic analysis fails.
    pub fn new(problem: &ContactProblem) -> Result<Self, ContactError> {
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
        Ok(Self { lower, upper, fixed: OnceLock::new(), held })
    }

    /// Solves one shape to a relative residual; `start`: contact displacements of a similar shape.
    ///
    /// # Errors
    /// [`ContactError`]: inverted elements, no equilibrium, no convergence.
    pub fn solve(
        &self,
        problem: &ContactProblem,
        controls: &[f64],
        start: Option<&[f64]>,
        tolerance: f64,
    ) -> Result<(DirectState, ContactForces, Work), ContactError> {
        let configuration = Configuration::new(problem, controls)?;
        Stage::Factorization.enter();
        let lower = self.lower.condense(&configuration.blocks[0], &problem.scene.lower)?;
        let mut factorizations = 1;
        let upper = self.upper_body(problem, &configuration.blocks, &mut factorizations)?;
        let stiffness = contact_stiffness(&lower, upper.as_deref());
        let load = configuration.load(stiffness);
        let Configuration { mut blocks, rigid, grounded, gaps } = configuration;
        let grounded = grounded.iter().map(|motion| contact_motion(&rigid, motion)).collect();
        let system = CondensedSystem { block: blocks.swap_remove(0), lower, upper, grounded, gaps, stiffness, load };
        Stage::Contact.enter();
        let contact = self.contact(problem, &system);
        let solution = if load > 0.0 { contact.solve(start, tolerance)? } else { contact.at_rest() };
        let work = Work { newton_steps: solution.steps, factorizations, ..Work::default() };
        let state = DirectState { system, solution };
        let forces = unpack(problem, &state);
        Ok((state, forces, work))
    }

    fn upper_body(
        &self,
        problem: &ContactProblem,
        blocks: &[Block],
        factorizations: &mut usize,
    ) -> Result<Option<Arc<CondensedBody>>, ContactError> {
        let (Some(pattern), Some(scene)) = (&self.upper, &problem.scene.upper) else { return Ok(None) };
        if self.fixed.get().is_none() {
            let body = Arc::new(pattern.condense(&blocks[1], &scene.body)?);
            *factorizations += 1;
            // Another thread may have been first; its factor is the same.
            let _ = self.fixed.set(body);
        }
        Ok(self.fixed.get().cloned())
    }

    fn contact<'a>(&'a self, problem: &'a ContactProblem, state: &'a CondensedSystem) -> CondensedContact<'a> {
        CondensedContact {
            bodies: std::iter::once(&state.lower).chain(state.upper.as_deref()).collect(),
            boundary: &problem.boundary,
            lower_held: &self.held[0],
            gaps: state.gaps.clone(),
            stiffness: state.stiffness,
            load: state.load,
            grounded: state.grounded.clone(),
        }
    }

    /// Contraction factor and condition at a solved shape.
    ///
    /// # Errors
    /// [`ContactError::NotFinite`].
    pub fn diagnose(&self, problem: &ContactProblem, state: &DirectState) -> Result<Diagnosis, ContactError> {
        if state.system.load == 0.0 {
            return Ok(Diagnosis { contraction: 0.0, condition: None });
        }
        self.contact(problem, &state.system).diagnose(&state.solution.linearizations)
    }

    /// Sensitivities of the column heights for a dual j = ∂J/∂λ in packed rows, and what the state's residual does to J.
    ///
    /// # Errors
    /// [`ContactError::NotFinite`] when the adjoint matrix is singular.
    pub fn sensitivities(
        &self,
        problem: &ContactProblem,
        state: &DirectState,
        direction: &[f64],
    ) -> Result<(Vec<f64>, ValueError), ContactError> {
        if state.system.load == 0.0 {
            // Bodies at rest: no force depends on the shape (one-sidedly where a gap is closed).
            return Ok((vec![0.0; problem.grid.column_count()], ValueError::default()));
        }
        Stage::Adjoint.enter();
        let contact = self.contact(problem, &state.system);
        let (p, eta) = contact.adjoint(&state.solution.linearizations, direction);
        let terms = contact.weighted_residuals(&state.solution, &p, &eta, direction);
        let value_error = ValueError::from_terms(&terms, direction, &state.solution.forces);
        let size = contact.size();
        let u = self.extend(problem, state, 0, &state.solution.displacement[..size], &state.solution.forces, true);
        let p = self.extend(problem, state, 0, &p[..size], &eta, false);
        Stage::ShapeDerivative.enter();
        let whole = Subdomain { first_cell: [0; 3], cells: problem.grid.cells };
        let lower = &problem.scene.lower;
        let mut heights = vec![0.0; problem.grid.column_count()];
        for (column, value) in column_sensitivities(&state.system.block, &whole, &lower.material, &lower.loads, &u, &p)
        {
            heights[column] += value;
        }
        for (height, point) in heights.iter_mut().zip(&problem.boundary.points) {
            *height -= eta[point.start];
        }
        if heights.iter().any(|height| !height.is_finite()) {
            return Err(ContactError::NotFinite { what: "adjoint of the condensed state" });
        }
        Ok((heights, value_error))
    }
}

impl DirectState {
    /// Contact displacements of all bodies, to start a similar problem from.
    pub fn contact_displacement(&self) -> &[f64] {
        &self.solution.displacement
    }

    /// Force that residuals are relative to, N.
    pub fn load(&self) -> f64 {
        self.system.load
    }
}

fn unpack(problem: &ContactProblem, state: &DirectState) -> ContactForces {
    let (solution, boundary, stiffness) = (&state.solution, &problem.boundary, state.system.stiffness);
    let status = boundary.points.iter().zip(&solution.linearizations);
    let status = status.map(|(point, linearization)| linearization.status(point)).collect();
    let arguments: Vec<f64> =
        solution.forces.iter().zip(&solution.jumps).map(|(force, jump)| force + stiffness * jump).collect();
    let law = law_residuals(boundary, &solution.forces, &solution.jumps, stiffness, state.system.load);
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
