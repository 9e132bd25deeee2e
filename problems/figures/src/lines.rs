//! Curves over a linear axis as panels in a row or in several, all with the same vertical axis.

use super::canvas::{Canvas, LABEL, Place, Stroke, TITLE, text_width};
use super::chart::{Frame, Parts, ROOM_BELOW};
use super::colours::curve;
use super::error::{FigureError, finite, some};
use super::figure::Figure;
use super::marks::{self, Sign, legend_width};
use super::scale::Axis;

/// Curves over places, for example values along straight lines.
///
/// ```
/// use figures::{Curve, LinePanel, Lines};
/// let curve = |name: &str, peak: f64| Curve { name: name.into(), points: vec![(0.0, 0.0), (5.0, peak), (10.0, 0.0)] };
/// let lines = Lines {
///     name: "cuts".into(),
///     title: "Pressure along lines".into(),
///     quantity: "pressure".into(),
///     unit: "MPa".into(),
///     columns: 2,
///     panels: vec![LinePanel {
///         caption: "x₂ = 5 mm".into(),
///         across: "x₁ (mm)".into(),
///         curves: vec![curve("start", 9.0), curve("optimum", 4.0)],
///     }],
/// };
/// assert_eq!(lines.figure()?.svg.matches("class=\"point\"").count(), 6);
/// # Ok::<(), figures::FigureError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Lines {
    /// Name of the figure, for files.
    pub name: String,
    /// Title above the figure; it states what is seen.
    pub title: String,
    /// What the values are.
    pub quantity: String,
    /// Unit of the values.
    pub unit: String,
    /// Panels per row, at least 1.
    pub columns: usize,
    /// The panels, row by row.
    pub panels: Vec<LinePanel>,
}

/// Some curves over one axis.
#[derive(Debug, Clone, PartialEq)]
pub struct LinePanel {
    /// What distinguishes it from the other panels.
    pub caption: String,
    /// Name and unit of the horizontal axis.
    pub across: String,
    /// The curves; those of one name have the same colour in all panels.
    pub curves: Vec<Curve>,
}

/// Points that are joined by lines.
#[derive(Debug, Clone, PartialEq)]
pub struct Curve {
    /// Name in the legend.
    pub name: String,
    /// (place, value).
    pub points: Vec<(f64, f64)>,
}

/// Size of a frame, points.
const SIZE: [f64; 2] = [300.0, 180.0];
/// Room at the left of a frame, points.
const ROOM_LEFT: f64 = 70.0;
/// Most points of a curve that are marked.
const MAX_MARKED: usize = 60;

impl Lines {
    /// Draws it.
    ///
    /// # Errors
    /// [`FigureError`] without columns, panels or curves, or for numbers that are not finite.
    pub fn figure(&self) -> Result<Figure, FigureError> {
        some(&self.name, "columns", self.columns)?;
        some(&self.name, "panels", self.panels.len())?;
        let points = || self.curves().flat_map(|curve| curve.points.iter().copied());
        some(&self.name, "points", points().count())?;
        finite(&self.name, "coordinate", points().flat_map(|(x, y)| [x, y]))?;
        let mut names: Vec<&str> = Vec::new();
        for curve in self.curves() {
            if !names.contains(&curve.name.as_str()) {
                names.push(&curve.name);
            }
        }
        // Values are compared with zero.
        let up = Axis::linear(&self.quantity, &self.unit, points().map(|point| point.1).chain([0.0]), 0.04, 5);
        let columns = self.columns.min(self.panels.len());
        let caption = self.panels.iter().fold(SIZE[0], |width, panel| width.max(text_width(&panel.caption, LABEL)));
        let (wide, tall) = (ROOM_LEFT + caption + 16.0, SIZE[1] + ROOM_BELOW + 34.0);
        let legend: Vec<(Sign, String)> = names
            .iter()
            .enumerate()
            .map(|(index, name)| (Sign::Line(Stroke::solid(curve(index), 1.6)), (*name).to_owned()))
            .collect();
        let right = 8.0 + columns as f64 * wide;
        let width = (right + legend_width(&legend)).max(text_width(&self.title, TITLE) + 32.0);
        let rows = self.panels.len().div_ceil(columns);
        let legend_foot = 70.0 + 21.0 * legend.len() as f64;
        let mut canvas = Canvas::new(width, (34.0 + rows as f64 * tall).max(legend_foot));
        canvas.text([16.0, 22.0], TITLE, &self.title);
        for (index, panel) in self.panels.iter().enumerate() {
            let left = 8.0 + ROOM_LEFT + (index % columns) as f64 * wide;
            let top = 62.0 + (index / columns) as f64 * tall;
            canvas.text([left, top - 9.0], LABEL, &panel.caption);
            canvas.part([left - ROOM_LEFT, top - 26.0], [left - ROOM_LEFT + wide, top - 26.0 + tall]);
            panel.draw(&mut canvas, Frame { left, top, width: SIZE[0], height: SIZE[1] }, &up, &names);
        }
        canvas.part([right, 50.0], [canvas.width, 60.0 + 21.0 * legend.len() as f64]);
        marks::legend(&mut canvas, [right, 70.0], &legend);
        Ok(Figure::new(&self.name, &self.title, canvas))
    }

    fn curves(&self) -> impl Iterator<Item = &Curve> {
        self.panels.iter().flat_map(|panel| &panel.curves)
    }
}

impl LinePanel {
    fn draw(&self, canvas: &mut Canvas, frame: Frame, up: &Axis, names: &[&str]) {
        let places = self.curves.iter().flat_map(|curve| curve.points.iter().map(|point| point.0));
        let across = Axis::linear(&self.across, "", places, 0.02, 6);
        frame.axes(canvas, &across, up, Parts { left: ROOM_LEFT - 8.0, grid: true });
        for line in &self.curves {
            let index = names.iter().position(|name| *name == line.name).unwrap_or(0);
            let place = |(x, y): &(f64, f64)| Some(frame.place([across.share(*x)?, up.share(*y)?]));
            let places: Vec<Place> = line.points.iter().filter_map(place).collect();
            canvas.line(&places, Stroke::solid(curve(index), 1.6));
            if places.len() <= MAX_MARKED {
                places.into_iter().for_each(|at| marks::point(canvas, "point", index, at));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::colours::CURVES;

    fn lines(names: [&str; 3]) -> Lines {
        let curve = |name: &str| Curve { name: name.into(), points: vec![(0.0, 1.0), (1.0, 4.0)] };
        let panel = |name: &str| LinePanel { caption: "c".into(), across: "x".into(), curves: vec![curve(name)] };
        Lines {
            name: "l".into(),
            title: "t".into(),
            quantity: "q".into(),
            unit: String::new(),
            columns: 2,
            panels: names.map(panel).into(),
        }
    }

    #[test]
    fn a_name_has_one_colour_and_one_row_of_the_legend() {
        let figure = lines(["start", "optimum", "start"]).figure().expect("numbers");
        assert_eq!(figure.svg.matches(">start<").count(), 1);
        // Two panels and the legend.
        assert_eq!(figure.svg.matches(&format!("stroke=\"{}\"", CURVES[0])).count(), 3);
        assert_eq!(figure.svg.matches(&format!("stroke=\"{}\"", CURVES[1])).count(), 2);
    }

    #[test]
    fn nothing_and_numbers_without_end_are_refused() {
        let mut none = lines(["a", "b", "c"]);
        none.panels.iter_mut().for_each(|panel| panel.curves.clear());
        assert!(matches!(none.figure(), Err(FigureError::Empty { .. })));
        let mut infinite = lines(["a", "b", "c"]);
        infinite.panels[0].curves[0].points[1].1 = f64::INFINITY;
        assert!(matches!(infinite.figure(), Err(FigureError::Number { .. })));
        assert!(matches!(Lines { columns: 0, ..lines(["a", "b", "c"]) }.figure(), Err(FigureError::Empty { .. })));
    }
}
