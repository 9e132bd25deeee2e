//! Fields of a solved shape: displacements and stresses inside the bodies, pressures and tractions on the contact boundary.
//!
//! ```text
//! σ per brick at its centre (elasticity/stress.rs);   von Mises per node: Σ V_e σ_vM,e / Σ V_e over the adjoining bricks e
//! pressure λ_N/A,   traction λ_T/A,   A the tributary area of the projected grid
//! ```
//! Computed when asked for, from what the contact solver has: no solve of the contact problem is repeated. Units: N, mm, MPa.

mod bodies;
mod contact;
mod vtk;

pub use bodies::BodyFields;
pub use contact::ContactFields;
pub use vtk::{FieldState, FieldsError, vtk_files};

use crate::equilibrium::{ContactForces, ContactProblem, SolvedBody};

/// All fields of a solved shape.
#[derive(Debug, Clone, PartialEq)]
pub struct Fields {
    /// The bodies, lower first.
    pub bodies: Vec<BodyFields>,
    /// The contact boundary.
    pub contact: ContactFields,
}

impl Fields {
    /// From the bodies (lower first, as many as the scene has) and the contact forces of a solved shape.
    pub(crate) fn new(problem: &ContactProblem, bodies: Vec<SolvedBody>, forces: &ContactForces) -> Self {
        let contact = ContactFields::new(problem, &bodies[0], forces);
        let scenes = problem.bodies();
        Self {
            bodies: bodies
                .into_iter()
                .zip(scenes)
                .map(|(body, scene)| BodyFields::new(body, &scene.material))
                .collect(),
            contact,
        }
    }

    /// Largest gluing defect of the bodies, mm; see [`SolvedBody::gluing_defect`].
    pub fn gluing_defect(&self) -> f64 {
        self.bodies.iter().map(|body| body.gluing_defect).fold(0.0, f64::max)
    }
}
