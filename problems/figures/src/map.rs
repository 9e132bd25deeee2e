//! Values on meshes in a plane as panels side by side, on one colour scale or on one each.

use super::canvas::{Canvas, LABEL, Place, Stroke, TITLE, text_width};
use super::chart::{Frame, ROOM_BELOW};
use super::error::{FigureError, count, finite, some};
use super::figure::Figure;
use super::levels::{ColourScale, Field, contour, fill};
use super::panel_layout::PanelLayout;
use super::plan::Plan;
use super::regions::mean;
use super::scale::{behind, number};

/// Values over the plane: one or more panels; the largest value of every panel is marked. Up to 5000 points of a panel,
/// a browser shows number, place and value of the point under the pointer.
///
/// ```
/// use figures::{ColourScales, Map, MapPanel, grid_faces};
/// let panel = |caption: &str, peak: f64| MapPanel {
///     caption: caption.into(),
///     points: vec![[0.0, 0.0], [0.0, 50.0], [50.0, 0.0], [50.0, 50.0], [100.0, 0.0], [100.0, 50.0]],
///     faces: grid_faces([3, 2]),
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
/// assert!(figure.svg.contains("<title>node 2 at (50, 0): 4082 MPa</title>"));
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

/// Values on one mesh.
#[derive(Debug, Clone, PartialEq)]
pub struct MapPanel {
    /// What distinguishes it from the other panels.
    pub caption: String,
    /// Coordinates along both axes.
    pub points: Vec<[f64; 2]>,
    /// Triangles and quadrilaterals between points, side by side.
    pub faces: Vec<Vec<usize>>,
    /// One value per point.
    pub values: Vec<f64>,
}

/// Room of a colour bar with its labels, points.
const ROOM_OF_BAR: f64 = 85.0;

impl Map {
    /// Draws it.
    ///
    /// # Errors
    /// [`FigureError`] without panels or faces; unless every face joins three or four different points, the points of a
    /// panel have an extent along both axes, there is a value per point, and all numbers are finite.
    pub fn figure(&self) -> Result<Figure, FigureError> {
        some(&self.name, "panels", self.panels.len())?;
        let plans = self.panels.iter().enumerate().map(|(index, panel)| panel.plan(&self.name, index));
        let plans = plans.collect::<Result<Vec<Plan<'_>>, FigureError>>()?;
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
            self.panels.iter().zip(&plans).map(|(panel, plan)| panel.captions(plan, &self.unit)).collect();
        let behind = if self.scales == ColourScales::Own { bar } else { 0.0 };
        let layout = PanelLayout::new(&plans, &captions, behind);
        let width = (layout.right + if behind > 0.0 { 0.0 } else { bar }).max(text_width(&self.title, TITLE) + 32.0);
        let mut canvas = Canvas::new(width, layout.foot + ROOM_BELOW + 8.0);
        canvas.text([16.0, 22.0], TITLE, &self.title);
        layout.write(&mut canvas, &captions, layout.foot + 14.0);
        for (index, (panel, plan)) in self.panels.iter().zip(&plans).enumerate() {
            let (frame, scale) = (layout.frames[index], &scales[index.min(scales.len() - 1)]);
            panel.draw(&mut canvas, (plan, frame), scale, self);
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
    fn plan(&self, figure: &str, index: usize) -> Result<Plan<'_>, FigureError> {
        let part = format!("panel {index}");
        let plan = Plan::new(figure, &part, &self.points, &self.faces)?;
        count(figure, &format!("values in {part}"), self.points.len(), self.values.len())?;
        finite(figure, &format!("{part}, value"), self.values.iter().copied())?;
        Ok(plan)
    }

    /// The first point with the largest value.
    fn largest(&self) -> usize {
        let larger = |best, point| if self.values[point] > self.values[best] { point } else { best };
        (0..self.values.len()).fold(0, larger)
    }

    fn captions(&self, plan: &Plan<'_>, unit: &str) -> [String; 2] {
        let largest = self.largest();
        let value = number(self.values[largest]);
        [self.caption.clone(), format!("largest {value}{} at {}", behind(unit), plan.position(largest))]
    }

    fn draw(&self, canvas: &mut Canvas, (plan, frame): (&Plan<'_>, Frame), scale: &ColourScale, map: &Map) {
        let places = plan.places(frame);
        let field = Field { places: &places, faces: &plan.faces, values: &self.values };
        fill(canvas, field, scale);
        if map.contours {
            contours(canvas, frame, field, scale);
        }
        plan.axes(canvas, frame, &places, &map.axes);
        ring(canvas, places[self.largest()]);
        let text = |point: usize| format!("{}{}", number(self.values[point]), behind(&map.unit));
        plan.name_points(canvas, &places, text);
    }
}

/// Lines at the ticks of the scale, each with one label, far from the others.
fn contours(canvas: &mut Canvas, frame: Frame, field: Field, scale: &ColourScale) {
    let shares: Vec<f64> = field.values.iter().map(|value| scale.axis.share(*value).unwrap_or(0.0)).collect();
    let field = Field { values: &shares, ..field };
    let mut labels: Vec<(Place, &str)> = Vec::new();
    for tick in &scale.axis.ticks {
        let pieces = contour(field, tick.share);
        canvas.lines(&pieces, Stroke::solid("#ffffff", 0.9));
        let middles = pieces.iter().map(|piece| mean(piece));
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

/// A ring seen on every colour.
fn ring(canvas: &mut Canvas, [x, y]: Place) {
    canvas.raw(&format!(
        "<g class=\"largest\" fill=\"none\"><circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"6\" stroke=\"#ffffff\" \
         stroke-width=\"3\"/><circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"6\" stroke=\"#000000\" stroke-width=\"1.2\"/></g>\n"
    ));
}
