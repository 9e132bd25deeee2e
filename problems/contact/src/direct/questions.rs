//! What is asked of a state by direct condensation: derivatives, diagnosis, rounding.

use crate::direct::adjoint::adjoint;
use crate::direct::diagnosis::{diagnose, estimate_contraction};
use crate::direct::displacement_load::CondensedLoad;
use crate::direct::displacement_tangents::displacement_tangents;
use crate::direct::force_rounding::change_of_forces;
use crate::direct::solver::{DirectSolver, DirectState};
use crate::direct::tangents::{CondensedTangents, tangents};
use crate::equilibrium::trace_work::TraceWork;
use crate::equilibrium::{Diagnosis, Sensitivities, SolvedBody, Stage, Tangents, TangentsOf, ValueError};
use crate::error::ContactError;
use crate::shape::first_of;
use std::sync::Arc;
use std::time::Instant;

impl DirectSolver {
    /// As [`Solver::sensitivities`](crate::solvers::Solver::sensitivities).
    ///
    /// # Errors
    /// [`ContactError`] of the adjoint.
    pub fn sensitivities(&self, state: &DirectState, direction: &[f64]) -> Result<Sensitivities, ContactError> {
        self.check(state)?;
        let (direction, displacements) = self.problem.parts_of(direction)?;
        if state.load == 0.0 {
            return Ok(Sensitivities::at_rest(&self.problem));
        }
        let clock = Instant::now();
        Stage::Adjoint.enter()?;
        let solution = &state.solution;
        let loads = displacements.map_or_else(Vec::new, |displacements| self.condensed_loads(state, displacements));
        let at = (solution.unknowns.as_slice(), solution.linearizations.as_slice());
        let adjoint = adjoint(&state.contact, at, state.active(), direction, &loads);
        let value_error = ValueError::from_terms(&adjoint.error_terms, direction, &solution.forces);
        let value_error = value_error.with_displacements(loads.iter().map(|load| load.size).sum());
        let mut loads: Vec<Vec<f64>> = loads.into_iter().map(|load| load.full).collect();
        let extended = |body: usize| {
            let none = || vec![0.0; state.displacement(body).len()];
            let load = loads.get_mut(body).map_or_else(none, std::mem::take);
            let on_contact = &adjoint.displacements[body];
            let p = state.contact.bodies[body].extend_under(on_contact, &adjoint.multipliers, &load);
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

    /// As [`Solver::tangents`](crate::solvers::Solver::tangents).
    ///
    /// # Errors
    /// [`ContactError`] of the linearized problems.
    pub fn tangents(
        &self,
        state: &DirectState,
        changes: &[Vec<f64>],
        of: TangentsOf,
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
        let mut found = tangents(&state.contact, (linearizations, state.active()), &loads);
        found.tangents.displacements = kept.map(|forces| displacement_tangents(&state.contact, forces, &loads, &found));
        let CondensedTangents { tangents, .. } = found;
        let displacements = tangents.displacements.iter().flatten();
        let entries = tangents.forces.iter().chain(&tangents.openings).chain(displacements).flatten();
        if entries.copied().any(|entry| !entry.is_finite()) {
            return Err(ContactError::NotFinite { what: "tangents of the condensed state" });
        }
        Ok(tangents)
    }

    /// As [`Solver::diagnose`](crate::solvers::Solver::diagnose).
    ///
    /// # Errors
    /// [`ContactError`] from the linear systems.
    pub fn diagnose(&self, state: &DirectState) -> Result<Diagnosis, ContactError> {
        self.check(state)?;
        if state.load == 0.0 {
            return Ok(Diagnosis { contraction: 0.0, condition: None });
        }
        diagnose(&state.contact, &state.solution.linearizations)
    }

    /// As [`Solver::estimate_contraction`](crate::solvers::Solver::estimate_contraction).
    ///
    /// # Errors
    /// [`ContactError`] from the linear system.
    pub fn estimate_contraction(&self, state: &DirectState) -> Result<f64, ContactError> {
        self.check(state)?;
        if state.load == 0.0 {
            return Ok(0.0);
        }
        Ok(estimate_contraction(&state.contact, &state.solution.unknowns, &state.solution.linearizations))
    }

    /// As [`Solver::force_rounding`](crate::solvers::Solver::force_rounding).
    ///
    /// # Errors
    /// [`ContactError::ForeignState`] for a state of another mesh.
    pub fn force_rounding(&self, state: &DirectState) -> Result<f64, ContactError> {
        self.check(state)?;
        if state.load == 0.0 {
            return Ok(0.0);
        }
        let (contact, solution) = (&state.contact, &state.solution);
        let parts = contact.bodies.iter().zip(self.problem.bodies.iter().zip(&state.positions));
        let delta = parts.map(|(own, (body, positions))| own.refinement(body, positions, &solution.forces));
        let at = (solution.linearizations.as_slice(), state.active());
        Ok(change_of_forces(contact, at, &delta.collect::<Vec<_>>()))
    }

    /// All bodies of a solved shape, in the order of the scene. Nothing is torn: each body is one subdomain.
    ///
    /// # Errors
    /// [`ContactError::ForeignState`] for a state of another mesh.
    pub fn bodies(&self, state: &DirectState) -> Result<Vec<SolvedBody>, ContactError> {
        self.check(state)?;
        let bodies = self.problem.bodies.iter().enumerate();
        let solved = bodies.map(|(number, body)| SolvedBody {
            mesh: Arc::clone(&body.mesh),
            positions: first_of(&state.positions[number], body.mesh.node_count()),
            displacement: state.displacement(number).as_chunks::<3>().0.to_vec(),
            gluing_defect: 0.0,
            subdomains: vec![number; body.mesh.cell_count()],
        });
        Ok(solved.collect())
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
            CondensedLoad::new(state.contact.bodies[number].stiff(), load, state.displacement(number))
        };
        (0..self.patterns.len()).map(load).collect()
    }
}
