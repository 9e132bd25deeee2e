//! The figures of solved shapes and of a run; solved shapes as figures and files show them.

use crate::commands::contact_objective::{ContactObjective, SolvedShape};
use crate::commands::failure::Failure;
use contact::body::mesh::Block;
use contact::fields::{BodyFields, Fields};
use figures::{
    Convergence, Figure, FigureError, Map, MapPanel, SolidBlock, SolidPanel, Solids, Step, SurfacePanel, Surfaces,
    nice_below,
};
use nonsmooth::Report;
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
    /// A solved shape with a caption that begins with `words`, and with as many fields as the outputs show. Files for ParaView
    /// hold the sensitivity of the objective to the height of every contact node as well, which takes an adjoint.
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
        let fields = (wanted.pictures || wanted.vtk).then(|| solved.fields(objective, wanted.vtk)).transpose()?;
        Ok(Self { caption: format!("{words}Θ = {:.4e}", solved.value), name, solved, fields })
    }
}

/// Contact pressures side by side on one scale.
pub fn pressure(objective: &ContactObjective, shapes: &[ShownShape<'_>]) -> Result<Figure, FigureError> {
    let problem = objective.solver().problem();
    let [n1, n2, _] = problem.grid.nodes();
    let panel = |shape: &ShownShape<'_>| MapPanel {
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
    report: &Report,
    optimum: &SolvedShape,
) -> Result<Figure, FigureError> {
    let steps = report.history.iter().map(|record| Step {
        kind: record.kind.to_string(),
        value: record.value,
        best: record.center_value,
    });
    let bound = objective.cost().lower_bound(optimum.state.forces.total_normal_force());
    Convergence {
        name: "convergence".into(),
        title: format!("{}: course of the optimization", objective.solver().problem().scene.name),
        quantity: "Θ".into(),
        unit: objective.cost().unit(),
        steps: steps.collect(),
        reference: (bound > 0.0 && bound.is_finite()).then(|| ("least for this force".into(), bound)),
    }
    .figure()
}

/// Largest displacement that is drawn, as a share of the largest side of the bodies.
const MAX_SHOWN_DISPLACEMENT: f64 = 0.08;
/// Largest lift of an upper body, as a share of its largest height.
const MAX_LIFT: f64 = 0.25;

/// Von Mises stresses on the deformed bodies side by side on one scale; shapes without fields are left out.
pub fn von_mises(objective: &ContactObjective, shapes: &[ShownShape<'_>]) -> Result<Figure, FigureError> {
    let problem = objective.solver().problem();
    let seen = || shapes.iter().filter_map(|shape| shape.fields.as_ref().map(|fields| (shape, fields)));
    let bodies = || seen().flat_map(|(_, fields)| &fields.bodies);
    let [a, b] = problem.grid.size;
    let tallest = bodies().map(height).fold(0.0, f64::max);
    let largest =
        bodies().flat_map(|body| &body.displacement).map(|u| u[0].hypot(u[1]).hypot(u[2])).fold(0.0, f64::max);
    let times =
        if largest > 0.0 { nice_below(MAX_SHOWN_DISPLACEMENT * a.max(b).max(tallest) / largest).max(1.0) } else { 1.0 };
    let upper = seen().filter_map(|(_, fields)| fields.bodies.get(1)).map(height).fold(0.0, f64::max);
    let lift = if upper > 0.0 { nice_below(MAX_LIFT * upper) } else { 0.0 };
    let panel = |(shape, fields): (&ShownShape<'_>, &Fields)| SolidPanel {
        caption: shape.caption.clone(),
        blocks: fields.bodies.iter().zip([0.0, lift]).map(|(body, lift)| block(body, times, lift)).collect(),
    };
    let lifted = if lift > 0.0 { format!(", upper body lifted by {lift} mm") } else { String::new() };
    Solids {
        name: "von_mises".into(),
        title: format!("{}: von Mises stress", problem.scene.name),
        quantity: "stress".into(),
        unit: "MPa".into(),
        axes: [format!("x₁ ({a} mm)"), format!("x₂ ({b} mm)"), "x₃".into()],
        note: format!("displacements × {times}{lifted}"),
        panels: seen().map(panel).collect(),
    }
    .figure()
}

/// Heights of the contact surface of the lower body side by side on one scale; shapes without fields are left out.
pub fn surfaces(objective: &ContactObjective, shapes: &[ShownShape<'_>]) -> Result<Figure, FigureError> {
    let problem = objective.solver().problem();
    let [n1, n2, _] = problem.grid.nodes();
    let panel = |shape: &ShownShape<'_>| {
        let heights = &shape.fields.as_ref()?.bodies.first()?.block.upper;
        // The mean height says little, and would hide the shape: contact holds the bodies.
        let mean = heights.iter().sum::<f64>() / heights.len() as f64;
        let rounding = f64::EPSILON * heights.len() as f64 * mean.abs();
        let above = |height: &f64| if (height - mean).abs() <= rounding { 0.0 } else { height - mean };
        let (counts, size) = ([n1, n2], problem.grid.size);
        let caption = format!("{}, mean height {mean:.2} mm", shape.caption);
        Some(SurfacePanel { caption, counts, size, heights: heights.iter().map(above).collect() })
    };
    Surfaces {
        name: "surface".into(),
        title: format!("{}: contact surface of the lower body, without load", problem.scene.name),
        quantity: "height less mean".into(),
        unit: "mm".into(),
        panels: shapes.iter().filter_map(panel).collect(),
    }
    .figure()
}

/// Largest height of a column of a body, mm.
fn height(body: &BodyFields) -> f64 {
    let Block { lower, upper, .. } = &body.block;
    lower.iter().zip(upper).map(|(lower, upper)| upper - lower).fold(0.0, f64::max)
}

/// A body with its displacements magnified, lifted by some mm.
fn block(body: &BodyFields, times: f64, lift: f64) -> SolidBlock {
    let [n1, n2, n3] = body.block.grid.nodes();
    let nodes = (0..n1 * n2 * n3).map(|node| [node / (n2 * n3), node / n3 % n2, node % n3]);
    let points = nodes.zip(&body.displacement).map(|(node, u)| {
        let [x1, x2, x3] = body.block.coordinates(node);
        [x1 + times * u[0], x2 + times * u[1], x3 + times * u[2] + lift]
    });
    SolidBlock { nodes: [n1, n2, n3], points: points.collect(), values: body.nodal_von_mises.clone() }
}
