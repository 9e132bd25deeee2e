//! Displacements inside the condensed bodies.

use crate::body::mesh::Block;
use crate::direct::solver::{DirectSolver, DirectState};
use crate::equilibrium::SolvedBody;
use crate::error::ContactError;

impl DirectSolver {
    /// All bodies of a solved shape, lower first. Nothing is torn: each body is one subdomain.
    ///
    /// # Errors
    /// [`ContactError::ForeignState`] for a state of another mesh, [`ContactError::InvertedElement`] never for a solved one.
    pub(super) fn whole_bodies(&self, state: &DirectState) -> Result<Vec<SolvedBody>, ContactError> {
        let (problem, solution) = (&self.problem, &state.solution.displacement);
        let size = 3 * problem.boundary.points.len();
        let expected = size * self.held.len();
        if expected != solution.len() || state.block.grid != problem.grid {
            return Err(ContactError::ForeignState { what: "contact dofs", expected, found: solution.len() });
        }
        let blocks: Vec<Block> = std::iter::once(state.block.clone()).chain(problem.upper_block()?).collect();
        let parts = blocks.into_iter().zip(solution.chunks_exact(size)).enumerate();
        Ok(parts
            .map(|(body, (block, contact))| {
                let u = state.extend(body, contact, &state.solution.forces);
                SolvedBody {
                    displacement: u.chunks_exact(3).map(|u| [u[0], u[1], u[2]]).collect(),
                    gluing_defect: 0.0,
                    subdomains: vec![body; block.grid.brick_count()],
                    block,
                }
            })
            .collect())
    }
}

impl DirectState {
    /// Displacements of a whole body under its loads, from those of its contact nodes and packed multipliers, which push the lower
    /// body (0) down and the upper one (1) up.
    pub(super) fn extend(&self, body: usize, contact: &[f64], multipliers: &[f64]) -> Vec<f64> {
        self.extend_under(body, contact, multipliers, self.contact.bodies[body].condensed.full_load())
    }

    /// The same under another load over the body.
    pub(super) fn extend_under(&self, body: usize, contact: &[f64], multipliers: &[f64], load: &[f64]) -> Vec<f64> {
        let body = &self.contact.bodies[body];
        body.condensed.extend(contact, &body.contact_forces(multipliers), load)
    }
}
