//! The figures of the bodies: stresses on the deformed bodies, heights of the contact surface.

use crate::commands::numbers::number;
use crate::commands::report::gallery::ShownShape;
use crate::commands::solved_shape::ContactObjective;
use contact::body::mesh::{Block, Grid};
use contact::fields::{BodyFields, Fields};
use figures::{
    ColourScales, Figure, FigureError, Map, MapPanel, SolidBody, SolidPanel, Solids, SurfacePanel, Surfaces, View,
    box_faces, grid_faces, nice_below,
};

/// Largest displacement that is drawn, as a share of the largest side of the bodies.
const MAX_SHOWN_DISPLACEMENT: f64 = 0.08;
/// Largest lift of an upper body, as a share of its largest height.
const MAX_LIFT: f64 = 0.25;

/// Von Mises stresses on the deformed bodies, the shapes side by side on one scale: a figure of all bodies, or, where
/// their materials differ, one per body. Shapes without fields are left out.
pub fn von_mises(objective: &ContactObjective, shapes: &[ShownShape<'_>]) -> Vec<Result<Figure, FigureError>> {
    let mut scenes = objective.solver().problem().bodies();
    match (scenes.next(), scenes.next()) {
        (Some(lower), Some(upper)) if lower.material != upper.material => vec![
            stresses(objective, shapes, ("von_mises_lower", ", lower body", &[0])),
            stresses(objective, shapes, ("von_mises_upper", ", upper body", &[1])),
        ],
        _ => vec![stresses(objective, shapes, ("von_mises", "", &[0, 1]))],
    }
}

/// The stresses of the bodies with these numbers.
fn stresses(
    objective: &ContactObjective,
    shapes: &[ShownShape<'_>],
    (name, words, numbers): (&str, &str, &[usize]),
) -> Result<Figure, FigureError> {
    let problem = objective.solver().problem();
    let seen = || shapes.iter().filter_map(|shape| shape.fields.as_ref().map(|fields| (shape, fields)));
    let bodies = || seen().flat_map(|(_, fields)| numbers.iter().filter_map(|&number| fields.bodies.get(number)));
    let [a, b] = problem.grid.size;
    let tallest = bodies().map(height).fold(0.0, f64::max);
    let largest =
        bodies().flat_map(|body| &body.displacement).map(|u| u[0].hypot(u[1]).hypot(u[2])).fold(0.0, f64::max);
    let times =
        if largest > 0.0 { nice_below(MAX_SHOWN_DISPLACEMENT * a.max(b).max(tallest) / largest).max(1.0) } else { 1.0 };
    // A body that is shown alone covers nothing.
    let both = numbers.len() > 1;
    let upper = seen().filter_map(|(_, fields)| fields.bodies.get(1)).filter(|_| both).map(height).fold(0.0, f64::max);
    let lift = if upper > 0.0 { nice_below(MAX_LIFT * upper) } else { 0.0 };
    let panel = |(shape, fields): (&ShownShape<'_>, &Fields)| SolidPanel {
        caption: shape.caption.clone(),
        bodies: numbers
            .iter()
            .filter_map(|&number| fields.bodies.get(number))
            .zip([0.0, lift])
            .map(|(body, lift)| block(body, times, lift))
            .collect(),
    };
    let lifted = if lift > 0.0 { format!(", upper body lifted by {lift} mm") } else { String::new() };
    Solids {
        name: name.into(),
        title: format!("{}: von Mises stress{words}", problem.scene.name),
        quantity: "stress".into(),
        unit: "MPa".into(),
        axes: [format!("x₁ ({a} mm)"), format!("x₂ ({b} mm)"), "x₃".into()],
        note: format!("displacements × {times}{lifted}"),
        view: View::default(),
        panels: seen().map(panel).collect(),
    }
    .figure()
}

/// Heights of the contact surface less their mean, with a caption; none for a shape without fields.
fn heights(shape: &ShownShape<'_>) -> Option<(String, Vec<f64>)> {
    Some(above_mean(&shape.caption, &shape.fields.as_ref()?.bodies.first()?.block.upper))
}

/// Heights less their mean, and a caption that tells the mean.
pub fn above_mean(caption: &str, heights: &[f64]) -> (String, Vec<f64>) {
    // The mean height says little, and would hide the shape: contact holds the bodies.
    let mean = heights.iter().sum::<f64>() / heights.len() as f64;
    let rounding = f64::EPSILON * heights.len() as f64 * mean.abs();
    let above = |height: &f64| if (height - mean).abs() <= rounding { 0.0 } else { height - mean };
    (format!("{caption}, mean height {} mm", number(mean)), heights.iter().map(above).collect())
}

/// Heights of the contact surface of the lower body side by side on one scale; shapes without fields are left out.
pub fn surfaces(objective: &ContactObjective, shapes: &[ShownShape<'_>]) -> Result<Figure, FigureError> {
    let problem = objective.solver().problem();
    let [n1, n2, _] = problem.grid.nodes();
    let panel = |(caption, heights): (String, Vec<f64>)| SurfacePanel {
        caption,
        points: plan(&problem.grid).into_iter().zip(heights).map(|([x1, x2], height)| [x1, x2, height]).collect(),
        faces: grid_faces([n1, n2]),
    };
    Surfaces {
        name: "surface".into(),
        title: format!("{}: contact surface of the lower body, without load", problem.scene.name),
        quantity: "height less mean".into(),
        unit: "mm".into(),
        panels: shapes.iter().filter_map(heights).map(panel).collect(),
    }
    .figure()
}

/// Heights of the contact surface less their mean, seen from above, with lines of equal height.
pub fn surface_map(objective: &ContactObjective, shapes: &[ShownShape<'_>]) -> Result<Figure, FigureError> {
    let problem = objective.solver().problem();
    let [n1, n2, _] = problem.grid.nodes();
    let panel =
        |(caption, values)| MapPanel { caption, points: plan(&problem.grid), faces: grid_faces([n1, n2]), values };
    Map {
        name: "surface_map".into(),
        title: format!("{}: contact surface of the lower body from above, lines of equal height", problem.scene.name),
        quantity: "height less mean".into(),
        unit: "mm".into(),
        axes: ["x₁ (mm)".into(), "x₂ (mm)".into()],
        scales: ColourScales::Common,
        contours: true,
        panels: shapes.iter().filter_map(heights).map(panel).collect(),
    }
    .figure()
}

/// Positions of all columns of a grid, mm.
pub fn plan(grid: &Grid) -> Vec<[f64; 2]> {
    grid.columns().map(|(i, j)| grid.position(i, j)).collect()
}

/// Largest height of a column of a body, mm.
fn height(body: &BodyFields) -> f64 {
    let Block { lower, upper, .. } = &body.block;
    lower.iter().zip(upper).map(|(lower, upper)| upper - lower).fold(0.0, f64::max)
}

/// A body with its displacements magnified, lifted by some mm.
fn block(body: &BodyFields, times: f64, lift: f64) -> SolidBody {
    let [n1, n2, n3] = body.block.grid.nodes();
    let nodes = (0..n1 * n2 * n3).map(|node| [node / (n2 * n3), node / n3 % n2, node % n3]);
    let points = nodes.zip(&body.displacement).map(|(node, u)| {
        let [x1, x2, x3] = body.block.coordinates(node);
        [x1 + times * u[0], x2 + times * u[1], x3 + times * u[2] + lift]
    });
    SolidBody { points: points.collect(), faces: box_faces([n1, n2, n3]), values: body.nodal_von_mises.clone() }
}
