//! The course of an optimization: every value, the best one so far, and what kind of step each evaluation was.

use super::canvas::{Canvas, LABEL, Place, Stroke, TITLE, text_width};
use super::chart::{Frame, Parts};
use super::colours::CURVES;
use super::error::{finite, some};
use super::scale::Axis;
use super::{Figure, FigureError};

/// Values over the number of the evaluation.
///
/// ```
/// use figures::{Convergence, Step};
/// let step = |kind: &str, value: f64, best: f64| Step { kind: kind.into(), value: Some(value), best };
/// let course = Convergence {
///     name: "convergence".into(),
///     title: "Course of the optimization".into(),
///     quantity: "Θ".into(),
///     unit: "MPa^{4}".into(),
///     steps: vec![step("start", 9e16, 9e16), step("serious", 2e16, 2e16), step("null", 3e16, 2e16)],
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
    /// What is seen.
    pub title: String,
    /// What the values are.
    pub quantity: String,
    /// Unit of the values.
    pub unit: String,
    /// The evaluations, in order.
    pub steps: Vec<Step>,
    /// Name and height of a horizontal line.
    pub reference: Option<(String, f64)>,
}

/// One evaluation.
#[derive(Debug, Clone, PartialEq)]
pub struct Step {
    /// What it was; every kind gets a mark of its own.
    pub kind: String,
    /// The value; none if there is none, which is marked at the foot.
    pub value: Option<f64>,
    /// The best value after it.
    pub best: f64,
}

/// Size of the frame, points.
const SIZE: [f64; 2] = [520.0, 300.0];
/// Ratio of the largest to the smallest value from which the axis is logarithmic.
const LOGARITHMIC_FROM: f64 = 8.0;
/// Half the size of a mark, points.
const MARK: f64 = 3.2;

impl Convergence {
    /// Draws it.
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
        let kinds = kinds(self.steps.iter().map(|step| step.kind.as_str()));
        let names = kinds.iter().map(|(kind, count)| format!("{kind} ({count})"));
        let names: Vec<String> = names.chain(["best so far".into()]).chain(self.reference_name()).collect();
        let legend = names.iter().fold(0.0_f64, |width, name| width.max(text_width(name, LABEL))) + 44.0;
        let width = (frame.left + SIZE[0] + 14.0 + legend).max(text_width(&self.title, TITLE) + 32.0);
        let mut canvas = Canvas::new(width, frame.top + SIZE[1] + 50.0);
        canvas.text([16.0, 22.0], TITLE, &self.title);
        frame.axes(&mut canvas, &across, &up, Parts { left: Some(60.0), below: Some(42.0), grid: true })?;
        let place = |number: f64, value: f64| {
            let share = [across.share(number).unwrap_or(0.0), up.share(value).unwrap_or(0.0).clamp(0.0, 1.0)];
            frame.place(share)
        };
        if let Some((_, value)) = self.reference {
            canvas.line(&[place(0.5, value), place(last + 0.5, value)], Stroke::dashed(CURVES[5], 1.2));
        }
        canvas.line(&self.stairs(place), Stroke::solid(CURVES[0], 1.6));
        for (number, step) in (1..).zip(&self.steps) {
            let at = place(f64::from(number), step.value.unwrap_or(up.ends()[0]));
            mark(&mut canvas, &step.kind, order(&kinds, &step.kind), at);
        }
        let mut row = [frame.left + SIZE[0] + 14.0, frame.top + 8.0];
        for (index, name) in names.iter().enumerate() {
            let [x, y] = row;
            match kinds.get(index) {
                Some((kind, _)) => mark(&mut canvas, &format!("legend {kind}"), index, [x + 11.0, y]),
                None if index == kinds.len() => canvas.line(&[[x, y], [x + 22.0, y]], Stroke::solid(CURVES[0], 1.6)),
                None => canvas.line(&[[x, y], [x + 22.0, y]], Stroke::dashed(CURVES[5], 1.2)),
            }
            canvas.text([x + 29.0, y + 0.34 * LABEL], LABEL, name);
            row[1] += 20.0;
        }
        Ok(Figure::new(&self.name, &self.title, canvas))
    }

    fn reference_name(&self) -> Option<String> {
        self.reference.as_ref().map(|(name, _)| name.clone())
    }

    fn axis(&self) -> Axis {
        let reference = self.reference.iter().map(|(_, value)| *value);
        let values: Vec<f64> =
            self.steps.iter().flat_map(|step| step.value.into_iter().chain([step.best])).chain(reference).collect();
        let lowest = values.iter().fold(f64::INFINITY, |lowest, value| lowest.min(*value));
        let highest = values.iter().fold(f64::NEG_INFINITY, |highest, value| highest.max(*value));
        if lowest > 0.0 && highest / lowest >= LOGARITHMIC_FROM {
            Axis::logarithmic(&self.quantity, &self.unit, values, 0.05, 8)
        } else {
            Axis::linear(&self.quantity, &self.unit, values, 0.05, 8)
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

/// Kinds in the order in which they appear, with their numbers.
pub(super) fn kinds<'a>(all: impl Iterator<Item = &'a str>) -> Vec<(String, usize)> {
    let mut kinds: Vec<(String, usize)> = Vec::new();
    for kind in all {
        match kinds.iter_mut().find(|(known, _)| known == kind) {
            Some((_, count)) => *count += 1,
            None => kinds.push((kind.to_owned(), 1)),
        }
    }
    kinds
}

fn order(kinds: &[(String, usize)], kind: &str) -> usize {
    kinds.iter().position(|(other, _)| other == kind).unwrap_or(0)
}

/// A mark in the shape and colour of the kind's place in the legend.
pub(super) fn mark(canvas: &mut Canvas, kind: &str, place_in_legend: usize, [x, y]: Place) {
    // Blue is the line's colour.
    let colour = CURVES[1 + place_in_legend % (CURVES.len() - 1)];
    let r = MARK;
    let shape = match place_in_legend % 4 {
        0 => format!("M{x:.1} {:.1}l{r} {r} -{r} {r} -{r} -{r}z", y - r),
        1 => format!("M{:.1} {y:.1}a{r} {r} 0 1 0 {d} 0a{r} {r} 0 1 0 -{d} 0z", x - r, d = 2.0 * r),
        2 => format!("M{:.1} {:.1}h{d}v{d}h-{d}z", x - 0.9 * r, y - 0.9 * r, d = 1.8 * r),
        _ => format!("M{x:.1} {:.1}l{r} {d} -{d} 0z", y - r, d = 2.0 * r),
    };
    let class = super::canvas::escaped(kind).replace('"', "&quot;");
    canvas.raw(&format!(
        "<path class=\"{class}\" d=\"{shape}\" fill=\"{colour}\" stroke=\"#ffffff\" stroke-width=\"0.6\"/>\n"
    ));
}

#[cfg(test)]
mod tests {
    use super::*;

    fn course(values: &[(&str, Option<f64>, f64)]) -> Convergence {
        let steps = values.iter().map(|&(kind, value, best)| Step { kind: kind.into(), value, best });
        Convergence {
            name: "c".into(),
            title: "t".into(),
            quantity: "Θ".into(),
            unit: String::new(),
            steps: steps.collect(),
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
        assert!(figure.png(1.0).expect("a picture").starts_with(b"\x89PNG"));
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
    fn degenerate_courses_are_drawn_and_impossible_ones_refused() {
        for value in [0.0, 1e-300, -4.0, 1e299] {
            course(&[("a", Some(value), value)]).figure().expect("one number");
        }
        assert!(matches!(course(&[]).figure(), Err(FigureError::Empty { .. })));
        assert!(matches!(course(&[("a", Some(f64::NAN), 1.0)]).figure(), Err(FigureError::Number { .. })));
    }
}
