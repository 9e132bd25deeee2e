//! How bodies are drawn: their magnification, what is moved apart, and the relief of the contact surface.

use crate::commands::numbers::number;
use crate::commands::report::contact_surface::ContactSurface;
use crate::commands::report::gallery::ShownShape;
use crate::commands::report::skin::extent;
use crate::commands::solved_shape::ContactObjective;
use contact::equilibrium::ContactProblem;
use contact::fields::BodyFields;
use contact::scene::Scene;
use contact::shape::{LatticeShape, Positions};
use figures::{ColourScales, Figure, FigureError, Map, MapPanel, nice_below};

/// Largest displacement that is drawn, as a share of the largest side of the bodies.
const MAX_SHOWN_DISPLACEMENT: f64 = 0.08;
/// Largest lift of bodies above others, as a share of their largest height.
pub const MAX_LIFT: f64 = 0.25;

/// The factor by which displacements of some bodies are drawn larger.
pub fn magnification<'a, I: Iterator<Item = &'a BodyFields>>(bodies: impl Fn() -> I) -> f64 {
    let side = bodies().flat_map(|body| (0..3).map(|axis| side(body, axis))).fold(0.0, f64::max);
    let largest =
        bodies().flat_map(|body| &body.displacement).map(|u| u[0].hypot(u[1]).hypot(u[2])).fold(0.0, f64::max);
    if largest > 0.0 { nice_below(MAX_SHOWN_DISPLACEMENT * side / largest).max(1.0) } else { 1.0 }
}

/// By how much bodies are moved so that contact surfaces are seen: the master of a contact from its slave by a vector
/// of the slave face. Bodies that are glued stay together.
pub fn apart(scene: &Scene, surfaces: &[ContactSurface], by: impl Fn(&ContactSurface) -> [f64; 3]) -> Vec<[f64; 3]> {
    let towards = |contact: usize| surfaces.iter().find(|surface| surface.contact == contact).map_or([0.0; 3], &by);
    let mut places: Vec<Option<[f64; 3]>> = vec![None; scene.bodies.len()];
    for root in 0..places.len() {
        places[root].get_or_insert([0.0; 3]);
        let mut grows = true;
        while std::mem::take(&mut grows) {
            for (index, contact) in scene.contacts.iter().enumerate() {
                let Some(master) = contact.master_face() else { continue };
                let (slave, master, way) = (contact.slave.body, master.body, towards(index));
                let (to, place) = match (places[slave], places[master]) {
                    (Some(from), None) => (master, std::array::from_fn(|axis| from[axis] + way[axis])),
                    (None, Some(from)) => (slave, std::array::from_fn(|axis| from[axis] - way[axis])),
                    _ => continue,
                };
                (places[to], grows) = (Some(place), true);
            }
        }
    }
    places.into_iter().map(Option::unwrap_or_default).collect()
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
    /// The reliefs of all contact surfaces that controls move.
    pub fn all(problem: &ContactProblem) -> Vec<Self> {
        ContactSurface::shaped(problem).into_iter().map(|surface| Self::new(problem, surface)).collect()
    }

    fn new(problem: &ContactProblem, surface: ContactSurface) -> Self {
        let positions = &problem.start_positions()[surface.body];
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
        let heights = problem.scene.bodies[surface.body].heights();
        let is_height =
            heights.and_then(LatticeShape::face).is_some_and(|face| face.block_face().name() == surface.face);
        Self { is_height, surface, normals, start }
    }

    fn captioned(&self, caption: &str, values: Vec<f64>) -> (String, Vec<f64>) {
        if self.is_height { above_mean(caption, &values) } else { (caption.to_owned(), values) }
    }

    /// Heights, or displacements along the outward normal.
    pub fn outward(&self, positions: &Positions) -> Vec<f64> {
        self.outward_of(&positions[self.surface.body])
    }

    /// As [`outward`](Self::outward), of the positions of the nodes of its body.
    fn outward_of(&self, positions: &[[f64; 3]]) -> Vec<f64> {
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
    let body = shape.fields.as_ref()?.bodies.get(relief.surface.body)?;
    Some(relief.captioned(&shape.caption, relief.outward_of(&body.positions)))
}

/// Relief of the contact surface seen along its normal, with lines of equal value.
pub fn surface_map(
    objective: &ContactObjective,
    relief: &Relief,
    shapes: &[ShownShape<'_>],
) -> Result<Figure, FigureError> {
    let problem = objective.solver().problem();
    let panel =
        |(caption, values)| MapPanel { caption, points: relief.surface.plan(), faces: relief.surface.faces(), values };
    Map {
        name: format!("surface_map{}", relief.surface.suffix),
        title: format!("{}: {}, lines of equal {}", problem.scene.name, relief.surface.owner, relief.quantity()),
        quantity: relief.quantity().into(),
        unit: "mm".into(),
        axes: relief.surface.axis_names(),
        scales: ColourScales::Common,
        contours: true,
        panels: shapes.iter().filter_map(|shape| relief_of(relief, shape)).map(panel).collect(),
    }
    .figure()
}

/// Length of a body along an axis, mm.
fn side(body: &BodyFields, axis: usize) -> f64 {
    let [least, most] = extent(body.positions.iter().copied(), axis);
    most - least
}
