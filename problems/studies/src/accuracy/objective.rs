//! Θ on a mesh by a contact solver.

use crate::accuracy::extent::case;
use crate::scaling::{SceneName, Variant};
use contact::contact_shape::ContactShape;
use contact::cost::{Measure, NodeWeight, PressureMeasure};
use contact::equilibrium::ContactProblem;
use contact::scene::Scene;
use problems::commands::{ContactObjective, Failure};
use std::sync::Arc;

pub const EXPONENT: f64 = 4.0;

/// All contact solvers and preconditioners, with their names in tables and pictures.
pub const METHODS: [(&str, Variant); 6] = [
    ("descent, Dirichlet", Variant::Dirichlet),
    ("descent, lumped", Variant::Lumped),
    ("descent, none", Variant::None),
    ("Newton–GMRES", Variant::Gmres),
    ("augmented Lagrangian", Variant::AugmentedLagrangian),
    ("direct condensation", Variant::Direct),
];

/// Θ by the default solver, descent on total FETI, on N bricks per edge.
///
/// # Errors
/// [`Failure::Input`] from the scene.
pub fn objective_of(scene: SceneName, mesh: usize, measure: PressureMeasure) -> Result<ContactObjective, Failure> {
    objective_by(Variant::Dirichlet, scene.scene(case(mesh))?, measure)
}

/// Θ of any scene by any solver.
///
/// # Errors
/// [`Failure`] from the scene or the preparation of the solver.
pub fn objective_by(variant: Variant, scene: Scene, measure: PressureMeasure) -> Result<ContactObjective, Failure> {
    let solver = variant.solver(&Arc::new(ContactProblem::new(scene)?), 1).map_err(Failure::computation)?;
    Ok(ContactObjective::new(ContactShape::by(solver), Measure::Pressure(measure), &[])?)
}

/// The measure Σσ⁴.
pub fn norm() -> PressureMeasure {
    PressureMeasure::Norm { exponent: EXPONENT, weight: NodeWeight::Nodes }
}
