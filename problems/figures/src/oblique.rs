//! Sheets of quads in space seen from the front, the right and above, in parallel projection.
//!
//! ```text
//! to the right  r = (cos φ, sin φ, 0),   up  u = (−sin ε sin φ, sin ε cos φ, cos ε),   towards the viewer  w = r × u
//! place on the drawing = scale · (p·r, −p·u),   depth = p·w,   φ = 35°, ε = 30°
//! ```
//! Of a box the faces x₁ = max, x₂ = 0 and x₃ = max are seen. A quad is turned towards the viewer if its corners run
//! round it on the drawing in the same sense as those of a quad whose outside is seen. If all quads of a sheet are
//! turned towards the viewer, or none is, no part of the sheet hides another, and the sheet is filled as a whole.
//! Otherwise the quads turned towards the viewer (all quads, if the sheet is a surface without a body) are drawn one
//! over the other, the furthest first.

use super::canvas::{Canvas, INK, Place, Stroke};
use super::levels::{ColourScale, Lattice, fill};
use super::scale::extent;

/// Most quads of a panel between which mesh lines are drawn.
pub(super) const MAX_MESHED_QUADS: usize = 1500;
/// Most quads that are drawn one over the other with more than one colour each.
const MAX_BANDED_QUADS: usize = 400;
/// Colour of sheets without values.
const PLAIN: &str = "#e6e6e6";
/// Colour of mesh lines.
const MESH: &str = "#4d4d4d";
const MESH_WIDTH: f64 = 0.35;

/// A point in space.
pub(super) type Point = [f64; 3];

/// n₁ × n₂ points of a surface, index i·n₂ + j; from outside, the second index grows to the left of the first.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Sheet {
    pub counts: [usize; 2],
    pub points: Vec<Point>,
    /// One value per point; without, the sheet is grey.
    pub values: Option<Vec<f64>>,
}

/// How points are placed on the drawing.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct View {
    /// Place of the point 0.
    pub origin: Place,
    /// Points of the drawing per unit of length.
    pub scale: f64,
}

/// r, u and w of the head of the file.
fn directions() -> [Point; 3] {
    let ((sin_turn, cos_turn), (sin_rise, cos_rise)) =
        (35.0_f64.to_radians().sin_cos(), 30.0_f64.to_radians().sin_cos());
    [
        [cos_turn, sin_turn, 0.0],
        [-sin_rise * sin_turn, sin_rise * cos_turn, cos_rise],
        [cos_rise * sin_turn, -cos_rise * cos_turn, sin_rise],
    ]
}

fn dot(a: Point, b: Point) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

impl View {
    /// Place of a point on the drawing.
    pub fn place(&self, point: Point) -> Place {
        let [right, up, _] = directions();
        [self.origin[0] + self.scale * dot(point, right), self.origin[1] - self.scale * dot(point, up)]
    }
}

/// Smallest and largest coordinates of points on a drawing of scale 1.
pub(super) fn bounds(points: impl Iterator<Item = Point> + Clone) -> [[f64; 2]; 2] {
    let view = View { origin: [0.0; 2], scale: 1.0 };
    [0, 1].map(|axis| extent(points.clone().map(|point| view.place(point)[axis])).map_or([0.0; 2], |(a, b)| [a, b]))
}

/// Bodies one after the other, each made of the sheets around it; what is drawn later covers what was drawn before.
///
/// The body whose points lie nearer on average is drawn later, which is right for bodies that do not interlock. If a
/// sheet of any body hides a part of itself, the quads of all bodies are ordered together.
pub(super) fn paint(canvas: &mut Canvas, view: &View, bodies: &[Vec<Sheet>], scale: &ColourScale) {
    let mut bodies: Vec<(f64, Vec<Seen<'_>>)> = bodies
        .iter()
        .map(|sheets| {
            let seen: Vec<Seen<'_>> = sheets.iter().map(|sheet| Seen::new(sheet, view)).collect();
            let depths = seen.iter().flat_map(|seen| seen.depths.iter());
            let points = depths.clone().count().max(1) as f64;
            (depths.map(|depth| depth / points).sum(), seen)
        })
        .collect();
    bodies.sort_by(|a, b| a.0.total_cmp(&b.0));
    let sheets = || bodies.iter().flat_map(|(_, sheets)| sheets.iter());
    let quads: usize = sheets().map(Seen::turned).sum();
    let meshed = quads < MAX_MESHED_QUADS;
    if sheets().all(|seen| seen.turned() == 0 || seen.turned() == seen.cells().count()) {
        for seen in sheets().filter(|seen| seen.turned() > 0) {
            seen.fill(canvas, scale);
            seen.lines(canvas, meshed);
        }
        return;
    }
    let mut ordered: Vec<(f64, &Seen<'_>, [usize; 2])> = bodies
        .iter()
        .flat_map(|(_, sheets)| sheets.iter().map(|seen| (sheets.len() == 1, seen)))
        .flat_map(|(open, seen)| {
            // Of an open sheet also quads that are turned away in part may be seen in part.
            let drawn = seen.cells().filter(move |&cell| open || seen.is_turned(cell));
            drawn.map(move |cell| (seen.depth(cell), seen, cell))
        })
        .collect();
    ordered.sort_by(|a, b| a.0.total_cmp(&b.0));
    if quads < MAX_BANDED_QUADS {
        for (_, seen, cell) in ordered {
            seen.fill_cell(canvas, scale, cell);
            canvas.outline(&seen.corners(cell), Stroke::solid(MESH, MESH_WIDTH));
        }
        return;
    }
    let areas = ordered.iter().map(|(_, seen, cell)| (seen.colour(scale, *cell), seen.corners(*cell)));
    canvas.covering(meshed.then_some(Stroke::solid(MESH, MESH_WIDTH)), areas);
}

/// A sheet on the drawing.
struct Seen<'a> {
    sheet: &'a Sheet,
    places: Vec<Place>,
    depths: Vec<f64>,
}

impl<'a> Seen<'a> {
    fn new(sheet: &'a Sheet, view: &View) -> Self {
        let [_, _, near] = directions();
        Self {
            sheet,
            places: sheet.points.iter().map(|&point| view.place(point)).collect(),
            depths: sheet.points.iter().map(|&point| dot(point, near)).collect(),
        }
    }

    fn cells(&self) -> impl Iterator<Item = [usize; 2]> + use<> {
        let [n1, n2] = self.sheet.counts;
        (1..n1).flat_map(move |i| (1..n2).map(move |j| [i - 1, j - 1]))
    }

    fn nodes(&self, [i, j]: [usize; 2]) -> [usize; 4] {
        let n2 = self.sheet.counts[1];
        [i * n2 + j, (i + 1) * n2 + j, (i + 1) * n2 + j + 1, i * n2 + j + 1]
    }

    fn corners(&self, cell: [usize; 2]) -> [Place; 4] {
        self.nodes(cell).map(|node| self.places[node])
    }

    /// Area with sign from the diagonals; the second coordinate of a drawing points downwards.
    fn is_turned(&self, cell: [usize; 2]) -> bool {
        let [a, b, c, d] = self.corners(cell);
        (c[0] - a[0]) * (d[1] - b[1]) - (c[1] - a[1]) * (d[0] - b[0]) < 0.0
    }

    /// Number of quads turned towards the viewer.
    fn turned(&self) -> usize {
        self.cells().filter(|&cell| self.is_turned(cell)).count()
    }

    fn depth(&self, cell: [usize; 2]) -> f64 {
        self.nodes(cell).iter().map(|&node| 0.25 * self.depths[node]).sum()
    }

    fn colour(&self, scale: &ColourScale, cell: [usize; 2]) -> String {
        let mean = |values: &Vec<f64>| self.nodes(cell).iter().map(|&node| 0.25 * values[node]).sum();
        self.sheet
            .values
            .as_ref()
            .map_or_else(|| PLAIN.to_owned(), |values| scale.step_colour(scale.step(mean(values))))
    }

    /// The whole sheet, by steps of colour.
    fn fill(&self, canvas: &mut Canvas, scale: &ColourScale) {
        let Some(values) = &self.sheet.values else {
            return canvas.area(PLAIN, [self.border().as_slice()]);
        };
        let last = self.sheet.counts.map(|count| count - 2);
        let place = |at: [f64; 2]| {
            let cell: [usize; 2] = std::array::from_fn(|axis| (at[axis] as usize).min(last[axis]));
            between(self.corners(cell), std::array::from_fn(|axis| at[axis] - cell[axis] as f64))
        };
        fill(canvas, Lattice { counts: self.sheet.counts, values }, scale, place);
    }

    /// One quad, by steps of colour.
    fn fill_cell(&self, canvas: &mut Canvas, scale: &ColourScale, cell: [usize; 2]) {
        let corners = self.corners(cell);
        let Some(values) = &self.sheet.values else {
            return canvas.area(PLAIN, [corners.as_slice()]);
        };
        let [a, b, c, d] = self.nodes(cell).map(|node| values[node]);
        fill(canvas, Lattice { counts: [2, 2], values: &[a, d, b, c] }, scale, |at| between(corners, at));
    }

    /// Border, and mesh lines inside if wanted.
    fn lines(&self, canvas: &mut Canvas, meshed: bool) {
        let [n1, n2] = self.sheet.counts;
        if meshed {
            for i in 1..n1 - 1 {
                canvas.line(&self.places[i * n2..(i + 1) * n2], Stroke::solid(MESH, MESH_WIDTH));
            }
            for j in 1..n2 - 1 {
                let line: Vec<Place> = (0..n1).map(|i| self.places[i * n2 + j]).collect();
                canvas.line(&line, Stroke::solid(MESH, MESH_WIDTH));
            }
        }
        canvas.outline(&self.border(), Stroke::solid(INK, 0.7));
    }

    fn border(&self) -> Vec<Place> {
        let [n1, n2] = self.sheet.counts;
        let first = (0..n1 - 1).map(|i| i * n2);
        let second = (0..n2 - 1).map(|j| (n1 - 1) * n2 + j);
        let third = (1..n1).rev().map(|i| i * n2 + n2 - 1);
        let fourth = (1..n2).rev();
        first.chain(second).chain(third).chain(fourth).map(|node| self.places[node]).collect()
    }
}

/// Bilinear between four corners in the order of [`Seen::nodes`].
fn between([a, b, c, d]: [Place; 4], [s, t]: [f64; 2]) -> Place {
    std::array::from_fn(|axis| {
        (1.0 - t) * ((1.0 - s) * a[axis] + s * b[axis]) + t * ((1.0 - s) * d[axis] + s * c[axis])
    })
}
