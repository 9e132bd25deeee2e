//! What lies opposite to the slave face of a contact: an obstacle, or the face of another body.
//!
//! ```text
//! Opposite (of a scene) ─ positions ─▶ Placed numbers of every contact node,  Facing (at a shape) ─ changes of numbers, and the transpose
//! ```
//! Supports, interference and directions of rows are the matter of [`NodeRows`], whatever lies opposite.

use crate::equilibrium::contact_point::ContactPoint;
use crate::equilibrium::node_rows::NodeRows;
use crate::equilibrium::numbers::{Numbers, Placed};
use crate::error::ContactError;
use crate::shape::{Positions, Velocities};
use std::fmt::Debug;
use std::sync::Arc;

/// Contact nodes of one contact with their rows at a shape.
pub(crate) type Nodes<'a> = (&'a [ContactPoint], &'a [NodeRows]);

/// Whether a node of a body moves with the shape.
pub(crate) type Moves<'a> = &'a (dyn Fn(usize, u32) -> bool + Sync);

/// What lies opposite to the slave face of a contact.
pub(crate) trait Opposite: Debug + Send + Sync {
    /// The numbers of the contact nodes at a shape, and what they change with.
    ///
    /// # Errors
    /// [`ContactError`] for a node whose place has no numbers.
    fn at(
        &self,
        points: &[ContactPoint],
        positions: &Positions,
    ) -> Result<(Vec<Placed>, Arc<dyn Facing>), ContactError>;

    /// Whether normals and weights are the same for all shapes.
    fn is_fixed(&self) -> bool;

    /// Whether areas of contact nodes change with the shape.
    fn areas_change(&self) -> bool;

    /// The body opposite; none where it is an obstacle.
    fn master(&self) -> Option<usize> {
        None
    }

    /// Whether a master node has a weight in the rows of a slave node at the start.
    fn has_weight(&self, _node: u32, _master: u32) -> bool {
        false
    }

    /// Unit normal of an obstacle at the point nearest to a place, or straight above it; none where there is none.
    fn normal_at(&self, _x: [f64; 3]) -> Option<[f64; 3]> {
        None
    }
}

/// What the numbers of the contact nodes of a contact change with at one shape.
pub(crate) trait Facing: Debug + Send + Sync {
    /// The changes of the numbers of all nodes along one field of velocities.
    fn changes(&self, nodes: Nodes<'_>, velocities: &Velocities<'_>, column: usize) -> Vec<Numbers>;

    /// Adds sensitivities by the numbers of all nodes to those of the positions of nodes that move:
    /// `add(body, node, sensitivity)`.
    fn pull_back(
        &self,
        nodes: Nodes<'_>,
        sensitivities: &[Numbers],
        moves: Moves<'_>,
        add: &mut dyn FnMut(usize, u32, [f64; 3]),
    );
}
