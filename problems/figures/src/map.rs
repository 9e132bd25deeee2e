//! Values on the nodes of plane grids as panels side by side, on one colour scale or on one each.

use super::canvas::{Canvas, LABEL, TITLE, text_width};
use super::chart::{Frame, Parts, ROOM_BELOW};
use super::error::{FigureError, finite, grid, some};
use super::figure::Figure;
use super::levels::{ColourScale, Lattice, contour, fill};
use super::nodes::PlaneGrid;
use super::panel_layout::{PanelLayout, ROOM_LEFT};
use super::scale::{Axis, behind, number};

/// Values over the plane: one or more panels; the largest value of every panel is marked. Up to 5000 nodes of a panel,
/// a browser shows number, place and value of the node under the pointer.
///
/// ```
/// use figures::{ColourScales, Map, MapPanel};
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
///     scales: ColourScales::Common,
///     contours: false,
///     panels: vec![panel("initial", 14_809.0), panel("optimal", 4082.0)],
/// };
/// let figure = map.figure()?;
/// assert!(figure.svg.contains("largest 4082 MPa at (50, 0)"));
/// assert!(figure.svg.contains("<title>node (1, 0) at (50, 0): 4082 MPa</title>"));
/// # Ok::<(), figures::FigureError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Map {
    /// Name of the figure, for files.
    pub name: String,
    /// Title above the figure; it states what is seen.
    pub title: String,
    /// What the values are.
    pub quantity: String,
    /// Unit of the values.
    pub unit: String,
    /// Names and units of both axes.
    pub axes: [String; 2],
    /// Which values have the same colour.
    pub scales: ColourScales,
    /// Lines with labels at the ticks of the colour scale.
    pub contours: bool,
    /// The panels, from left to right.
    pub panels: Vec<MapPanel>,
}

/// Which values of the panels of a figure have the same colour.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ColourScales {
    /// Equal values have equal colours in all panels.
    Common,
    /// Every panel uses all colours.
    Own,
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

/// Room of a colour bar with its labels, points.
const ROOM_OF_BAR: f64 = 85.0;

impl Map {
    /// Draws it.
    ///
    /// # Errors
    /// [`FigureError`] without panels; unless a panel has at least 2 × 2 nodes, a value per node, sides of positive
    /// length, and all numbers are finite.
    pub fn figure(&self) -> Result<Figure, FigureError> {
        some(&self.name, "panels", self.panels.len())?;
        for panel in &self.panels {
            grid(&self.name, panel.counts, panel.size, ["value", "values of a panel"], &panel.values)?;
            finite(&self.name, "origin", panel.origin)?;
        }
        let scale = |panels: &[MapPanel]| {
            let values = panels.iter().flat_map(|panel| panel.values.iter().copied());
            ColourScale::new(&self.quantity, &self.unit, values)
        };
        let scales: Vec<ColourScale> = match self.scales {
            ColourScales::Common => vec![scale(&self.panels)],
            ColourScales::Own => self.panels.chunks(1).map(scale).collect(),
        };
        let bar = ROOM_OF_BAR.max(text_width(&scales[0].axis.title, LABEL) + 10.0);
        let captions: Vec<[String; 2]> =
            self.panels.iter().map(|panel| [panel.caption.clone(), panel.largest(&self.unit).1]).collect();
        let grids: Vec<PlaneGrid> = self.panels.iter().map(MapPanel::grid).collect();
        let behind = if self.scales == ColourScales::Own { bar } else { 0.0 };
        let layout = PanelLayout::new(&grids, &captions, behind);
        let width = (layout.right + if behind > 0.0 { 0.0 } else { bar }).max(text_width(&self.title, TITLE) + 32.0);
        let mut canvas = Canvas::new(width, layout.foot + ROOM_BELOW + 8.0);
        canvas.text([16.0, 22.0], TITLE, &self.title);
        layout.write(&mut canvas, &captions, layout.foot + 14.0);
        for (index, panel) in self.panels.iter().enumerate() {
            let (frame, scale) = (layout.frames[index], &scales[index.min(scales.len() - 1)]);
            panel.draw(&mut canvas, frame, scale, self);
            if self.scales == ColourScales::Own {
                scale.bar(&mut canvas, [layout.ends[index] + 16.0, frame.top], frame.height);
            }
        }
        if self.scales == ColourScales::Common {
            let top = layout.frames[0].top;
            scales[0].bar(&mut canvas, [layout.right, top], layout.foot - top);
        }
        Ok(Figure::new(&self.name, &self.title, canvas))
    }
}

impl MapPanel {
    fn grid(&self) -> PlaneGrid {
        PlaneGrid { counts: self.counts, origin: self.origin, size: self.size }
    }

    /// Indices of the first node with the largest value, and a text about it.
    fn largest(&self, unit: &str) -> ([usize; 2], String) {
        let larger = |best, node| if self.values[node] > self.values[best] { node } else { best };
        let best = (0..self.values.len()).fold(0, larger);
        let place = [best / self.counts[1], best % self.counts[1]];
        (place, format!("largest {}{} at {}", number(self.values[best]), behind(unit), self.grid().position(place)))
    }

    fn draw(&self, canvas: &mut Canvas, frame: Frame, scale: &ColourScale, map: &Map) {
        let last = self.counts.map(|nodes| (nodes - 1) as f64);
        let place = |[i, j]: [f64; 2]| frame.place([i / last[0], j / last[1]]);
        fill(canvas, Lattice { counts: self.counts, values: &self.values }, scale, place);
        if map.contours {
            self.contours(canvas, frame, scale);
        }
        let axis = |index: usize| {
            let ends = [self.origin[index], self.origin[index] + self.size[index]];
            Axis::linear(&map.axes[index], "", ends, 0.0, 5)
        };
        frame.axes(canvas, &axis(0), &axis(1), Parts { left: ROOM_LEFT, grid: false });
        let ([i, j], _) = self.largest(&map.unit);
        ring(canvas, place([i as f64, j as f64]));
        let text = |node: usize| format!("{}{}", number(self.values[node]), behind(&map.unit));
        self.grid().name_nodes(canvas, frame, text);
    }

    /// Lines at the ticks of the scale, each with one label, far from the others.
    fn contours(&self, canvas: &mut Canvas, frame: Frame, scale: &ColourScale) {
        let shares: Vec<f64> = self.values.iter().map(|value| scale.axis.share(*value).unwrap_or(0.0)).collect();
        let last = self.counts.map(|nodes| (nodes - 1) as f64);
        let mut labels: Vec<([f64; 2], &str)> = Vec::new();
        for tick in &scale.axis.ticks {
            let pieces = contour(Lattice { counts: self.counts, values: &shares }, tick.share);
            let ends = pieces.iter().map(|piece| piece.map(|[i, j]| frame.place([i / last[0], j / last[1]])));
            let ends: Vec<[[f64; 2]; 2]> = ends.collect();
            canvas.pieces(&ends, "#ffffff");
            let middles = ends.iter().map(|[a, b]| [0.5 * (a[0] + b[0]), 0.5 * (a[1] + b[1])]);
            let room = |at: &[f64; 2]| {
                let inside = [at[0] - frame.left, frame.left + frame.width - at[0]].into_iter();
                let edge = inside.chain([at[1] - frame.top, frame.top + frame.height - at[1]]).fold(40.0, f64::min);
                labels.iter().map(|(other, _)| (at[0] - other[0]).hypot(at[1] - other[1])).fold(2.0 * edge, f64::min)
            };
            // A line too short or too near to others keeps no label: its colour says its value.
            let best = middles.max_by(|a, b| room(a).total_cmp(&room(b))).filter(|at| room(at) > 1.5 * LABEL);
            labels.extend(best.map(|at| (at, tick.label.as_str())));
        }
        labels.into_iter().for_each(|(at, label)| canvas.rimmed(at, LABEL, label));
    }
}

/// A ring seen on every colour.
fn ring(canvas: &mut Canvas, [x, y]: [f64; 2]) {
    canvas.raw(&format!(
        "<g class=\"largest\" fill=\"none\"><circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"6\" stroke=\"#ffffff\" \
         stroke-width=\"3\"/><circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"6\" stroke=\"#000000\" stroke-width=\"1.2\"/></g>\n"
    ));
}
