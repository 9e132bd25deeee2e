//! What the factors of a condensed body depend on beside the positions of its nodes.

use crate::body::Body;
use crate::direct::compliant_body::CompliantBody;
use crate::direct::condensation::CondensationPattern;
use crate::shelf::Shelf;
use std::sync::Arc;

/// Condensed bodies that solvers share.
pub type CondensedShelf = Shelf<CondensationKey, CompliantBody>;

/// Mesh, materials, tied and contact nodes and held directions of a body: its stiffness, condensed. Neither loads nor
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
        let solids = [&self.bodies[self.number].solid, &other.bodies[other.number].solid];
        own.contact == others.contact && own.axes == others.axes && solids[0] == solids[1]
    }
}
