//! The figures of contact and of a run; solved shapes as figures and files show them.

use crate::commands::failure::Failure;
use crate::commands::report::contact_surface::ContactSurface;
use crate::commands::solved_shape::{ContactObjective, SolvedShape};
use contact::contact_shape::ContactState;
use contact::equilibrium::ContactStatus;
use contact::fields::Fields;
use figures::{
    ClassPanel, Classes, ColourScales, Convergence, Curve, Figure, FigureError, LinePanel, Lines, Map, MapPanel, Step,
    number,
};
use nonsmooth::Report;
use scene_file::OutputSection;

/// A solved shape with its fields and its names.
pub struct ShownShape<'a> {
    /// What it is called beside others.
    pub label: String,
    /// The words above its picture.
    pub caption: String,
    /// The beginning of the names of its files.
    pub name: String,
    pub solved: &'a SolvedShape,
    /// The load case that is shown.
    pub case: usize,
    /// Its displacements and stresses, if a picture, a file or the page shows them.
    pub fields: Option<Fields>,
}

impl<'a> ShownShape<'a> {
    /// A solved shape in one of its load cases, with the beginning of its files' names and what it is called, and with
    /// as many fields as the outputs show. Files for ParaView hold the sensitivity of the objective to the position of
    /// every contact node as well, which takes an adjoint.
    pub fn new(
        objective: &ContactObjective,
        (name, label): (&str, &str),
        (solved, case): (&'a SolvedShape, usize),
        wanted: &OutputSection,
    ) -> Result<Self, Failure> {
        let seen = wanted.pictures || wanted.vtk || wanted.report;
        let fields = seen.then(|| solved.fields(objective, case, wanted.vtk)).transpose()?;
        let caption = format!("{label}, Θ = {}", figures::number(solved.value));
        let own = objective.cases().name(case);
        if own.is_empty() {
            return Ok(Self { label: label.into(), caption, name: name.into(), solved, case, fields });
        }
        let (label, name) = (format!("{label}, case \"{own}\""), format!("{name}_case_{}", case + 1));
        let caption = format!("{label}, peak {} MPa", figures::number(solved.peak_of(objective, case)));
        Ok(Self { label, caption, name, solved, case, fields })
    }

    /// The state that is shown.
    pub fn state(&self) -> &'a ContactState {
        &self.solved.states[self.case]
    }
}

/// Contact pressures on a surface side by side, on one scale or on one each.
pub fn pressure(
    objective: &ContactObjective,
    surface: &ContactSurface,
    shapes: &[ShownShape<'_>],
    scales: ColourScales,
) -> Result<Figure, FigureError> {
    let problem = objective.solver().problem();
    let panel = |(caption, values): (String, Vec<f64>)| MapPanel {
        caption,
        points: surface.plan(),
        faces: surface.faces(),
        values: surface.spread(&values, 0.0),
    };
    let found = shapes.iter().map(|shape| (shape.caption.clone(), objective.pressures(shape.state())));
    let wanted = objective.wanted().map(|wanted| (WANTED.to_owned(), wanted.to_vec()));
    let (name, words) = match scales {
        ColourScales::Common => ("pressure", ""),
        ColourScales::Own => ("pressure_own_scales", ", each on its own scale"),
    };
    Map {
        name: format!("{name}{}", surface.suffix),
        title: format!("{}: contact pressure{}{words}", problem.scene.name, surface.words()),
        quantity: "pressure".into(),
        unit: "MPa".into(),
        axes: surface.axis_names(),
        scales,
        contours: false,
        panels: found.chain(wanted).map(panel).collect(),
    }
    .figure()
}

/// What the wanted pressure is called beside those of shapes.
const WANTED: &str = "wanted";

/// Pressures of all shapes on a surface along both axes of the plan through the peak of each of them.
pub fn cuts(
    objective: &ContactObjective,
    surface: &ContactSurface,
    shapes: &[ShownShape<'_>],
) -> Result<Figure, FigureError> {
    let problem = objective.solver().problem();
    let spread = |values: &[f64]| surface.spread(values, 0.0);
    let pressures: Vec<Vec<f64>> = shapes.iter().map(|shape| spread(&objective.pressures(shape.state()))).collect();
    let wanted = objective.wanted().map(spread);
    let peaks: Vec<usize> = pressures.iter().map(|values| surface.peak(values)).collect();
    let [first, second] = surface.axis_symbols();
    let mut panels: Vec<LinePanel> = Vec::new();
    for (index, &peak) in peaks.iter().enumerate() {
        for (axis, [along, other]) in [[first, second], [second, first]].into_iter().enumerate() {
            let level = surface.level(axis, peak);
            let same = |node: &usize| surface.level(axis, *node) == level;
            // One line may run through several peaks.
            if peaks[..index].iter().any(same) {
                continue;
            }
            let labels =
                shapes.iter().zip(&peaks).filter(|(_, node)| same(node)).map(|(shape, _)| shape.label.as_str());
            let labels = labels.collect::<Vec<_>>().join(", ");
            let curve = |(name, values): (&str, &[f64])| Curve {
                name: name.to_owned(),
                points: surface.cut(axis, peak, values),
            };
            let found = shapes.iter().zip(&pressures).map(|(shape, values)| (shape.label.as_str(), values.as_slice()));
            let wanted = wanted.as_deref().map(|wanted| (WANTED, wanted));
            panels.push(LinePanel {
                caption: format!("{other} = {} mm, through the peak ({labels})", number(level)),
                across: format!("{along} (mm)"),
                curves: found.chain(wanted).map(curve).collect(),
            });
        }
    }
    Lines {
        name: format!("pressure_cuts{}", surface.suffix),
        title: format!("{}: contact pressure along lines through the peaks{}", problem.scene.name, surface.words()),
        quantity: "pressure".into(),
        unit: "MPa".into(),
        columns: 2,
        panels,
    }
    .figure()
}

/// The status of every contact node of a surface; with friction, the traction as arrows.
pub fn status(
    objective: &ContactObjective,
    surface: &ContactSurface,
    shapes: &[ShownShape<'_>],
) -> Result<Figure, FigureError> {
    let problem = objective.solver().problem();
    let friction = problem.boundary.has_friction();
    // Without friction, nothing says whether a closed node slides.
    let names: &[&str] = if friction { &["open", "stick", "slip"] } else { &["open", "closed"] };
    let class = |status: &ContactStatus| match status {
        ContactStatus::Open => 0,
        ContactStatus::Slip if friction => 2,
        ContactStatus::Stick | ContactStatus::Slip => 1,
    };
    let panel = |shape: &ShownShape<'_>| {
        let (forces, rows) = (&shape.state().forces, &shape.state().rows);
        let pairs = forces.tangential.iter().zip(&rows.nodes);
        let tractions: Vec<[f64; 2]> =
            pairs.map(|(force, node)| surface.in_plan(force.map(|force| force / node.area))).collect();
        let classes: Vec<usize> = forces.status.iter().map(class).collect();
        ClassPanel {
            caption: shape.caption.clone(),
            points: surface.plan(),
            faces: surface.faces(),
            classes: surface.spread(&classes, 0),
            arrows: if friction { surface.spread(&tractions, [0.0; 2]) } else { Vec::new() },
        }
    };
    let words = if friction { " and friction traction" } else { "" };
    Classes {
        name: format!("status{}", surface.suffix),
        title: format!("{}: contact status{words}{}", problem.scene.name, surface.words()),
        axes: surface.axis_names(),
        classes: names.iter().map(|name| (*name).to_owned()).collect(),
        arrows: friction.then(|| ("traction".into(), "MPa".into())),
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
        origin: record.origin.to_string(),
        value: record.value,
        best: record.center_value,
    });
    let bound = objective.lower_bound(&optimum.states);
    Convergence {
        name: "convergence".into(),
        title: format!("{}: course of the optimization", objective.solver().problem().scene.name),
        quantity: "Θ".into(),
        unit: objective.unit(),
        steps: steps.collect(),
        // With limits, the center may move to a larger Θ where it exceeds them by less.
        course: if report.constraints.is_empty() { "best so far" } else { "center of the steps" }.into(),
        reference: bound
            .filter(|bound| *bound > 0.0 && bound.is_finite())
            .map(|bound| ("least for this force".into(), bound)),
    }
    .figure()
}
