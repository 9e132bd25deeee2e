//! The course of an optimization: every value, the best one so far, and what kind of step each evaluation was.

use super::canvas::{Canvas, INK, Place, Stroke, TITLE, TITLE_ROOM, text_width};
use super::chart::{Frame, Parts, ROOM_BELOW};
use super::colours::CURVES;
use super::error::{FigureError, finite, some};
use super::figure::Figure;
use super::marks::{self, Sign, kinds, legend_width, mark_colour, rows};
use super::scale::{Axis, extent, number as number_text};

/// Values over the number of the evaluation.
///
/// ```
/// use figures::{Convergence, Step};
/// let step = |kind: &str, value: f64, best: f64| {
///     Step { kind: kind.into(), origin: "cuts".into(), value: Some(value), best }
/// };
/// let course = Convergence {
///     name: "convergence".into(),
///     title: "Course of the optimization".into(),
///     quantity: "Θ".into(),
///     unit: "MPa^{4}".into(),
///     steps: vec![step("start", 9e16, 9e16), step("serious", 2e16, 2e16), step("null", 3e16, 2e16)],
///     course: "best so far".into(),
///     reference: Some(("lower bound".into(), 1.3e16)),
/// };
/// let figure = course.figure()?;
/// assert_eq!(figure.svg.matches("class=\"serious\"").count(), 1);
/// # Ok::<(), figures::FigureError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Convergence {
    /// Name of the figure, for files.
    pub name: String,
    /// Title above the figure; it states what is seen.
    pub title: String,
    /// What the values are.
    pub quantity: String,
    /// Unit of the values.
    pub unit: String,
    /// The evaluations, in order.
    pub steps: Vec<Step>,
    /// What the line through the best values is called.
    pub course: String,
    /// Name and height of a horizontal line.
    pub reference: Option<(String, f64)>,
}

/// An evaluation of an optimization.
#[derive(Debug, Clone, PartialEq)]
pub struct Step {
    /// What it was; every kind gets a mark of its own.
    pub kind: String,
    /// Who proposed the point; every proposer gets a colour of its own. Empty where nobody is to be told apart.
    pub origin: String,
    /// The value; none for a failed evaluation, whose mark stands at the foot of the frame.
    pub value: Option<f64>,
    /// The best value after it.
    pub best: f64,
}

/// Size of the frame, points.
const SIZE: [f64; 2] = [460.0, 300.0];
/// Ratio of the largest to the smallest value from which the axis is logarithmic.
const LOGARITHMIC_FROM: f64 = 8.0;
/// Size of the values at the upper side of the frame, points.
const SMALL: f64 = 10.0;
/// Rows for the values of marks at the upper side of the frame.
const MAX_ROWS: usize = 3;

impl Convergence {
    /// Draws it. The axis holds the best values and all values below the first of them: larger ones have a mark at the
    /// upper side of the frame, and their values are written there as long as there is room.
    ///
    /// # Errors
    /// [`FigureError`] without evaluations, or for numbers that are not finite.
    pub fn figure(&self) -> Result<Figure, FigureError> {
        some(&self.name, "evaluations", self.steps.len())?;
        finite(&self.name, "value", self.steps.iter().filter_map(|step| step.value))?;
        finite(&self.name, "best value", self.steps.iter().map(|step| step.best))?;
        finite(&self.name, "reference", self.reference.iter().map(|(_, value)| *value))?;
        let up = self.axis();
        let last = self.steps.len() as f64;
        // Half an evaluation of room at both ends keeps the marks inside.
        let across = Axis::linear("evaluation", "", [0.5, last + 0.5], 0.0, 8);
        let frame = Frame { left: 76.0, top: 40.0, width: SIZE[0], height: SIZE[1] };
        let course = Stroke::solid(CURVES[0], 2.0);
        let level = Stroke::dashed(CURVES[5], 1.2);
        let legend = self.legend(course, level);
        let right = frame.left + SIZE[0] + 14.0;
        let width = (right + legend_width(&legend)).max(text_width(&self.title, TITLE) + 32.0);
        let mut canvas = Canvas::new(width, frame.top + SIZE[1] + ROOM_BELOW + 8.0);
        canvas.text([16.0, 22.0], TITLE, &self.title);
        frame.axes(&mut canvas, &across, &up, Parts { left: 60.0, grid: true });
        let place = |number: f64, value: f64| {
            let share = [across.share(number).unwrap_or(0.0), up.share(value).unwrap_or(0.0).clamp(0.0, 1.0)];
            frame.place(share)
        };
        if let Some((_, value)) = self.reference {
            canvas.line(&[place(0.5, value), place(last + 0.5, value)], level);
        }
        // The best values stand before everything else.
        let is_best = |step: &Step| step.value == Some(step.best);
        let numbered = || (1_u32..).zip(&self.steps);
        for (number, step) in numbered().filter(|(_, step)| !is_best(step) && !self.is_clipped(step)) {
            self.mark(&mut canvas, (number, step), place(f64::from(number), step.value.unwrap_or(up.ends()[0])));
        }
        self.clipped(&mut canvas, frame, |number| place(number, up.ends()[1])[0]);
        canvas.line(&self.stairs(place), course);
        for (number, step) in numbered().filter(|(_, step)| is_best(step)) {
            self.mark(&mut canvas, (number, step), place(f64::from(number), step.best));
        }
        canvas.part([0.0, TITLE_ROOM], [right, canvas.height]);
        canvas.part([right, TITLE_ROOM], [canvas.width, frame.top + 8.0 + 21.0 * legend.len() as f64]);
        marks::legend(&mut canvas, [right, frame.top + 8.0], &legend);
        Ok(Figure::new(&self.name, &self.title, canvas))
    }

    fn kinds(&self) -> Vec<(&str, usize)> {
        kinds(self.steps.iter().map(|step| step.kind.as_str()))
    }

    fn origins(&self) -> Vec<(&str, usize)> {
        kinds(self.steps.iter().map(|step| step.origin.as_str()).filter(|origin| !origin.is_empty()))
    }

    fn legend<'a>(&'a self, course: Stroke<'a>, level: Stroke<'a>) -> Vec<(Sign<'a>, String)> {
        let mut legend = vec![(Sign::Line(course), self.course.clone())];
        legend.extend(self.reference.iter().map(|(name, _)| (Sign::Line(level), name.clone())));
        let origins = self.origins();
        if origins.is_empty() {
            legend.extend(rows(&self.kinds()));
            return legend;
        }
        let named = |(name, count): &(&str, usize)| format!("{name} ({count})");
        let shapes = self.kinds().into_iter().enumerate();
        legend.extend(shapes.map(|(index, kind)| (Sign::Shape(kind.0, index), named(&kind))));
        let colours = origins.iter().enumerate();
        legend.extend(
            colours.map(|(index, origin)| (Sign::Swatch(mark_colour(index)), format!("origin: {}", named(origin)))),
        );
        legend
    }

    /// The mark of an evaluation: shape by kind, colour by proposer.
    fn mark(&self, canvas: &mut Canvas, (number, step): (u32, &Step), at: Place) {
        let (kinds, origins) = (self.kinds(), self.origins());
        let shape = marks::number(&kinds, &step.kind);
        let colour = if origins.is_empty() { shape } else { marks::number(&origins, &step.origin) };
        let value =
            step.value.map_or_else(|| "no value".to_owned(), |value| format!("{} = {value:.4e}", self.quantity));
        let by = if step.origin.is_empty() { String::new() } else { format!(", {}", step.origin) };
        let text = format!("evaluation {number}: {}{by}, {value}", step.kind);
        marks::mark(canvas, &step.kind, shape, mark_colour(colour), at, &text);
    }

    /// Whether a value lies above the first, and so the largest, of the best values.
    fn is_clipped(&self, step: &Step) -> bool {
        let largest = self.steps.iter().map(|step| step.best).fold(f64::NEG_INFINITY, f64::max);
        step.value.is_some_and(|value| value > largest)
    }

    /// Marks with arrows at the upper side of the frame, with the values beside them.
    fn clipped(&self, canvas: &mut Canvas, frame: Frame, across: impl Fn(f64) -> f64) {
        let mut ends = [f64::NEG_INFINITY; MAX_ROWS];
        for (number, step) in (1_u32..).zip(&self.steps).filter(|(_, step)| self.is_clipped(step)) {
            let x = across(f64::from(number));
            canvas.arrow([[x, frame.top + 14.0], [x, frame.top + 1.0]], Stroke::solid(INK, 0.9));
            self.mark(canvas, (number, step), [x, frame.top + 15.0]);
            let label = number_text(step.value.unwrap_or(f64::NAN));
            let room = text_width(&label, SMALL);
            // Beside the frame's right side, the value stands at the left of its mark.
            let left = if x + 7.0 + room > frame.left + frame.width { x - 7.0 - room } else { x + 7.0 };
            if let Some(row) = (0..MAX_ROWS).find(|row| ends[*row] < left) {
                ends[row] = left + room + 6.0;
                canvas.text([left, frame.top + 19.0 + 13.0 * row as f64], SMALL, &label);
            }
        }
    }

    fn axis(&self) -> Axis {
        let reference = self.reference.iter().map(|(_, value)| *value);
        let shown = self.steps.iter().filter(|step| !self.is_clipped(step)).filter_map(|step| step.value);
        let values: Vec<f64> = shown.chain(self.steps.iter().map(|step| step.best)).chain(reference).collect();
        // Room for the marks of what lies above.
        let room = if self.steps.iter().any(|step| self.is_clipped(step)) { 0.2 } else { 0.05 };
        let logarithmic = |(low, high): (f64, f64)| low > 0.0 && high / low >= LOGARITHMIC_FROM;
        if extent(values.iter().copied()).is_some_and(logarithmic) {
            Axis::logarithmic(&self.quantity, &self.unit, values, room, 8)
        } else {
            Axis::linear(&self.quantity, &self.unit, values, room, 8)
        }
    }

    /// The best value so far, constant between evaluations.
    fn stairs(&self, place: impl Fn(f64, f64) -> Place) -> Vec<Place> {
        let mut places = Vec::new();
        let mut before = None;
        for (number, step) in (1..).zip(&self.steps) {
            let number = f64::from(number);
            if let Some(best) = before.filter(|best| *best != step.best) {
                places.push(place(number, best));
            }
            places.push(place(number, step.best));
            before = Some(step.best);
        }
        if let Some(best) = before {
            places.push(place(self.steps.len() as f64 + 0.5, best));
        }
        places
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn course(values: &[(&str, Option<f64>, f64)]) -> Convergence {
        let steps =
            values.iter().map(|&(kind, value, best)| Step { kind: kind.into(), origin: String::new(), value, best });
        Convergence {
            name: "c".into(),
            title: "t".into(),
            quantity: "Θ".into(),
            unit: String::new(),
            steps: steps.collect(),
            course: "best so far".into(),
            reference: None,
        }
    }

    #[test]
    fn every_evaluation_has_a_mark_and_every_kind_a_line_in_the_legend() {
        let values =
            [("start", Some(9.0), 9.0), ("null", Some(11.0), 9.0), ("failed", None, 9.0), ("null", Some(10.0), 9.0)];
        let mut course = course(&values);
        course.reference = Some(("bound".into(), 1.0));
        let figure = course.figure().expect("numbers");
        assert_eq!(figure.svg.matches("class=\"null\"").count(), 2);
        assert_eq!(figure.svg.matches("class=\"legend ").count(), 3);
        // One family with its fallback for all text.
        assert_eq!(figure.svg.matches("font-family").count(), 1);
        assert!(figure.svg.contains("null (2)") && figure.svg.contains(">bound<"));
        assert_eq!(figure, course.figure().expect("numbers"));
    }

    #[test]
    fn the_axis_follows_the_range_and_the_stairs_the_best_value() {
        // The middle of a logarithmic axis is the geometric mean.
        let middle = |low: f64, high: f64, value: f64| {
            let share = course(&[("a", Some(low), low), ("b", Some(high), high)]).axis().share(value);
            (share.expect("a place") - 0.5).abs() < 1e-9
        };
        assert!(middle(1e16, 1e18, 1e17) && middle(-100.0, -1.0, -50.5) && middle(1.0, 2.0, 1.5));
        let stairs = course(&[("a", None, 3.0), ("b", None, 3.0), ("c", None, 1.0)]).stairs(|x, y| [x, y]);
        assert_eq!(stairs, [[1.0, 3.0], [2.0, 3.0], [3.0, 3.0], [3.0, 1.0], [3.5, 1.0]]);
    }

    #[test]
    fn one_bad_step_does_not_stretch_the_axis_and_its_value_is_said() {
        let mut bad = course(&[("start", Some(9.0), 9.0), ("null", Some(4e9), 9.0), ("serious", Some(5.0), 5.0)]);
        let good = course(&[("start", Some(9.0), 9.0), ("serious", Some(5.0), 5.0)]);
        assert!(bad.axis().ends()[1] < 11.0 && good.axis().ends()[1] < bad.axis().ends()[1]);
        assert!(bad.figure().expect("numbers").svg.contains(">4.000·10<tspan"));
        for (step, origin) in bad.steps.iter_mut().zip(["given", "cuts", "cuts"]) {
            step.origin = origin.into();
        }
        let svg = bad.figure().expect("numbers").svg;
        assert!(
            svg.contains("origin: cuts (2)") && svg.contains("<title>evaluation 2: null, cuts, Θ = 4.0000e9</title>")
        );
    }

    #[test]
    fn degenerate_courses_are_drawn_and_impossible_ones_refused() {
        for value in [0.0, 1e-300, -4.0, 1e299] {
            course(&[("a", Some(value), value)]).figure().expect("one number");
        }
        assert!(matches!(course(&[]).figure(), Err(FigureError::Empty { .. })));
        assert!(matches!(course(&[("a", Some(f64::NAN), 1.0)]).figure(), Err(FigureError::Number { .. })));
    }
}
