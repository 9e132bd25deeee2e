//! The objective Θ of a contact problem.

use crate::commands::failure::Failure;
use contact::contact_shape::ContactShape;
use contact::cost::PressureCost;
use nonsmooth::ReducedObjective;
use scene_file::Case;

/// Θ of a scene: the pressure measure of the contact state that the control heights lead to.
pub type ContactObjective = ReducedObjective<ContactShape, PressureCost>;

/// Θ of a case.
///
/// # Errors
/// [`Failure::Input`] naming the field.
pub fn objective(case: &Case) -> Result<ContactObjective, Failure> {
    let shape = ContactShape::with_preconditioner(case.scene.clone(), case.solver, case.preconditioner)?;
    let cost = PressureCost::new(case.measure, &shape.problem().boundary)?;
    Ok(ReducedObjective::new(shape, cost))
}
