//! Classes of the points of meshes in a plane, with arrows at the points: panels side by side.

use super::canvas::{Canvas, INK, LABEL, Place, Stroke, TITLE, text_width};
use super::chart::{Frame, ROOM_BELOW};
use super::error::{FigureError, below, count, finite, some};
use super::figure::Figure;
use super::panel_layout::PanelLayout;
use super::plan::{Plan, spread};
use super::regions::{borders, parts};
use super::scale::{behind, nice_below, number};

/// Every point is in one of a few classes, which have a colour each. Where there are arrows, their middles are at the
/// points, all on one scale; on fine meshes only some are drawn.
///
/// ```
/// use figures::{ClassPanel, Classes, grid_faces};
/// let classes = Classes {
///     name: "status".into(),
///     title: "Contact status".into(),
///     axes: ["x₁ (mm)".into(), "x₂ (mm)".into()],
///     classes: vec!["open".into(), "stick".into(), "slip".into()],
///     arrows: Some(("traction".into(), "MPa".into())),
///     panels: vec![ClassPanel {
///         caption: "start".into(),
///         points: vec![[0.0, 0.0], [0.0, 10.0], [10.0, 0.0], [10.0, 10.0]],
///         faces: grid_faces([2, 2]),
///         classes: vec![0, 1, 2, 2],
///         arrows: vec![[0.0, 0.0], [5.0, 0.0], [10.0, 0.0], [0.0, 10.0]],
///     }],
/// };
/// let figure = classes.figure()?;
/// assert!(figure.svg.contains("open 1, stick 1, slip 2"));
/// assert!(figure.svg.contains("<title>node 2 at (10, 0): slip, traction (10, 0) MPa</title>"));
/// # Ok::<(), figures::FigureError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Classes {
    /// Name of the figure, for files.
    pub name: String,
    /// Title above the figure; it states what is seen.
    pub title: String,
    /// Names and units of both axes.
    pub axes: [String; 2],
    /// Names of the classes, palest colour first.
    pub classes: Vec<String>,
    /// What the arrows are, and their unit; none: there are no arrows.
    pub arrows: Option<(String, String)>,
    /// The panels, from left to right.
    pub panels: Vec<ClassPanel>,
}

/// Classes on one mesh.
#[derive(Debug, Clone, PartialEq)]
pub struct ClassPanel {
    /// What distinguishes it from the other panels.
    pub caption: String,
    /// Coordinates along both axes.
    pub points: Vec<[f64; 2]>,
    /// Triangles and quadrilaterals between points, side by side.
    pub faces: Vec<Vec<usize>>,
    /// The class of every point.
    pub classes: Vec<usize>,
    /// The arrow of every point along both axes; as many as points where the figure has arrows.
    pub arrows: Vec<[f64; 2]>,
}

/// Colours of the classes; black arrows are seen on all.
pub(super) const COLOURS: [&str; 5] = ["#e9e9e9", "#8fbbe3", "#f2b277", "#9fd3a8", "#d3a6d9"];
/// Least distance of arrows along one axis or the other, points; a little less than a 16th of a panel's longer side.
const MIN_DISTANCE: f64 = 17.4;
/// Length of the longest arrow, in distances of arrows.
const LONGEST: f64 = 1.1;

impl Classes {
    /// Draws it.
    ///
    /// # Errors
    /// [`FigureError`] without panels, faces or classes; unless every face joins three or four different points, the
    /// points of a panel have an extent along both axes, there is a class per point that exists and an arrow per point
    /// if there are arrows, and all numbers are finite.
    pub fn figure(&self) -> Result<Figure, FigureError> {
        some(&self.name, "panels", self.panels.len())?;
        some(&self.name, "classes", self.classes.len())?;
        let plans = self.panels.iter().enumerate().map(|(index, panel)| self.plan(panel, index));
        let plans = plans.collect::<Result<Vec<Plan<'_>>, FigureError>>()?;
        let captions: Vec<[String; 2]> =
            self.panels.iter().map(|panel| [panel.caption.clone(), self.counted(panel)]).collect();
        let layout = PanelLayout::new(&plans, &captions, 0.0);
        let drawn = self.panels.iter().zip(&plans).zip(&layout.frames).map(Drawn::new).collect::<Vec<Drawn<'_>>>();
        let arrows = self.arrow_scale(&drawn);
        let names = self.classes.iter().map(|name| text_width(name, LABEL));
        let label = arrows.iter().map(|(_, _, label)| text_width(label, LABEL));
        let legend = names.chain(label).fold(0.0, f64::max) + 54.0;
        let width = (layout.right + legend).max(text_width(&self.title, TITLE) + 32.0);
        let mut canvas = Canvas::new(width, layout.foot + ROOM_BELOW + 8.0);
        canvas.text([16.0, 22.0], TITLE, &self.title);
        let end = layout.frames[0].top + 22.0 * self.classes.len() as f64 + 50.0;
        layout.write(&mut canvas, &captions, end);
        for drawn in &drawn {
            let points = arrows.as_ref().map_or(0.0, |(points, ..)| *points);
            self.draw(&mut canvas, drawn, points);
        }
        let (x, mut y) = (layout.right, layout.frames[0].top + 2.0);
        for (index, name) in self.classes.iter().enumerate() {
            canvas.rectangle([x, y], [16.0, 12.0], colour(index));
            canvas.outline(&[[x, y], [x + 16.0, y], [x + 16.0, y + 12.0], [x, y + 12.0]], Stroke::solid(INK, 0.6));
            canvas.text([x + 24.0, y + 10.0], LABEL, name);
            y += 22.0;
        }
        if let Some((points, value, label)) = arrows {
            canvas.arrow([[x, y + 14.0], [x + points * value, y + 14.0]], Stroke::solid(INK, 1.0));
            canvas.text([x, y + 34.0], LABEL, &label);
        }
        Ok(Figure::new(&self.name, &self.title, canvas))
    }

    fn plan<'a>(&self, panel: &'a ClassPanel, index: usize) -> Result<Plan<'a>, FigureError> {
        let (figure, part, points) = (&self.name, format!("panel {index}"), panel.points.len());
        let plan = Plan::new(figure, &part, &panel.points, &panel.faces)?;
        let arrows = if self.arrows.is_some() { points } else { 0 };
        count(figure, &format!("classes in {part}"), points, panel.classes.len())?;
        count(figure, &format!("arrows in {part}"), arrows, panel.arrows.len())?;
        below(figure, &format!("{part}, class of point"), &panel.classes, self.classes.len())?;
        for axis in 0..2 {
            finite(figure, &format!("{part}, arrow at point"), panel.arrows.iter().map(|arrow| arrow[axis]))?;
        }
        Ok(plan)
    }

    /// "open 4, stick 2"
    fn counted(&self, panel: &ClassPanel) -> String {
        let count = |class: usize| panel.classes.iter().filter(|other| **other == class).count();
        let parts = self.classes.iter().enumerate().map(|(class, name)| format!("{name} {}", count(class)));
        parts.collect::<Vec<_>>().join(", ")
    }

    /// Points per unit of the arrows, the value of the arrow in the legend and its label; none without arrows.
    fn arrow_scale(&self, drawn: &[Drawn<'_>]) -> Option<(f64, f64, String)> {
        let (quantity, unit) = self.arrows.as_ref()?;
        let lengths = self.panels.iter().flat_map(|panel| &panel.arrows).map(|[a, b]| a.hypot(*b));
        let largest = lengths.fold(0.0, f64::max);
        let longest = LONGEST * drawn.iter().map(Drawn::distance).fold(f64::INFINITY, f64::min);
        if largest == 0.0 {
            return Some((0.0, 0.0, format!("no {quantity}")));
        }
        let value = nice_below(largest);
        Some((longest / largest, value, format!("{quantity} {}{}", number(value), behind(unit))))
    }

    fn draw(&self, canvas: &mut Canvas, drawn: &Drawn<'_>, points: f64) {
        let Drawn { panel, plan, frame, places, arrows } = drawn;
        for class in 0..self.classes.len() {
            let parts = parts(&plan.faces, places).filter(|(point, _)| panel.classes[*point] == class);
            let borders = borders(parts.map(|(_, part)| part));
            canvas.area(colour(class), borders.iter().map(Vec::as_slice));
        }
        plan.axes(canvas, *frame, places, &self.axes);
        for &point in arrows {
            let ([x, y], Some([a, b])) = (places[point], panel.arrows.get(point)) else { continue };
            let [dx, dy] = [0.5 * points * a, -0.5 * points * b];
            // Shorter ones are no arrows any more.
            if dx.hypot(dy) > 0.35 {
                // Arrows at the edges are moved inwards: beyond the edges stand captions and labels.
                let x = inside(x, dx.abs(), [frame.left, frame.left + frame.width]);
                let y = inside(y, dy.abs(), [frame.top, frame.top + frame.height]);
                canvas.arrow([[x - dx, y - dy], [x + dx, y + dy]], Stroke::solid(INK, 0.9));
            }
        }
        let text = |point: usize| {
            let class = &self.classes[panel.classes[point]];
            self.arrows.as_ref().map_or_else(
                || class.clone(),
                |(quantity, unit)| {
                    let [a, b] = panel.arrows[point].map(number);
                    format!("{class}, {quantity} ({a}, {b}){}", behind(unit))
                },
            )
        };
        plan.name_points(canvas, places, text);
    }
}

/// The middle of a line of this half length, moved so that the line lies between two ends; the middle between them if
/// it is longer.
fn inside(middle: f64, half: f64, [low, high]: [f64; 2]) -> f64 {
    if high - low < 2.0 * half { 0.5 * (low + high) } else { middle.clamp(low + half, high - half) }
}

fn colour(class: usize) -> &'static str {
    COLOURS[class % COLOURS.len()]
}

/// A panel with the places of its points.
struct Drawn<'a> {
    panel: &'a ClassPanel,
    plan: &'a Plan<'a>,
    frame: Frame,
    places: Vec<Place>,
    /// The points at which arrows are drawn.
    arrows: Vec<usize>,
}

impl<'a> Drawn<'a> {
    fn new(((panel, plan), &frame): ((&'a ClassPanel, &'a Plan<'a>), &Frame)) -> Self {
        let places = plan.places(frame);
        Self { panel, plan, frame, arrows: spread(&places, MIN_DISTANCE), places }
    }

    /// Distance of arrows on average.
    fn distance(&self) -> f64 {
        (self.frame.width * self.frame.height / self.arrows.len() as f64).sqrt()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::grid_faces;

    fn classes(arrows: bool) -> Classes {
        let nodes = 40 * 3;
        let panel = ClassPanel {
            caption: "c".into(),
            points: (0..nodes).map(|node| [(node / 3) as f64, (node % 3) as f64]).collect(),
            faces: grid_faces([40, 3]),
            classes: (0..nodes).map(|node| node % 2).collect(),
            arrows: if arrows { vec![[1.0, 2.0]; nodes] } else { vec![] },
        };
        Classes {
            name: "s".into(),
            title: "t".into(),
            axes: ["x".into(), "y".into()],
            classes: vec!["open".into(), "closed".into()],
            arrows: arrows.then(|| ("traction".into(), "MPa".into())),
            panels: vec![panel],
        }
    }

    #[test]
    fn arrows_are_thinned_on_fine_grids_and_absent_where_there_are_none() {
        let heads = |figure: &Figure| figure.svg.matches(&format!("fill=\"{INK}\" d=\"M")).count();
        let (with, without) = (classes(true).figure().expect("numbers"), classes(false).figure().expect("numbers"));
        // Every third point along the longer side: 14 × 3, and the one of the legend.
        assert_eq!((heads(&with), heads(&without)), (43, 0));
        assert!(with.svg.contains("traction 2 MPa<") && !without.svg.contains("MPa"));
        assert_eq!(without.svg.matches("<title>node").count(), 120);
    }

    #[test]
    fn arrows_stay_inside_their_panel() {
        let ends = [10.0, 20.0];
        for (middle, half, expected) in [(10.0, 2.0, 12.0), (15.0, 2.0, 15.0), (20.0, 2.0, 18.0), (10.0, 6.0, 15.0)] {
            assert_eq!(inside(middle, half, ends), expected, "{middle}");
        }
    }

    #[test]
    fn classes_that_do_not_exist_and_arrows_that_are_missing_are_refused() {
        let mut wrong = classes(true);
        wrong.panels[0].classes[7] = 2;
        assert!(matches!(wrong.figure(), Err(FigureError::Number { index: 7, .. })));
        let mut wrong = classes(true);
        wrong.panels[0].arrows.pop();
        assert!(matches!(wrong.figure(), Err(FigureError::Count { .. })));
        let mut wrong = classes(false);
        wrong.panels[0].points.iter_mut().for_each(|point| point[1] = 0.0);
        assert!(matches!(wrong.figure(), Err(FigureError::Number { .. })));
    }
}
