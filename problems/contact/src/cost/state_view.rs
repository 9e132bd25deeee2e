//! What functions of a contact state are computed from.

use crate::equilibrium::{ContactForces, ContactRows, ContactState, Positions, SolvedBody};
use std::sync::Arc;

/// A contact state without what its solver keeps.
#[derive(Debug, Clone, Copy)]
pub struct StateView<'a> {
    /// The contact rows of the shape.
    pub rows: &'a ContactRows,
    /// The contact forces.
    pub forces: &'a ContactForces,
    /// All bodies with their displacements; empty where they are not known.
    pub bodies: &'a [SolvedBody],
}

impl<'a> StateView<'a> {
    /// The view of a state.
    pub fn of<S>(state: &'a ContactState<S>) -> Self {
        Self { rows: &state.rows, forces: &state.forces, bodies: state.bodies.as_deref().unwrap_or_default() }
    }

    /// Positions of the nodes of all bodies.
    pub(super) fn positions(&self) -> Positions {
        self.bodies.iter().map(|body| Arc::clone(&body.positions)).collect()
    }

    /// The displacement of a node of a body, mm.
    pub(super) fn displacement(&self, body: usize, node: u32) -> [f64; 3] {
        self.bodies[body].displacement[node as usize]
    }
}
