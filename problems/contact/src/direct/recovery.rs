//! Displacements inside the condensed bodies.

use crate::body::mesh::Block;
use crate::direct::solver::{DirectSolver, DirectState};
use crate::equilibrium::SolvedBody;
use crate::error::ContactError;

impl DirectSolver {
    /// All bodies of a solved shape, lower first. Nothing is torn: each body is one subdomain.
    ///
    /// # Errors
    /// [`ContactError::ForeignState`] for a state of another mesh, [`ContactError::InvertedElement`] never for a solved
    /// one.
    pub(super) fn whole_bodies(&self, state: &DirectState) -> Result<Vec<SolvedBody>, ContactError> {
        self.check(state)?;
        let blocks: Vec<Block> = std::iter::once(state.block.clone()).chain(self.problem.upper_block()?).collect();
        Ok(blocks
            .into_iter()
            .enumerate()
            .map(|(body, block)| SolvedBody {
                displacement: state.displacement(body).chunks_exact(3).map(|u| [u[0], u[1], u[2]]).collect(),
                gluing_defect: 0.0,
                subdomains: vec![body; block.grid.brick_count()],
                block,
            })
            .collect())
    }
}

impl DirectState {
    /// Displacements of a whole body of the state. They are solved for when they are first asked for, and kept: fields,
    /// adjoint and tangents need the same ones.
    pub(super) fn displacement(&self, body: usize) -> &[f64] {
        self.displacements[body].get_or_init(|| {
            let size = 3 * self.contact.problem.boundary.points.len();
            let contact = &self.solution.displacement[size * body..size * (body + 1)];
            let load = &self.contact.bodies[body].condensed.full_load;
            self.extend_under(body, contact, &self.solution.forces, load)
        })
    }

    /// Displacements of a whole body under a load over it, from those of its contact nodes and packed multipliers,
    /// which push the lower body (0) down and the upper one (1) up.
    pub(super) fn extend_under(&self, body: usize, contact: &[f64], multipliers: &[f64], load: &[f64]) -> Vec<f64> {
        let body = &self.contact.bodies[body];
        body.condensed.extend(contact, &body.contact_forces(multipliers), load)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::equilibrium::{ContactProblem, ContactSolver};
    use crate::scene::hertz;
    use std::sync::Arc;

    /// A function of the displacements needs them for its value, its adjoint and the estimate of its error.
    #[test]
    fn a_state_solves_for_its_displacements_once() {
        let mut scene = hertz().expect("the example");
        (scene.mesh, scene.subdomains) = ([3; 3], [1; 3]);
        let controls = vec![scene.start_height; scene.control_points.iter().product()];
        let problem = Arc::new(ContactProblem::new(scene).expect("a scene"));
        let solver = DirectSolver::new(Arc::clone(&problem)).expect("a pattern");
        let state = solver.solve(&controls, None, 1e-10).expect("a state").solution;
        assert!(state.displacements.iter().all(|found| found.get().is_none()));
        let bodies = solver.bodies(&state).expect("bodies");
        let places: Vec<*const f64> = (0..2).map(|body| state.displacement(body).as_ptr()).collect();
        let mut dual = vec![0.0; problem.boundary.row_count];
        dual.extend(bodies.iter().flat_map(|body| body.displacement.as_flattened()));
        solver.sensitivities(&state, &dual, 1e-10).expect("an adjoint");
        assert_eq!((0..2).map(|body| state.displacement(body).as_ptr()).collect::<Vec<_>>(), places);
        assert_eq!(solver.bodies(&state).expect("bodies"), bodies);
    }
}
