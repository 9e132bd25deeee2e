//! What the factors of a condensed body depend on beside the positions of its nodes.

use crate::body::{Body, NodalAxes};
use crate::direct::compliant_body::CompliantBody;
use crate::direct::condensation::CondensationPattern;
use crate::error::ContactError;
use crate::shelf::Shelf;
use std::sync::Arc;

/// Mesh, materials, trace, contact nodes and held directions of a body: its stiffness, condensed. Neither loads nor
/// prescribed displacements are part of it.
#[derive(Debug)]
pub struct CondensationKey {
    bodies: Arc<[Body]>,
    number: usize,
    pattern: Arc<CondensationPattern>,
}

impl CondensationKey {
    /// The key of a body of a problem, with given nodes in contact rows, ascending; that of another solver where it is
    /// the same.
    ///
    /// # Errors
    /// As [`CondensationPattern::new`].
    pub(super) fn of(
        (bodies, number): (&Arc<[Body]>, usize),
        contact: &[u32],
        shelf: &Shelf<Self, CompliantBody>,
    ) -> Result<Arc<Self>, ContactError> {
        let body = &bodies[number];
        let is_same = |key: &Self| {
            let (own, pattern) = (&key.bodies[key.number], &key.pattern);
            let is_same = own.solid == body.solid && own.trace == body.trace && pattern.contact_nodes() == contact;
            is_same && pattern.axes == NodalAxes::new(body, &pattern.piece)
        };
        if let Some(known) = shelf.key(is_same) {
            return Ok(known);
        }
        let pattern = Arc::new(CondensationPattern::new(body, contact)?);
        let key = Arc::new(Self { bodies: Arc::clone(bodies), number, pattern });
        shelf.put_key(&key);
        Ok(key)
    }

    /// The pattern of the body.
    pub(super) fn pattern(&self) -> &Arc<CondensationPattern> {
        &self.pattern
    }
}

impl PartialEq for CondensationKey {
    fn eq(&self, other: &Self) -> bool {
        let (own, others) = (&self.pattern, &other.pattern);
        let bodies = [&self.bodies[self.number], &other.bodies[other.number]];
        let is_equal = own.contact == others.contact && own.axes == others.axes;
        is_equal && bodies[0].trace == bodies[1].trace && bodies[0].solid == bodies[1].solid
    }
}
