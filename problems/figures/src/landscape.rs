//! A function of two variables as filled levels, with the points that a method visited.

use super::canvas::{Canvas, INK, Stroke, TITLE, text_width};
use super::chart::ROOM_LEFT;
use super::chart::{Frame, ROOM_BELOW};
use super::colours::CURVES;
use super::error::{FigureError, count, finite, positive, some};
use super::figure::Figure;
use super::grids::grid_faces;
use super::levels::{ColourScale, Field, contour, fill};
use super::marks::{self, Sign, kinds, legend_width, rows};
use super::plan::Plan;

/// Values over a rectangle, lines on it, and a path.
///
/// ```
/// use figures::{Landscape, Visit};
/// let visit = |kind: &str, place| Visit { kind: kind.into(), place };
/// let landscape = Landscape {
///     name: "landscape".into(),
///     title: "Bowl".into(),
///     quantity: "value".into(),
///     axes: ["x".into(), "y".into()],
///     counts: [2, 2],
///     origin: [0.0, 0.0],
///     size: [1.0, 1.0],
///     values: vec![0.0, 1.0, 1.0, 2.0],
///     lines: Some(("kink".into(), vec![[[0.0, 1.0], [1.0, 0.0]]])),
///     path: vec![visit("start", [1.0, 1.0]), visit("serious", [0.2, 0.1])],
///     goal: Some(("minimiser".into(), [0.0, 0.0])),
/// };
/// assert_eq!(landscape.figure()?.svg.matches("class=\"serious\"").count(), 1);
/// # Ok::<(), figures::FigureError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Landscape {
    /// Name of the figure, for files.
    pub name: String,
    /// Title above the figure; it states what is seen.
    pub title: String,
    /// What the values are.
    pub quantity: String,
    /// Names and units of both axes.
    pub axes: [String; 2],
    /// Nodes n₁, n₂ along both axes, at least 2.
    pub counts: [usize; 2],
    /// Position of the first node.
    pub origin: [f64; 2],
    /// Lengths between the first and the last node along both axes, > 0.
    pub size: [f64; 2],
    /// One value per node, index i·n₂ + j with i along the first axis.
    pub values: Vec<f64>,
    /// Name and ends of straight lines, for example of kinks.
    pub lines: Option<(String, Vec<[[f64; 2]; 2]>)>,
    /// The points visited, in order.
    pub path: Vec<Visit>,
    /// Name and place of a point that is marked by a cross.
    pub goal: Option<(String, [f64; 2])>,
}

/// A point that was visited.
#[derive(Debug, Clone, PartialEq)]
pub struct Visit {
    /// What it was; every kind gets a mark of its own.
    pub kind: String,
    /// Coordinates in the units of the axes.
    pub place: [f64; 2],
}

/// Longer side of the frame, points.
const SIDE: f64 = 380.0;

impl Landscape {
    /// Draws it; what lies outside the rectangle is cut off.
    ///
    /// # Errors
    /// [`FigureError`] unless there are at least 2 × 2 nodes, a value per node, sides of positive length, and all
    /// numbers are finite.
    pub fn figure(&self) -> Result<Figure, FigureError> {
        self.check()?;
        let [n1, n2] = self.counts;
        let along = |axis: usize, index: usize, nodes: usize| {
            self.origin[axis] + self.size[axis] * index as f64 / (nodes - 1).max(1) as f64
        };
        let points: Vec<[f64; 2]> =
            (0..n1 * n2).map(|node| [along(0, node / n2, n1), along(1, node % n2, n2)]).collect();
        let plan = Plan::new(&self.name, "ground", &points, &grid_faces(self.counts))?;
        let scale = ColourScale::new(&self.quantity, "", self.values.iter().copied());
        let longest = self.size[0].max(self.size[1]);
        let [width, height] = self.size.map(|side| SIDE * (side / longest).max(0.25));
        let frame = Frame { left: 16.0 + ROOM_LEFT, top: 56.0, width, height };
        let kinds = kinds(self.path.iter().map(|visit| visit.kind.as_str()));
        let mut legend = rows(&kinds);
        legend.extend(self.goal.iter().map(|(name, _)| (Sign::Cross, name.clone())));
        legend.extend(self.lines.iter().map(|(name, _)| (Sign::Line(Stroke::dashed(INK, 1.0)), name.clone())));
        let right = frame.left + width + 110.0;
        let mut canvas = Canvas::new(
            (right + legend_width(&legend)).max(text_width(&self.title, TITLE) + 32.0),
            frame.top + height + ROOM_BELOW + 10.0,
        );
        canvas.text([16.0, 22.0], TITLE, &self.title);
        self.ground(&mut canvas, frame, &plan, &scale);
        canvas.clipped("inside", [frame.left, frame.top], [width, height], |canvas| self.route(canvas, &frame, &kinds));
        scale.bar(&mut canvas, [frame.left + width + 24.0, frame.top], height);
        marks::legend(&mut canvas, [right, frame.top + 8.0], &legend);
        Ok(Figure::new(&self.name, &self.title, canvas))
    }

    fn check(&self) -> Result<(), FigureError> {
        let figure = &self.name;
        some(figure, "values", self.values.len())?;
        count(figure, "values", self.counts[0].saturating_mul(self.counts[1]), self.values.len())?;
        finite(figure, "value", self.values.iter().copied())?;
        positive(figure, "side", self.size)?;
        finite(figure, "origin", self.origin)?;
        finite(figure, "coordinate of the path", self.path.iter().flat_map(|visit| visit.place))?;
        finite(figure, "coordinate of the goal", self.goal.iter().flat_map(|goal| goal.1))?;
        let lines = self.lines.iter().flat_map(|lines| lines.1.iter().flatten().flatten().copied());
        finite(figure, "coordinate of a line", lines)
    }

    /// Levels, contour lines and axes.
    fn ground(&self, canvas: &mut Canvas, frame: Frame, plan: &Plan<'_>, scale: &ColourScale) {
        let places = plan.places(frame);
        let field = Field { places: &places, faces: &plan.faces, values: &self.values };
        fill(canvas, field, scale);
        plan.axes(canvas, frame, &places, &self.axes);
        let [low, high] = scale.axis.ends();
        for level in scale.levels() {
            canvas.lines(&contour(field, low + level * (high - low)), Stroke::solid("#ffffff", 0.3));
        }
    }

    /// Lines, path, marks and goal.
    fn route(&self, canvas: &mut Canvas, frame: &Frame, kinds: &[(&str, usize)]) {
        let place =
            |at: [f64; 2]| frame.place(std::array::from_fn(|axis| (at[axis] - self.origin[axis]) / self.size[axis]));
        for ends in self.lines.iter().flat_map(|lines| &lines.1) {
            canvas.line(&ends.map(place), Stroke::dashed(INK, 1.0));
        }
        let places: Vec<_> = self.path.iter().map(|visit| place(visit.place)).collect();
        if places.len() > 1 {
            canvas.line(&places, Stroke::solid("#ffffff", 2.2));
            canvas.line(&places, Stroke::solid(CURVES[5], 1.0));
        }
        for (visit, at) in self.path.iter().zip(places) {
            marks::step(canvas, kinds, &visit.kind, at);
        }
        if let Some((_, goal)) = self.goal {
            marks::cross(canvas, place(goal));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn landscape() -> Landscape {
        let values = (0..30).map(|node| (f64::from(node / 6) - 2.0).abs() + f64::from(node % 6)).collect();
        let path = [("start", [0.0, 5.0]), ("null", [4.0, 4.0]), ("serious", [2.0, 1.0]), ("null", [9.0, 9.0])];
        Landscape {
            name: "l".into(),
            title: "t".into(),
            quantity: "q".into(),
            axes: ["x".into(), "y".into()],
            counts: [5, 6],
            origin: [0.0; 2],
            size: [4.0, 5.0],
            values,
            lines: Some(("kink".into(), vec![[[2.0, 0.0], [2.0, 5.0]]])),
            path: path.into_iter().map(|(kind, place)| Visit { kind: kind.into(), place }).collect(),
            goal: Some(("minimiser".into(), [2.0, 0.0])),
        }
    }

    #[test]
    fn every_visit_is_marked_and_every_name_explained() {
        let figure = landscape().figure().expect("numbers");
        assert_eq!(figure.svg.matches("class=\"null\"").count(), 2);
        for name in ["start (1)", "null (2)", "serious (1)", "minimiser", "kink"] {
            assert!(figure.svg.contains(&format!(">{name}<")), "{name}");
        }
        assert_eq!(figure, landscape().figure().expect("numbers"));
    }

    #[test]
    fn bare_ground_is_drawn_and_impossible_numbers_are_refused() {
        let bare = Landscape { lines: None, path: vec![], goal: None, values: vec![3.0; 30], ..landscape() };
        bare.figure().expect("a flat landscape");
        let lost = Landscape { goal: Some(("g".into(), [f64::NAN, 0.0])), ..landscape() };
        assert!(matches!(lost.figure(), Err(FigureError::Number { .. })));
        assert!(matches!(Landscape { counts: [5, 5], ..landscape() }.figure(), Err(FigureError::Count { .. })));
        assert!(matches!(Landscape { size: [0.0, 1.0], ..landscape() }.figure(), Err(FigureError::Number { .. })));
    }
}
