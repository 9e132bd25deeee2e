//! The figures of the bodies: stresses on the deformed bodies, relief of the contact surface.

use crate::commands::numbers::number;
use crate::commands::report::contact_surface::ContactSurface;
use crate::commands::report::gallery::ShownShape;
use crate::commands::report::skin::{Skin, extent};
use crate::commands::solved_shape::ContactObjective;
use contact::equilibrium::ContactProblem;
use contact::fields::{BodyFields, Fields};
use figures::{
    ColourScales, Figure, FigureError, Map, MapPanel, SolidBody, SolidPanel, Solids, SurfacePanel, Surfaces, View,
    nice_below,
};

/// Largest displacement that is drawn, as a share of the largest side of the bodies.
const MAX_SHOWN_DISPLACEMENT: f64 = 0.08;
/// Largest lift of an upper body, as a share of its largest height.
const MAX_LIFT: f64 = 0.25;

/// Von Mises stresses on the deformed bodies, the shapes side by side on one scale: a figure of all bodies, or, where
/// their materials differ, one per body. Shapes without fields are left out.
pub fn von_mises(objective: &ContactObjective, shapes: &[ShownShape<'_>]) -> Vec<Result<Figure, FigureError>> {
    match &objective.solver().problem().bodies[..] {
        [lower, upper] if lower.solid.materials() != upper.solid.materials() => vec![
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
    let sides: [f64; 3] = std::array::from_fn(|axis| bodies().map(|body| side(body, axis)).fold(0.0, f64::max));
    let side_of_all = sides.into_iter().fold(0.0, f64::max);
    let largest =
        bodies().flat_map(|body| &body.displacement).map(|u| u[0].hypot(u[1]).hypot(u[2])).fold(0.0, f64::max);
    let times = if largest > 0.0 { nice_below(MAX_SHOWN_DISPLACEMENT * side_of_all / largest).max(1.0) } else { 1.0 };
    // A body that is shown alone covers nothing.
    let both = numbers.len() > 1;
    let upper = seen().filter_map(|(_, fields)| fields.bodies.get(1)).filter(|_| both);
    let upper = upper.map(|body| side(body, 2)).fold(0.0, f64::max);
    let lift = if upper > 0.0 { nice_below(MAX_LIFT * upper) } else { 0.0 };
    let panel = |(shape, fields): (&ShownShape<'_>, &Fields)| SolidPanel {
        caption: shape.caption.clone(),
        bodies: numbers
            .iter()
            .filter_map(|&number| fields.bodies.get(number))
            .zip([0.0, lift])
            .map(|(body, lift)| solid(body, times, lift))
            .collect(),
    };
    let lifted = if lift > 0.0 { format!(", upper body lifted by {lift} mm") } else { String::new() };
    let [a, b, _] = sides.map(number);
    Solids {
        name: name.into(),
        title: format!("{}: von Mises stress{words}", problem.scene.name),
        quantity: "stress".into(),
        unit: "MPa".into(),
        axes: [format!("x₁ ({a} mm)"), format!("x₂ ({b} mm)"), "x₃".into()],
        note: format!("displacements × {times}{lifted}"),
        view: View::towards(ContactSurface::new(problem).normal),
        panels: seen().map(panel).collect(),
    }
    .figure()
}

/// What a contact surface is shown by: heights less their mean, or, for shapes of a lattice, its displacement along the
/// outward normal of the surface at the start.
pub struct Relief {
    surface: ContactSurface,
    is_height: bool,
    normals: Vec<[f64; 3]>,
    start: Vec<[f64; 3]>,
}

impl Relief {
    pub fn new(problem: &ContactProblem) -> Self {
        let surface = ContactSurface::new(problem);
        let positions = &problem.start_positions()[0];
        let start: Vec<[f64; 3]> = surface.nodes().iter().map(|&node| positions[node as usize]).collect();
        let mut normals = vec![[0.0; 3]; start.len()];
        for facet in surface.faces() {
            for (index, &node) in facet.iter().enumerate() {
                let (before, after) =
                    (facet[(index + facet.len() - 1) % facet.len()], facet[(index + 1) % facet.len()]);
                let edge = |to: usize| -> [f64; 3] { std::array::from_fn(|axis| start[to][axis] - start[node][axis]) };
                let (a, b) = (edge(after), edge(before));
                (0..3).for_each(|i| {
                    normals[node][i] += a[(i + 1) % 3] * b[(i + 2) % 3] - a[(i + 2) % 3] * b[(i + 1) % 3]
                });
            }
        }
        for normal in &mut normals {
            let length = normal.iter().map(|x| x * x).sum::<f64>().sqrt();
            *normal = normal.map(|x| x / length);
        }
        Self { is_height: problem.scene.heights().is_some(), surface, normals, start }
    }

    /// The relief of positions of all nodes, with a caption.
    pub fn of(&self, caption: &str, positions: &[[f64; 3]]) -> (String, Vec<f64>) {
        let values = self.outward(positions);
        if self.is_height { above_mean(caption, &values) } else { (caption.to_owned(), values) }
    }

    /// Heights, or displacements along the outward normal.
    pub fn outward(&self, positions: &[[f64; 3]]) -> Vec<f64> {
        let nodes = self.surface.nodes().iter().map(|&node| positions[node as usize]);
        if self.is_height {
            return nodes.map(|x| x[2]).collect();
        }
        let moved = nodes.zip(&self.start).zip(&self.normals);
        moved.map(|((x, start), normal)| (0..3).map(|axis| (x[axis] - start[axis]) * normal[axis]).sum()).collect()
    }

    /// What the numbers are.
    pub fn quantity(&self) -> &'static str {
        if self.is_height { "height less mean" } else { "outward displacement by the shape" }
    }

    /// The surface in its plan.
    pub fn surface(&self) -> &ContactSurface {
        &self.surface
    }
}

/// Heights less their mean, and a caption that tells the mean.
fn above_mean(caption: &str, heights: &[f64]) -> (String, Vec<f64>) {
    // The mean height says little, and would hide the shape: contact holds the bodies.
    let mean = heights.iter().sum::<f64>() / heights.len() as f64;
    let rounding = f64::EPSILON * heights.len() as f64 * mean.abs();
    let above = |height: &f64| if (height - mean).abs() <= rounding { 0.0 } else { height - mean };
    (format!("{caption}, mean height {} mm", number(mean)), heights.iter().map(above).collect())
}

/// The relief of a shape; none for a shape without fields.
fn relief_of(relief: &Relief, shape: &ShownShape<'_>) -> Option<(String, Vec<f64>)> {
    Some(relief.of(&shape.caption, &shape.fields.as_ref()?.bodies.first()?.positions))
}

/// Relief of the contact surface side by side on one scale; shapes without fields are left out.
pub fn surfaces(objective: &ContactObjective, shapes: &[ShownShape<'_>]) -> Result<Figure, FigureError> {
    let problem = objective.solver().problem();
    let relief = Relief::new(problem);
    let panel = |(caption, heights): (String, Vec<f64>)| SurfacePanel {
        caption,
        points: relief.surface.plan().into_iter().zip(heights).map(|([x1, x2], height)| [x1, x2, height]).collect(),
        faces: relief.surface.faces(),
    };
    Surfaces {
        name: "surface".into(),
        title: format!("{}: contact surface of the lower body, without load", problem.scene.name),
        quantity: relief.quantity().into(),
        unit: "mm".into(),
        panels: shapes.iter().filter_map(|shape| relief_of(&relief, shape)).map(panel).collect(),
    }
    .figure()
}

/// Relief of the contact surface seen along its normal, with lines of equal value.
pub fn surface_map(objective: &ContactObjective, shapes: &[ShownShape<'_>]) -> Result<Figure, FigureError> {
    let problem = objective.solver().problem();
    let relief = Relief::new(problem);
    let panel =
        |(caption, values)| MapPanel { caption, points: relief.surface.plan(), faces: relief.surface.faces(), values };
    Map {
        name: "surface_map".into(),
        title: format!(
            "{}: contact surface of the lower body, lines of equal {}",
            problem.scene.name,
            relief.quantity()
        ),
        quantity: relief.quantity().into(),
        unit: "mm".into(),
        axes: relief.surface.axis_names(),
        scales: ColourScales::Common,
        contours: true,
        panels: shapes.iter().filter_map(|shape| relief_of(&relief, shape)).map(panel).collect(),
    }
    .figure()
}

/// Length of a body along an axis, mm.
fn side(body: &BodyFields, axis: usize) -> f64 {
    let [least, most] = extent(body.positions.iter().copied(), axis);
    most - least
}

/// A body with its displacements magnified, lifted by some mm.
fn solid(body: &BodyFields, times: f64, lift: f64) -> SolidBody {
    let skin = Skin::new(&body.mesh);
    let point = |&node: &u32| {
        let ([x1, x2, x3], u) = (body.positions[node as usize], body.displacement[node as usize]);
        [x1 + times * u[0], x2 + times * u[1], x3 + times * u[2] + lift]
    };
    SolidBody {
        points: skin.nodes.iter().map(point).collect(),
        values: skin.nodes.iter().map(|&node| body.nodal_von_mises[node as usize]).collect(),
        faces: skin.faces,
    }
}
