//! Bodies in space with arrows and supports at them, and a legend with what these stand for.

use super::canvas::{Anchor, Canvas, INK, LABEL, Place, Stroke, TITLE, TITLE_ROOM, text_width};
use super::colours::curve;
use super::error::{FigureError, finite, mesh, some};
use super::figure::Figure;
use super::oblique::{Skin, paint};
use super::view::{Point, Projection, View};

/// Bodies in space, with marks that letters join to their rows in the legend.
///
/// ```
/// use figures::{Sign, Sketch, SketchBody, SketchMark, View, box_faces};
/// let corner = |node: u8| [f64::from(node >> 2 & 1), f64::from(node >> 1 & 1), f64::from(node & 1)];
/// let sketch = Sketch {
///     name: "sketch".into(),
///     title: "A loaded cube".into(),
///     axes: ["x₁ (1 mm)".into(), "x₂ (1 mm)".into(), "x₃ (1 mm)".into()],
///     bodies: vec![SketchBody { points: (0..8).map(corner).collect(), faces: box_faces([2, 2, 2]) }],
///     view: View::default(),
///     marks: vec![SketchMark {
///         sign: Sign::Arrow,
///         text: "traction (0, 0, −5) MPa".into(),
///         lines: vec![[[0.5, 0.5, 1.4], [0.5, 0.5, 1.0]]],
///     }],
///     notes: vec!["E = 7·10^{4} MPa".into()],
/// };
/// assert!(sketch.figure()?.svg.contains("traction (0, 0, −5) MPa"));
/// # Ok::<(), figures::FigureError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Sketch {
    /// Name of the figure, for files.
    pub name: String,
    /// Title above the figure; it states what is seen.
    pub title: String,
    /// What is written at the arrows of the three axes: names, lengths.
    pub axes: [String; 3],
    /// The bodies. Edges and outlines are drawn; up to 1500 faces to be seen, the sides of the faces as well.
    pub bodies: Vec<SketchBody>,
    /// The direction from which they are seen.
    pub view: View,
    /// What acts on them, in the order of the letters.
    pub marks: Vec<SketchMark>,
    /// Further lines of the legend.
    pub notes: Vec<String>,
}

/// The skin of a body. A skin that is open, such as a surface, is seen from both sides.
#[derive(Debug, Clone, PartialEq)]
pub struct SketchBody {
    /// Where the points are; any unit of length.
    pub points: Vec<[f64; 3]>,
    /// Triangles and quadrilaterals between points, counterclockwise seen from outside.
    pub faces: Vec<Vec<usize>>,
}

/// How a mark is drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Sign {
    /// An arrow from the first point to the second.
    Arrow,
    /// A triangle with its tip at the second point and its base at the first.
    Support,
}

/// Something at some points.
#[derive(Debug, Clone, PartialEq)]
pub struct SketchMark {
    /// How it is drawn.
    pub sign: Sign,
    /// What it stands for.
    pub text: String,
    /// Where it is: pairs of points. It is drawn before the bodies.
    pub lines: Vec<[[f64; 3]; 2]>,
}

/// Larger side of the drawing of the bodies, points.
const SIDE: f64 = 330.0;
const MARGIN: f64 = 16.0;
/// Length of an arrow of the axes, points.
const ARROW: f64 = 30.0;
/// Upper side of the drawing, points.
const TOP: f64 = 44.0;
/// Height of a row of the legend, points.
const ROW: f64 = 21.0;

impl Sketch {
    /// Draws it.
    ///
    /// # Errors
    /// [`FigureError`] without bodies or faces; unless every face joins three or four different points and all numbers
    /// are finite.
    pub fn figure(&self) -> Result<Figure, FigureError> {
        some(&self.name, "bodies", self.bodies.len())?;
        for (index, body) in self.bodies.iter().enumerate() {
            mesh(&self.name, &format!("body {index}"), &body.points, &body.faces)?;
        }
        for (index, mark) in self.marks.iter().enumerate() {
            finite(
                &self.name,
                &format!("mark {index}, coordinate"),
                mark.lines.as_flattened().as_flattened().to_vec(),
            )?;
        }
        let [across, up] = self.view.bounds(self.points());
        let extents = [across, up].map(|[low, high]| high - low);
        let largest = extents[0].max(extents[1]);
        let points = if largest > 0.0 { SIDE / largest } else { 1.0 };
        let size = extents.map(|extent| points * extent);
        // Letters stand outside the drawing and need room of their own.
        let room = 1.8 * LABEL;
        let origin = [MARGIN + room - points * across[0], TOP + room - points * up[0]];
        let projection = Projection { view: self.view, origin, scale: points };
        let (foot, right) = (TOP + size[1] + 2.0 * room, MARGIN + size[0] + 2.0 * room + 20.0);
        let texts = self.marks.iter().map(|mark| &mark.text).chain(&self.notes);
        let legend = texts.fold(0.0_f64, |width, text| width.max(text_width(text, LABEL)));
        let width = (right + 48.0 + legend + MARGIN).max(text_width(&self.title, TITLE) + 2.0 * MARGIN);
        let rows = (self.marks.len() + self.notes.len()) as f64;
        let mut canvas = Canvas::new(width, (foot + 74.0).max(TOP + room + rows * ROW + MARGIN));
        canvas.text([MARGIN, 22.0], TITLE, &self.title);
        let marks = || self.marks.iter().enumerate();
        let skins = self.bodies.iter().map(|body| Skin::new(&body.points, &body.faces)).collect::<Vec<Skin>>();
        paint(&mut canvas, &projection, &skins);
        marks().for_each(|(index, mark)| mark.draw(&mut canvas, &projection, index));
        marks().for_each(|(index, mark)| mark.write_letter(&mut canvas, &projection, index));
        canvas.part([0.0, TITLE_ROOM], [right - 4.0, canvas.height]);
        canvas.part([right - 4.0, TITLE_ROOM], [canvas.width, TOP + room + (rows + 0.5) * ROW]);
        directions(&mut canvas, self.view, &self.axes, [MARGIN, foot + 52.0]);
        self.legend(&mut canvas, [right, TOP + room]);
        Ok(Figure::new(&self.name, &self.title, canvas))
    }

    fn points(&self) -> impl Iterator<Item = Point> + Clone {
        let marks = self.marks.iter().flat_map(|mark| mark.lines.iter().flatten().copied());
        self.bodies.iter().flat_map(|body| body.points.iter().copied()).chain(marks)
    }

    fn legend(&self, canvas: &mut Canvas, [x, mut y]: Place) {
        for (index, mark) in self.marks.iter().enumerate() {
            canvas.rimmed([x + 4.0, y], LABEL, &letter(index));
            let line = [[x + 16.0, y], [x + 38.0, y]];
            match mark.sign {
                Sign::Arrow => canvas.arrow(line, Stroke::solid(curve(index), 1.8)),
                Sign::Support => triangle(canvas, [[x + 27.0, y + 6.0], [x + 27.0, y - 5.0]], curve(index)),
            }
            canvas.text([x + 48.0, y + 0.34 * LABEL], LABEL, &mark.text);
            y += ROW;
        }
        for note in &self.notes {
            canvas.text([x, y + 0.34 * LABEL], LABEL, note);
            y += ROW;
        }
    }
}

/// A, B, …, Z, A1, …
fn letter(index: usize) -> String {
    let letter = char::from(b'A' + (index % 26) as u8);
    if index < 26 { letter.to_string() } else { format!("{letter}{}", index / 26) }
}

/// A triangle with its tip at the second place.
fn triangle(canvas: &mut Canvas, [base, tip]: [Place; 2], colour: &str) {
    let across = [0.5 * (tip[1] - base[1]), -0.5 * (tip[0] - base[0])];
    let corners = [tip, [base[0] + across[0], base[1] + across[1]], [base[0] - across[0], base[1] - across[1]]];
    canvas.area(colour, [corners.as_slice()]);
    canvas.outline(&corners, Stroke::solid(INK, 0.6));
}

impl SketchMark {
    fn draw(&self, canvas: &mut Canvas, projection: &Projection, index: usize) {
        for line in &self.lines {
            let line = line.map(|point| projection.place(point));
            match self.sign {
                Sign::Arrow => canvas.arrow(line, Stroke::solid(curve(index), 1.8)),
                Sign::Support => triangle(canvas, line, curve(index)),
            }
        }
    }

    /// The letter behind the first point of the pair in the middle.
    fn write_letter(&self, canvas: &mut Canvas, projection: &Projection, index: usize) {
        let Some(line) = self.lines.get(self.lines.len() / 2) else { return };
        let [tail, tip] = line.map(|point| projection.place(point));
        let away = [tail[0] - tip[0], tail[1] - tip[1]];
        let length = away[0].hypot(away[1]);
        let away = if length > 0.0 { away.map(|part| part / length) } else { [0.0, -1.0] };
        canvas.rimmed([tail[0] + 10.0 * away[0], tail[1] + 10.0 * away[1]], LABEL, &letter(index));
    }
}

/// Where the arrow of an axis ends, if it begins at 0.
fn arrow_end(view: View, axis: usize) -> Place {
    let unit = std::array::from_fn(|other| f64::from(u8::from(other == axis)));
    Projection { view, origin: [0.0; 2], scale: ARROW }.place(unit)
}

/// Room at the left and at the right of the origin of the arrows that [`directions`] draws.
fn axes_room(view: View, axes: &[String; 3]) -> [f64; 2] {
    axes.iter().enumerate().fold([8.0, 2.0 * ARROW - 8.0], |[before, behind], (axis, label)| {
        let (x, width) = (arrow_end(view, axis)[0], text_width(label, LABEL) + 5.0);
        if x < -1.0 { [before.max(width - x), behind] } else { [before, behind.max(width + x + 16.0)] }
    })
}

/// The directions of the three axes as arrows with labels, from some left side on; the arrows begin at a height.
fn directions(canvas: &mut Canvas, view: View, axes: &[String; 3], [left, height]: Place) {
    let origin = [left + axes_room(view, axes)[0], height];
    for (axis, label) in axes.iter().enumerate() {
        let [x, y] = arrow_end(view, axis);
        let end = [origin[0] + x, origin[1] + y];
        canvas.arrow([origin, end], Stroke::solid(INK, 1.0));
        // The third axis points upwards.
        let below = if axis == 2 { 2.0 } else { 0.34 * LABEL };
        let (gap, anchor) = if x < -1.0 { (-5.0, Anchor::End) } else { (5.0, Anchor::Start) };
        canvas.anchored([end[0] + gap, end[1] + below], LABEL, anchor, label);
    }
}
