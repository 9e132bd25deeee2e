//! A solved shape as figures and files show it.

use crate::commands::contact_objective::ContactObjective;
use crate::commands::failure::Failure;
use crate::commands::solved_shape::SolvedShape;
use contact::fields::Fields;
use nonsmooth::Cost;
use scene_file::OutputSection;

/// A solved shape with its fields and its names.
pub struct ShownShape<'a> {
    /// The words below its picture.
    pub caption: String,
    /// The beginning of the names of its files.
    pub name: &'static str,
    /// The shape.
    pub solved: &'a SolvedShape,
    /// Its displacements and stresses, if a picture or a file shows them.
    pub fields: Option<Fields>,
}

impl<'a> ShownShape<'a> {
    /// A solved shape with a caption that begins with `words`, and with as many fields as the outputs show. Files for ParaView hold the sensitivity of the objective to the
    /// height of every contact node as well, which takes an adjoint.
    ///
    /// # Errors
    /// [`Failure`] of the adjoint.
    pub fn new(
        objective: &ContactObjective,
        name: &'static str,
        words: &str,
        solved: &'a SolvedShape,
        wanted: &OutputSection,
    ) -> Result<Self, Failure> {
        let shape = objective.solver();
        let mut fields = None;
        if wanted.pictures || wanted.vtk {
            fields = Some(shape.fields(&solved.state)?);
        }
        if let Some(fields) = fields.as_mut().filter(|_| wanted.vtk) {
            let gradient = objective.cost().gradient(&solved.controls, &solved.state);
            fields.contact.sensitivity = Some(shape.height_sensitivity(&solved.state, &gradient.state)?.0);
        }
        Ok(Self { caption: format!("{words}Θ = {:.4e}", solved.value), name, solved, fields })
    }
}
