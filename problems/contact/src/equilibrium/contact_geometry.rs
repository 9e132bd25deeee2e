//! From the positions of all nodes to the contact rows, contact by contact.

use crate::body::Body;
use crate::equilibrium::contact_part::ContactPart;
use crate::equilibrium::{ContactBoundary, ContactRows, NodeRows};
use crate::error::ContactError;
use crate::shape::Positions;

/// What the contact rows of a shape are computed from.
#[derive(Debug, Clone)]
pub struct ContactGeometry {
    /// The contacts, in the order of the scene.
    pub(crate) parts: Vec<ContactPart>,
    /// Whether the numbers in weighted displacements change with the shape.
    pub(crate) traces_change: bool,
}

impl ContactGeometry {
    /// Whether the rows have the same directions and weights for all shapes.
    pub fn is_fixed(&self) -> bool {
        !self.traces_change && self.parts.iter().all(|part| part.opposite.is_fixed())
    }

    /// Whether areas of contact nodes change with the shape.
    pub fn areas_change(&self) -> bool {
        self.parts.iter().any(|part| part.opposite.areas_change())
    }

    /// Unit normal of the counter surface of a contact at the point nearest to a place, or straight above it; none
    /// where there is none.
    pub(crate) fn counter_normal(&self, contact: usize, x: [f64; 3]) -> Option<[f64; 3]> {
        self.parts[contact].opposite.normal_at(x)
    }

    /// The rows at given positions of the nodes of all bodies.
    ///
    /// # Errors
    /// [`ContactError::NoFoot`] for a contact node without a unique nearest point on its obstacle,
    /// [`ContactError::LeftMaster`] for one that no longer lies opposite to its master.
    pub fn rows(
        &self,
        boundary: &ContactBoundary,
        bodies: &[Body],
        positions: &Positions,
    ) -> Result<ContactRows, ContactError> {
        let traces = bodies.iter().zip(positions).map(|(body, positions)| body.trace.weights(positions)).collect();
        let (mut nodes, mut facing) = (Vec::with_capacity(boundary.points.len()), Vec::new());
        for contact in boundary.contacts() {
            let part = &self.parts[contact];
            let points = &boundary.points[boundary.of_contact(contact)];
            let (placed, own) = part.opposite.at(points, positions)?;
            let rows = points.iter().zip(placed);
            nodes.extend(rows.map(|(point, placed)| NodeRows::new(point, placed, part.interference)));
            facing.push(own);
        }
        Ok(ContactRows { nodes, facing, traces, contact_count: boundary.contact_points().len() })
    }
}
