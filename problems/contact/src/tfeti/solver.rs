//! From a shape to its contact state and coderivative by TFETI: what the framework's traits need.

use crate::body::mesh::Block;
use crate::body::shape_sensitivity::column_sensitivities;
use crate::equilibrium::certificate::law_residuals;
use crate::equilibrium::law::{self, Linearization};
use crate::equilibrium::{
    ContactForces, ContactProblem, Diagnosis, Kink, Residuals, Sensitivities, Stage, StageSeconds, ValueError, Work,
};
use crate::error::ContactError;
use crate::linear::vector::{dot, norm};
use crate::tfeti::{
    CoarseSpace, Communication, DualOperator, InProcess, NewtonSettings, Precision, Preconditioner, PreconditionerKind,
    TornContact, TornModel, TornSolution, TornSystem,
};
use rayon::prelude::*;
use std::sync::Arc;
use std::time::Instant;

/// The TFETI solver of one scene.
#[derive(Debug)]
pub struct TornSolver {
    model: TornModel,
    preconditioner: PreconditionerKind,
    precision: Precision,
}

/// A solved shape with all that its coderivative needs.
#[derive(Debug)]
pub struct TornState {
    blocks: Vec<Block>,
    system: TornSystem,
    space: CoarseSpace,
    solution: TornSolution,
    displacement: Vec<f64>,
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

impl TornSolver {
    /// Tears the scene.
    ///
    /// # Errors
    /// [`ContactError::Factorization`] when a symbolic analysis fails.
    pub fn new(problem: &ContactProblem, preconditioner: PreconditionerKind) -> Result<Self, ContactError> {
        Self::with_communication(problem, preconditioner, Arc::new(InProcess))
    }

    /// As [`TornSolver::new`], for one process of several: each solves the same problem and works on its own subdomains.
    ///
    /// # Errors
    /// As [`TornSolver::new`].
    pub fn with_communication(
        problem: &ContactProblem,
        preconditioner: PreconditionerKind,
        communication: Arc<dyn Communication>,
    ) -> Result<Self, ContactError> {
        let model = TornModel::new(&problem.scene, &problem.boundary, preconditioner, communication)?;
        Ok(Self { model, preconditioner, precision: Precision::default() })
    }

    /// The same solver with another precision of search directions.
    #[must_use]
    pub fn with_precision(mut self, precision: Precision) -> Self {
        self.precision = precision;
        self
    }

    /// The torn model.
    pub fn model(&self) -> &TornModel {
        &self.model
    }

    /// Solves one shape to a relative residual.
    ///
    /// # Errors
    /// [`ContactError`]: inverted elements, no equilibrium, no convergence.
    pub fn solve(
        &self,
        problem: &ContactProblem,
        controls: &[f64],
        start: Option<&[f64]>,
        tolerance: f64,
    ) -> Result<(TornState, ContactForces, Work), ContactError> {
        self.solve_by(problem, controls, |contact| contact.solve(start, &NewtonSettings::to(tolerance)))
    }

    /// Solves one shape by any method on the torn contact problem.
    ///
    /// # Errors
    /// [`ContactError`]: inverted elements, no equilibrium, and what the method returns.
    pub fn solve_by(
        &self,
        problem: &ContactProblem,
        controls: &[f64],
        method: impl FnOnce(&TornContact<'_>) -> Result<TornSolution, ContactError>,
    ) -> Result<(TornState, ContactForces, Work), ContactError> {
        let mut clock = Clock::start();
        let mut seconds = StageSeconds::default();
        Stage::Equilibrium.enter();
        let blocks = problem.blocks(controls)?;
        let rigid = problem.rigid_scene(&blocks);
        let grounded = rigid.analyse(&problem.boundary)?;
        seconds.equilibrium = clock.lap();
        Stage::Factorization.enter();
        let system = self.model.factorize(&blocks)?;
        seconds.factorization = clock.lap();
        Stage::CoarseSpace.enter();
        let amplitudes: Vec<Vec<f64>> = grounded
            .iter()
            .map(|motion| self.model.amplitudes(&system, &blocks, motion, rigid.centre, rigid.length))
            .collect();
        let gaps = problem.gaps(&blocks[0]);
        let stiffness = STIFFNESS_SHARE * self.contact_stiffness(problem, &system);
        let penetration: f64 = gaps.iter().map(|gap| (-gap).max(0.0)).sum();
        let load = rigid.total_load() + stiffness * penetration;
        let operator = DualOperator::new(&self.model, &system);
        let space = CoarseSpace::new(&operator, &amplitudes);
        seconds.coarse_space = clock.lap();
        Stage::Contact.enter();
        let (solution, displacement, residuals) = {
            let preconditioner = Preconditioner::new(&operator, self.preconditioner, stiffness);
            let contact = TornContact {
                constant: self.constant(&operator, problem, &gaps),
                gaps: &gaps,
                operator: &operator,
                space: &space,
                preconditioner: &preconditioner,
                boundary: &problem.boundary,
                stiffness,
                load: if load > 0.0 { load } else { 1.0 },
                precision: self.precision,
            };
            let solution = if load > 0.0 { method(&contact)? } else { contact.at_rest() };
            seconds.newton = clock.lap();
            Stage::Recovery.enter();
            let iterate = &solution.iterate;
            let displacement = operator.displacement(&iterate.multipliers, &iterate.amplitudes, true);
            let residuals = self.certify(problem, &contact, &solution);
            (solution, displacement, residuals)
        };
        let work = Work {
            newton_steps: solution.steps,
            dual_operator_applications: operator.applications(),
            factorizations: system.factorizations,
            ..Work::default()
        };
        seconds.recovery = clock.lap();
        let state = TornState { blocks, space, solution, displacement, stiffness, load, system, seconds };
        let forces = self.forces(problem, &state, residuals);
        Ok((state, forces, work))
    }

    /// d = B K⁺ f − g.
    fn constant(&self, operator: &DualOperator<'_>, problem: &ContactProblem, gaps: &[f64]) -> Vec<f64> {
        let mut constant = operator.gather(&operator.loaded_displacement());
        let constraints = &self.model.constraints;
        let points = problem.boundary.points.iter().zip(&constraints.normalisation);
        for ((point, nu), gap) in points.zip(gaps) {
            constant[constraints.equality_count + point.start] -= gap / nu;
        }
        constant
    }

    /// Mean over the contact nodes of the stiffness diagonals of the bodies in series, N/mm.
    fn contact_stiffness(&self, problem: &ContactProblem, system: &TornSystem) -> f64 {
        let size = self.model.pattern.pattern.dimension();
        let starts = self.model.pattern.pattern.starts();
        let constraints = &self.model.constraints;
        let mut diagonals = vec![0.0; 2 * problem.boundary.points.len()];
        for (point, diagonal) in problem.boundary.points.iter().zip(diagonals.chunks_exact_mut(2)) {
            for (dof, _) in constraints.rows.row(constraints.equality_count + point.start) {
                let subdomain = dof / size;
                if let Some(factors) = &system.parts[subdomain].factors {
                    diagonal[self.model.subdomains[subdomain].body] += factors.stiffness[starts[dof % size]];
                }
            }
        }
        self.model.communication.sum(&mut diagonals);
        let series = |diagonal: &[f64]| match problem.scene.upper {
            Some(_) => 1.0 / (1.0 / diagonal[0] + 1.0 / diagonal[1]),
            None => diagonal[0],
        };
        diagonals.chunks_exact(2).map(series).sum::<f64>() / problem.boundary.points.len() as f64
    }

    /// Residuals of the final iterate, whose image is a fresh product F λ.
    fn certify(&self, problem: &ContactProblem, contact: &TornContact<'_>, solution: &TornSolution) -> Residuals {
        let equality = self.model.constraints.equality_count;
        let iterate = &solution.iterate;
        let (forces, jumps) = self.physical(problem, &iterate.multipliers[equality..], &iterate.jumps[equality..]);
        let resultant = contact.space.resultant(&iterate.multipliers);
        let defect: Vec<f64> = resultant.iter().zip(&contact.space.resultants).map(|(g, e)| g - e).collect();
        Residuals {
            equilibrium: norm(&defect) / contact.load,
            newton: solution.residual,
            ..law_residuals(&problem.boundary, &forces, &jumps, contact.stiffness, contact.load)
        }
    }

    /// Physical forces and jumps from scaled rows.
    fn physical(&self, problem: &ContactProblem, multipliers: &[f64], jumps: &[f64]) -> (Vec<f64>, Vec<f64>) {
        let (mut forces, mut gaps) = (multipliers.to_vec(), jumps.to_vec());
        for (point, nu) in problem.boundary.points.iter().zip(&self.model.constraints.normalisation) {
            for row in point.start..point.start + point.row_count() {
                forces[row] /= nu;
                gaps[row] *= nu;
            }
        }
        (forces, gaps)
    }

    fn forces(&self, problem: &ContactProblem, state: &TornState, residuals: Residuals) -> ContactForces {
        let equality = self.model.constraints.equality_count;
        let iterate = &state.solution.iterate;
        let (forces, jumps) = self.physical(problem, &iterate.multipliers[equality..], &iterate.jumps[equality..]);
        let status = problem.boundary.points.iter().zip(&state.solution.linearizations);
        let status = status.map(|(point, linearization)| linearization.status(point)).collect();
        let arguments: Vec<f64> = iterate.multipliers[equality..]
            .iter()
            .zip(&iterate.jumps[equality..])
            .map(|(force, jump)| force + state.stiffness * jump)
            .collect();
        let kink = Kink::of(&problem.boundary, &arguments);
        let forces = admissible_forces(problem, &forces, &state.solution.linearizations);
        ContactForces::unpack(&problem.boundary, &forces, &jumps, status, residuals, kink)
    }

    /// Contraction factor at a solved shape.
    ///
    /// # Errors
    /// [`ContactError::NotConverged`], [`ContactError::Unheld`].
    pub fn diagnose(&self, problem: &ContactProblem, state: &TornState) -> Result<Diagnosis, ContactError> {
        if state.load == 0.0 {
            return Ok(Diagnosis { contraction: 0.0, condition: None });
        }
        let operator = DualOperator::new(&self.model, &state.system);
        let preconditioner = Preconditioner::new(&operator, self.preconditioner, state.stiffness);
        self.linearised(problem, state, &operator, &preconditioner).diagnose(&state.solution.linearizations)
    }

    /// The contact problem of a solved shape for linear systems at its derivatives (its constant is not needed).
    fn linearised<'a>(
        &self,
        problem: &'a ContactProblem,
        state: &'a TornState,
        operator: &'a DualOperator<'a>,
        preconditioner: &'a Preconditioner<'a>,
    ) -> TornContact<'a> {
        TornContact {
            constant: Vec::new(),
            gaps: &[],
            operator,
            space: &state.space,
            preconditioner,
            boundary: &problem.boundary,
            stiffness: state.stiffness,
            load: state.load,
            precision: self.precision,
        }
    }

    /// Sensitivities of the column heights for a dual j = ∂J/∂λ in packed physical rows.
    ///
    /// # Errors
    /// [`ContactError::NotConverged`] from the adjoint.
    pub fn sensitivities(
        &self,
        problem: &ContactProblem,
        state: &TornState,
        direction: &[f64],
        tolerance: f64,
    ) -> Result<Sensitivities, ContactError> {
        let mut clock = Clock::start();
        if state.load == 0.0 {
            return Ok(Sensitivities::at_rest(problem.grid.column_count()));
        }
        Stage::Adjoint.enter();
        let operator = DualOperator::new(&self.model, &state.system);
        let preconditioner = Preconditioner::new(&operator, self.preconditioner, state.stiffness);
        let contact = self.linearised(problem, state, &operator, &preconditioner);
        let constraints = &self.model.constraints;
        let equality = constraints.equality_count;
        let mut scaled = vec![0.0; constraints.row_count()];
        for (point, nu) in problem.boundary.points.iter().zip(&constraints.normalisation) {
            for row in point.start..point.start + point.row_count() {
                scaled[equality + row] = direction[row] / nu;
            }
        }
        let adjoint = contact.adjoint(&state.solution.linearizations, &scaled, tolerance)?;
        let iterate = &state.solution.iterate;
        let terms = contact.weighted_residuals(iterate, &adjoint, &scaled);
        let value_error = ValueError::from_terms(&terms, &scaled[equality..], &iterate.multipliers[equality..]);
        let adjoint_seconds = clock.lap();
        Stage::ShapeDerivative.enter();
        let mut heights = vec![0.0; problem.grid.column_count()];
        for part in self.element_sensitivities(problem, state, &adjoint.displacement) {
            for (column, value) in part {
                heights[column] += value;
            }
        }
        self.model.communication.sum(&mut heights);
        // The gap F² − F_α falls as the surface rises.
        for ((height, point), nu) in heights.iter_mut().zip(&problem.boundary.points).zip(&constraints.normalisation) {
            *height -= adjoint.multipliers[equality + point.start] / nu;
        }
        let shape_seconds = clock.lap();
        Ok(Sensitivities {
            heights,
            applications: operator.applications(),
            adjoint_seconds,
            shape_seconds,
            value_error,
        })
    }

    /// Strain energy ½ uᵀK u of the bodies of this process, N·mm.
    pub fn strain_energy(&self, state: &TornState) -> f64 {
        let pattern = &self.model.pattern.pattern;
        let mut image = vec![0.0; pattern.dimension()];
        let mut energy = 0.0;
        for (subdomain, part) in self.model.subdomains.iter().zip(&state.system.parts) {
            let Some(factors) = &part.factors else { continue };
            let u = &state.displacement[subdomain.first_dof..subdomain.first_dof + subdomain.place.dof_count()];
            pattern.multiply(&factors.stiffness, u, &mut image);
            energy += 0.5 * dot(u, &image);
        }
        energy
    }

    /// Element sums per subdomain of the lower body, in order.
    fn element_sensitivities(
        &self,
        problem: &ContactProblem,
        state: &TornState,
        adjoint: &[f64],
    ) -> Vec<Vec<(usize, f64)>> {
        let lower = &problem.scene.lower;
        self.model
            .subdomains
            .par_iter()
            .zip(&state.system.parts)
            .filter(|(subdomain, part)| subdomain.body == 0 && part.factors.is_some())
            .map(|(subdomain, _)| {
                let dofs = subdomain.first_dof..subdomain.first_dof + subdomain.place.dof_count();
                column_sensitivities(
                    &state.blocks[0],
                    &subdomain.place,
                    &lower.material,
                    &lower.loads,
                    &state.displacement[dofs.clone()],
                    &adjoint[dofs],
                )
            })
            .collect()
    }
}

/// Forces brought into the friction cone, and to zero at open nodes: what the iteration leaves outside is of the size of its
/// residual.
fn admissible_forces(problem: &ContactProblem, forces: &[f64], linearizations: &[Linearization]) -> Vec<f64> {
    let mut admissible = vec![0.0; forces.len()];
    for (point, linearization) in problem.boundary.points.iter().zip(linearizations) {
        if *linearization != Linearization::Open {
            let rows = point.start..point.start + point.row_count();
            law::project(&forces[rows.clone()], problem.boundary.friction, &mut admissible[rows]);
        }
    }
    admissible
}

impl TornState {
    /// λ over all rows, to start a similar problem from.
    pub fn multipliers(&self) -> &[f64] {
        &self.solution.iterate.multipliers
    }

    /// The bodies' undeformed geometry, lower first.
    pub fn blocks(&self) -> &[Block] {
        &self.blocks
    }

    /// Displacements over the torn dofs of this process (zero elsewhere), mm.
    pub fn displacement(&self) -> &[f64] {
        &self.displacement
    }

    /// Derivatives selected at the contact nodes.
    pub fn linearizations(&self) -> &[Linearization] {
        &self.solution.linearizations
    }

    /// Force that residuals are relative to, N.
    pub fn load(&self) -> f64 {
        self.load
    }

    /// Seconds of the stages of the state.
    pub fn seconds(&self) -> StageSeconds {
        self.seconds
    }
}
