//! Values on the nodes of plane grids as panels side by side, on one colour scale.

use super::canvas::{Canvas, LABEL, TITLE, text_width};
use super::chart::{Frame, Parts, ROOM_BELOW};
use super::error::{FigureError, finite, grid, some};
use super::figure::Figure;
use super::levels::{ColourScale, Lattice, fill};
use super::scale::{Axis, behind, number};

/// Values over the plane: one or more panels with one colour scale; the largest value of every panel is marked.
///
/// ```
/// use figures::{Map, MapPanel};
/// let panel = |caption: &str, peak: f64| MapPanel {
///     caption: caption.into(),
///     counts: [3, 2],
///     origin: [0.0, 0.0],
///     size: [100.0, 50.0],
///     values: vec![0.0, 0.0, peak, 0.0, 0.0, 0.0],
/// };
/// let map = Map {
///     name: "pressure".into(),
///     title: "Contact pressure".into(),
///     quantity: "pressure".into(),
///     unit: "MPa".into(),
///     axes: ["x₁ (mm)".into(), "x₂ (mm)".into()],
///     panels: vec![panel("initial", 14_809.0), panel("optimal", 4082.0)],
/// };
/// let figure = map.figure()?;
/// assert!(figure.svg.contains("largest 4082 MPa at (50, 0)"));
/// # Ok::<(), figures::FigureError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Map {
    /// Name of the figure, for files.
    pub name: String,
    /// What is seen.
    pub title: String,
    /// What the values are.
    pub quantity: String,
    /// Unit of the values.
    pub unit: String,
    /// Names and units of both axes.
    pub axes: [String; 2],
    /// The panels, from left to right.
    pub panels: Vec<MapPanel>,
}

/// One grid of values.
#[derive(Debug, Clone, PartialEq)]
pub struct MapPanel {
    /// What distinguishes it from the other panels.
    pub caption: String,
    /// Nodes n₁, n₂ along both axes, at least 2.
    pub counts: [usize; 2],
    /// Position of the first node.
    pub origin: [f64; 2],
    /// Lengths between the first and the last node along both axes, > 0.
    pub size: [f64; 2],
    /// One value per node, index i·n₂ + j with i along the first axis.
    pub values: Vec<f64>,
}

/// Longer side of a panel, points.
const SIDE: f64 = 280.0;
/// Room at the left for labels and title of the vertical axis, points.
const ROOM_LEFT: f64 = 52.0;
/// Least ratio of the sides of a panel; slimmer ones are not drawn to scale.
const MIN_SIDE_RATIO: f64 = 0.25;

impl Map {
    /// Draws it.
    ///
    /// # Errors
    /// [`FigureError`] without panels; unless a panel has at least 2 × 2 nodes, a value per node, sides of positive length, and
    /// all numbers are finite.
    pub fn figure(&self) -> Result<Figure, FigureError> {
        some(&self.name, "panels", self.panels.len())?;
        for panel in &self.panels {
            panel.check(&self.name)?;
        }
        let values = self.panels.iter().flat_map(|panel| panel.values.iter().copied());
        let scale = ColourScale::new(&self.quantity, &self.unit, values);
        let sizes: Vec<[f64; 2]> = self.panels.iter().map(|panel| sides(panel.size)).collect();
        let height = sizes.iter().fold(0.0_f64, |height, size| height.max(size[1]));
        let same = self.panels.windows(2).all(|two| two[0].origin == two[1].origin && two[0].size == two[1].size);
        let (mut left, top) = (16.0, 72.0);
        let lefts: Vec<f64> = (0..sizes.len())
            .map(|index| {
                let labelled = index == 0 || !same;
                left += if labelled { ROOM_LEFT } else { 0.0 };
                let here = left;
                left += sizes[index][0].max(self.caption_width(index)) + 36.0;
                here
            })
            .collect();
        let bar_title = text_width(&scale.axis.title, LABEL);
        let width = (left + bar_title.max(75.0) + 10.0).max(text_width(&self.title, TITLE) + 32.0);
        let mut canvas = Canvas::new(width, top + height + ROOM_BELOW + 8.0);
        canvas.text([16.0, 22.0], TITLE, &self.title);
        for (index, panel) in self.panels.iter().enumerate() {
            let labelled = index == 0 || !same;
            let frame = Frame { left: lefts[index], top, width: sizes[index][0], height: sizes[index][1] };
            panel.draw(&mut canvas, frame, &scale, self, labelled);
        }
        scale.bar(&mut canvas, [left, top], height);
        Ok(Figure::new(&self.name, &self.title, canvas))
    }

    fn caption_width(&self, index: usize) -> f64 {
        let panel = &self.panels[index];
        text_width(&panel.caption, LABEL).max(text_width(&panel.largest(&self.unit).1, LABEL))
    }
}

/// Sides in points.
fn sides([first, second]: [f64; 2]) -> [f64; 2] {
    let ratio = (second / first).clamp(MIN_SIDE_RATIO, 1.0 / MIN_SIDE_RATIO);
    if ratio > 1.0 { [SIDE / ratio, SIDE] } else { [SIDE, SIDE * ratio] }
}

impl MapPanel {
    fn check(&self, figure: &str) -> Result<(), FigureError> {
        grid(figure, self.counts, self.size, ["value", "values of a panel"], &self.values)?;
        finite(figure, "origin", self.origin)
    }

    /// Indices of the first node with the largest value, and a text about it.
    fn largest(&self, unit: &str) -> ([usize; 2], String) {
        let larger = |best, node| if self.values[node] > self.values[best] { node } else { best };
        let best = (0..self.values.len()).fold(0, larger);
        let place = [best / self.counts[1], best % self.counts[1]];
        let [x, y] = std::array::from_fn(|axis| {
            number(self.origin[axis] + self.size[axis] * place[axis] as f64 / (self.counts[axis] - 1) as f64)
        });
        (place, format!("largest {}{} at ({x}, {y})", number(self.values[best]), behind(unit)))
    }

    fn draw(&self, canvas: &mut Canvas, frame: Frame, scale: &ColourScale, map: &Map, labelled: bool) {
        let last = self.counts.map(|nodes| (nodes - 1) as f64);
        let place = |[i, j]: [f64; 2]| frame.place([i / last[0], j / last[1]]);
        fill(canvas, Lattice { counts: self.counts, values: &self.values }, scale, place);
        let axis = |index: usize| {
            let ends = [self.origin[index], self.origin[index] + self.size[index]];
            Axis::linear(&map.axes[index], "", ends, 0.0, 5)
        };
        frame.axes(canvas, &axis(0), &axis(1), Parts { left: labelled.then_some(ROOM_LEFT), grid: false });
        let ([i, j], text) = self.largest(&map.unit);
        ring(canvas, place([i as f64, j as f64]));
        canvas.text([frame.left, frame.top - 26.0], LABEL, &self.caption);
        canvas.text([frame.left, frame.top - 10.0], LABEL, &text);
    }
}

/// A ring seen on every colour.
fn ring(canvas: &mut Canvas, [x, y]: [f64; 2]) {
    canvas.raw(&format!(
        "<g class=\"largest\" fill=\"none\"><circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"6\" stroke=\"#ffffff\" \
         stroke-width=\"3\"/><circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"6\" stroke=\"#000000\" stroke-width=\"1.2\"/></g>\n"
    ));
}
