//! What is asked of a state of total FETI: derivatives, diagnosis, displacements.

use crate::body::mesh::smallest_extent;
use crate::equilibrium::{
    ContactProblem, ContactState, ContactWarmStart, Diagnosis, Sensitivities, SolvedBody, Stage, Tangents, TangentsOf,
};
use crate::error::ContactError;
use crate::linear::vector::dot;
use crate::tfeti::derivative::{self, DisplacementLoad, TangentRequest, shape_derivative};
use crate::tfeti::solver::{Clock, TotalFeti};
use crate::tfeti::state::TornState;
use crate::tfeti::torn::whole_bodies;
use crate::work_estimate::MAX_PRODUCTS;

impl TotalFeti {
    /// As [`Self::sensitivities`], with at most so many products with F.
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
            return Ok(Sensitivities::at_rest(self.problem()));
        };
        Stage::Adjoint.enter()?;
        let constraints = &self.model.constraints;
        let mut scaled = constraints.zeros();
        let scales = constraints.contact_scales(contact.boundary);
        for ((scaled, physical), nu) in scaled.contact_mut().iter_mut().zip(direction).zip(scales) {
            *scaled = physical / nu;
        }
        let iterate = &state.solution.iterate;
        // A sensitivity of J over the size of the body, or over its displacement where that is larger; below the
        // rounding of this scale, no residual means anything.
        let shaped = self.problem().map.shaped_bodies().map(|body| smallest_extent(&state.positions[body]));
        let size_of_body = shaped.fold(f64::INFINITY, f64::min);
        let load = loads.map(|loads| DisplacementLoad::new(&contact.operator, loads, &state.displacement));
        let [work, size] = load.as_ref().map_or([0.0; 2], |load| load.products);
        let natural = (dot(scaled.contact(), iterate.multipliers.contact()).abs() + work.abs())
            / (contact.stiffness * size_of_body + contact.load);
        let linearizations = &state.solution.linearizations;
        let adjoint =
            derivative::adjoint(&contact, linearizations, &scaled, load.as_ref(), tolerance, natural, max_products)?;
        let value_error = derivative::value_error(&contact, iterate, &adjoint, &scaled).with_displacements(size);
        let adjoint_seconds = clock.lap();
        Stage::ShapeDerivative.enter()?;
        let positions = shape_derivative(&self.model, state.shape(), &adjoint);
        let (applications, shape_seconds) = (contact.operator.applications(), clock.lap());
        Ok(Sensitivities { positions, applications, adjoint_seconds, shape_seconds, value_error })
    }
}

/// Where there are several processes, all of them make each call.
impl TotalFeti {
    /// The problem that is solved.
    pub fn problem(&self) -> &ContactProblem {
        &self.model.problem
    }

    /// Number of degrees of freedom of all subdomains, and number of multipliers.
    pub fn sizes(&self) -> [usize; 2] {
        let model = &self.model;
        [model.total_dofs(), model.constraints.total_equality_count + model.problem.boundary.row_count]
    }

    /// What this solver did not need for its scene, in words.
    pub fn left_out(&self) -> Option<&'static str> {
        (self.model.constraints.gluing_count == 0).then_some("gluing (one subdomain per body)")
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
    ) -> Result<ContactState<TornState>, ContactError> {
        self.attempt(controls, start, tolerance, None).map_err(|failed| *failed.error)
    }

    /// As [`Solver::sensitivities`](crate::solvers::Solver::sensitivities).
    ///
    /// # Errors
    /// [`ContactError`] of the adjoint.
    pub fn sensitivities(
        &self,
        state: &TornState,
        direction: &[f64],
        tolerance: f64,
    ) -> Result<Sensitivities, ContactError> {
        self.sensitivities_within(state, direction, tolerance, MAX_PRODUCTS)
    }

    /// As [`Solver::tangents`](crate::solvers::Solver::tangents).
    ///
    /// # Errors
    /// [`ContactError`] of the linearized problems.
    pub fn tangents(
        &self,
        state: &TornState,
        changes: &[Vec<f64>],
        of: TangentsOf,
        tolerance: f64,
    ) -> Result<Tangents, ContactError> {
        self.problem().check_changes(changes)?;
        let Some(contact) = self.contact_of(state)? else {
            return Ok(Tangents::at_rest(self.problem(), &state.rows, &self.problem().map.velocities(changes), of));
        };
        Stage::Adjoint.enter()?;
        let whole = (of == TangentsOf::Displacements).then_some(&state.positions);
        let request = TangentRequest { shape: state.shape(), whole, tolerance };
        derivative::tangents(&contact, request, &state.solution.linearizations, changes)
    }

    /// As [`Solver::diagnose`](crate::solvers::Solver::diagnose).
    ///
    /// # Errors
    /// [`ContactError`] from the linear systems.
    pub fn diagnose(&self, state: &TornState) -> Result<Diagnosis, ContactError> {
        match self.contact_of(state)? {
            Some(contact) => derivative::diagnose(&contact, &state.solution.linearizations),
            None => Ok(Diagnosis { contraction: 0.0, condition: None }),
        }
    }

    /// As [`Solver::estimate_contraction`](crate::solvers::Solver::estimate_contraction).
    ///
    /// # Errors
    /// [`ContactError`] from the linear system.
    pub fn estimate_contraction(&self, state: &TornState, max_products: usize) -> Result<f64, ContactError> {
        let Some(contact) = self.contact_of(state)? else { return Ok(0.0) };
        derivative::estimate_contraction(&contact, &state.solution, max_products)
    }

    /// All bodies of a solved shape, in the order of the scene. Torn copies of a node are averaged. Of several
    /// processes, the first one alone gets the bodies, the others none.
    ///
    /// # Errors
    /// [`ContactError::ForeignState`] for a state of another mesh.
    pub fn bodies(&self, state: &TornState) -> Result<Vec<SolvedBody>, ContactError> {
        self.check(state)?;
        Ok(whole_bodies(&self.model, &state.positions, &state.displacement))
    }
}
