//! All fields of a solved shape.

use crate::equilibrium::{ContactForces, ContactProblem, ContactRows, SolvedBody};
use crate::fields::{BodyFields, ContactFields};

/// All fields of a solved shape.
#[derive(Debug, Clone, PartialEq)]
pub struct Fields {
    /// The bodies, in the order of the scene.
    pub bodies: Vec<BodyFields>,
    /// Fields over the contact boundary.
    pub contact: ContactFields,
}

impl Fields {
    /// From the bodies (as many as the scene has), the contact rows and the contact forces of a solved shape.
    pub(crate) fn new(
        problem: &ContactProblem,
        bodies: Vec<SolvedBody>,
        contact: (&ContactRows, &ContactForces),
    ) -> Self {
        let contact = ContactFields::new(problem, &bodies, contact);
        let bodies = bodies.into_iter().zip(&*problem.bodies);
        Self { bodies: bodies.map(|(solved, body)| BodyFields::new(solved, body)).collect(), contact }
    }

    /// Largest gluing defect of the bodies, mm; see [`SolvedBody::gluing_defect`].
    pub fn gluing_defect(&self) -> f64 {
        self.bodies.iter().map(|body| body.gluing_defect).fold(0.0, f64::max)
    }
}
