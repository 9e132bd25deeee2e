//! What the factors of a condensed body depend on beside the positions of its nodes.

use crate::body::Body;
use crate::direct::compliant_body::CompliantBody;
use crate::direct::condensation::CondensationPattern;
use crate::shelf::Shelf;
use std::sync::Arc;

/// Condensed bodies that solvers share.
pub type CondensedShelf = Shelf<CondensationKey, CompliantBody>;

/// Mesh, materials, trace, contact nodes and held directions of a body: its stiffness, condensed. Neither loads nor
/// prescribed displacements are part of it.
#[derive(Debug)]
pub struct CondensationKey {
    bodies: Arc<[Body]>,
    number: usize,
    pattern: Arc<CondensationPattern>,
}

impl CondensationKey {
    /// The key of a body of a problem.
    pub(super) fn new(bodies: Arc<[Body]>, number: usize, pattern: Arc<CondensationPattern>) -> Self {
        Self { bodies, number, pattern }
    }
}

impl PartialEq for CondensationKey {
    fn eq(&self, other: &Self) -> bool {
        let (own, others) = (&self.pattern, &other.pattern);
        let bodies = [&self.bodies[self.number], &other.bodies[other.number]];
        let is_equal = own.contact == others.contact && own.coordinates.axes == others.coordinates.axes;
        is_equal && bodies[0].trace == bodies[1].trace && bodies[0].solid == bodies[1].solid
    }
}
