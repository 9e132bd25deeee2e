//! Θ = Σσ⁴ on a mesh by a contact solver.

use crate::scaling::{Case, SceneName, Variant};
use contact::contact_shape::ContactShape;
use contact::cost::{NodeWeight, PressureMeasure, Quantity};
use contact::equilibrium::ContactProblem;
use nonsmooth::Vector;
use nonsmooth::verify::seeded_direction;
use problems::commands::{ContactObjective, Failure};
use scene_file::default_subdomains;
use std::sync::Arc;

pub const EXPONENT: f64 = 4.0;

/// N bricks per edge in the subdomains that a scene file has by default.
pub fn case(mesh: usize) -> Case {
    Case { mesh, subdomains: default_subdomains(mesh) }
}

/// Σσ⁴ of a scene with N bricks per edge by a solver.
///
/// # Errors
/// [`Failure`] from the scene or the preparation of the solver.
pub fn objective(variant: Variant, scene: SceneName, mesh: usize) -> Result<ContactObjective, Failure> {
    let measure = PressureMeasure::Norm { exponent: EXPONENT, weight: NodeWeight::Nodes };
    let problem = Arc::new(ContactProblem::new(scene.scene(case(mesh))?)?);
    let solver = variant.solver(&problem, 1).map_err(Failure::computation)?;
    Ok(ContactObjective::new(ContactShape::by(solver), Quantity::Pressure(measure), &[])?)
}

/// Σσ⁴ by the default solver, descent on total FETI.
pub fn objective_of(scene: SceneName, mesh: usize) -> Result<ContactObjective, Failure> {
    objective(Variant::Dirichlet, scene, mesh)
}

/// Controls of the start, each lowered at random by 1 to 3 %, so that the shape has no symmetry.
pub fn perturbed(objective: &ContactObjective) -> Vector {
    let start = objective.solver().start();
    start.zip_map(&seeded_direction(start.len(), 5), |height, change| height * (0.98 + 0.01 * change))
}
