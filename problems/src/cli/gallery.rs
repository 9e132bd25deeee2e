//! The pictures of solved shapes and of a run.

use crate::cli::solved::Solved;
use crate::cli::{ContactObjective, Failure};
use crate::cost::PressureMeasure;
use crate::fields::Fields;
use crate::figure::{Convergence, Figure, FigureError, Map, MapPanel, Step};
use crate::scene_file::OutputSection;
use nonsmooth::{Cost, Report};

/// A solved shape with all that is seen of it.
pub struct Seen<'a> {
    /// What distinguishes it, for captions.
    pub caption: String,
    /// Beginning of the names of its files.
    pub name: &'static str,
    /// The shape.
    pub solved: &'a Solved,
    /// Its fields, if a picture or a file shows them.
    pub fields: Option<Fields>,
}

impl<'a> Seen<'a> {
    /// A solved shape with as many fields as the outputs show: files for ParaView hold the sensitivity of the objective to the
    /// height of every contact node as well, which takes an adjoint.
    ///
    /// # Errors
    /// [`Failure`] of the adjoint.
    pub fn new(
        objective: &ContactObjective,
        name: &'static str,
        caption: impl Into<String>,
        solved: &'a Solved,
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
        Ok(Self { caption: caption.into(), name, solved, fields })
    }
}

/// Contact pressures side by side on one scale.
pub fn pressure(objective: &ContactObjective, shapes: &[Seen<'_>]) -> Result<Figure, FigureError> {
    let problem = objective.solver().problem();
    let [n1, n2, _] = problem.grid.nodes();
    let panel = |shape: &Seen<'_>| MapPanel {
        caption: shape.caption.clone(),
        counts: [n1, n2],
        origin: [0.0; 2],
        size: problem.grid.size,
        values: objective.cost().pressures(&shape.solved.state),
    };
    Map {
        name: "pressure".into(),
        title: format!("{}: contact pressure", problem.scene.name),
        quantity: "pressure".into(),
        unit: "MPa".into(),
        axes: ["x₁ (mm)".into(), "x₂ (mm)".into()],
        panels: shapes.iter().map(panel).collect(),
    }
    .figure()
}

/// The course of an optimization, with the least value that the total force of a shape allows.
pub fn convergence(
    objective: &ContactObjective,
    measure: PressureMeasure,
    report: &Report,
    optimum: &Solved,
) -> Result<Figure, FigureError> {
    let steps = report.history.iter().map(|record| Step {
        kind: record.kind.to_string(),
        value: record.value,
        best: record.center_value,
    });
    let unit = match measure {
        PressureMeasure::Norm { exponent } => format!("MPa^{{{exponent}}}"),
        PressureMeasure::Peak => "MPa".into(),
    };
    let bound = objective.cost().lower_bound(optimum.state.forces.total_normal_force());
    Convergence {
        name: "convergence".into(),
        title: format!("{}: course of the optimization", objective.solver().problem().scene.name),
        quantity: "Θ".into(),
        unit,
        steps: steps.collect(),
        reference: (bound > 0.0).then(|| ("least for this force".into(), bound)),
    }
    .figure()
}
