//! Curves over two logarithmic axes, with straight lines of given slopes.

use super::canvas::{Canvas, LABEL, Place, Stroke, TITLE, text_width};
use super::chart::{Frame, Parts};
use super::colours::CURVES;
use super::error::finite;
use super::scale::Axis;
use super::{Figure, FigureError};

/// Points of one name; those that are not positive, NaN among them, are left out.
#[derive(Debug, Clone, PartialEq)]
pub struct Series {
    /// Name in the legend.
    pub name: String,
    /// (x, y).
    pub points: Vec<(f64, f64)>,
    /// Whether the points are joined by lines.
    pub joined: bool,
}

/// A figure with two logarithmic axes.
///
/// ```
/// use figures::{LogPlot, Series};
/// let plot = LogPlot {
///     name: "rates".into(),
///     title: "Error of a second order method".into(),
///     x: "bricks per edge".into(),
///     y: "relative error".into(),
///     series: vec![Series { name: "displacement".into(), points: vec![(4.0, 1e-2), (8.0, 2.5e-3)], joined: true }],
///     guides: vec![("rate 2".into(), 0.16, -2.0)],
/// };
/// assert_eq!(plot.figure()?.svg.matches("class=\"point\"").count(), 2);
/// # Ok::<(), figures::FigureError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct LogPlot {
    /// Name of the figure, for files.
    pub name: String,
    /// What is seen.
    pub title: String,
    /// Name and unit of the horizontal axis.
    pub x: String,
    /// Name and unit of the vertical axis.
    pub y: String,
    /// The data.
    pub series: Vec<Series>,
    /// Straight lines y = factor·x^slope with their names.
    pub guides: Vec<(String, f64, f64)>,
}

/// Size of the frame, points.
const SIZE: [f64; 2] = [460.0, 320.0];
const GUIDE: &str = "#999999";

impl LogPlot {
    /// Draws it.
    ///
    /// # Errors
    /// [`FigureError`] for numbers that are not finite.
    pub fn figure(&self) -> Result<Figure, FigureError> {
        finite(&self.name, "coordinate", self.series.iter().flat_map(Series::visible).flat_map(|(x, y)| [x, y]))?;
        finite(&self.name, "guide", self.guides.iter().flat_map(|(_, factor, slope)| [*factor, *slope]))?;
        let visible = || self.series.iter().flat_map(Series::visible);
        let across = Axis::logarithmic(&self.x, "", visible().map(|point| point.0), 0.04, 8);
        let up = Axis::logarithmic(&self.y, "", visible().map(|point| point.1), 0.04, 8);
        let frame = Frame { left: 82.0, top: 40.0, width: SIZE[0], height: SIZE[1] };
        let names = self.series.iter().map(|series| &series.name).chain(self.guides.iter().map(|guide| &guide.0));
        let legend = names.clone().fold(0.0_f64, |width, name| width.max(text_width(name, LABEL))) + 44.0;
        let width = (frame.left + SIZE[0] + 14.0 + legend).max(text_width(&self.title, TITLE) + 32.0);
        let mut canvas = Canvas::new(width, frame.top + SIZE[1] + 52.0);
        canvas.text([16.0, 22.0], TITLE, &self.title);
        frame.axes(&mut canvas, &across, &up, Parts { left: Some(66.0), below: Some(44.0), grid: true })?;
        let place = |x: f64, y: f64| Some(frame.place([across.share(x)?, up.share(y)?]));
        canvas.clipped("inside", [frame.left, frame.top], SIZE, |canvas| {
            for (_, factor, slope) in &self.guides {
                let ends: Vec<Place> =
                    across.ends().into_iter().filter_map(|x| place(x, factor * x.powf(*slope))).collect();
                canvas.line(&ends, Stroke::dashed(GUIDE, 1.0));
            }
            for (index, series) in self.series.iter().enumerate() {
                let places: Vec<Place> = series.visible().filter_map(|(x, y)| place(x, y)).collect();
                if series.joined {
                    canvas.line(&places, Stroke::solid(CURVES[index % CURVES.len()], 1.2));
                }
                places.into_iter().for_each(|at| point(canvas, "point", index, at));
            }
        });
        let [x, mut y] = [frame.left + SIZE[0] + 14.0, frame.top + 8.0];
        for (index, name) in names.enumerate() {
            match index < self.series.len() {
                true => point(&mut canvas, "legend", index, [x + 11.0, y]),
                false => canvas.line(&[[x, y], [x + 22.0, y]], Stroke::dashed(GUIDE, 1.0)),
            }
            canvas.text([x + 29.0, y + 0.34 * LABEL], LABEL, name);
            y += 18.0;
        }
        Ok(Figure::new(&self.name, &self.title, canvas))
    }
}

impl Series {
    fn visible(&self) -> impl Iterator<Item = (f64, f64)> {
        self.points.iter().copied().filter(|(x, y)| *x > 0.0 && *y > 0.0)
    }
}

fn point(canvas: &mut Canvas, class: &str, index: usize, [x, y]: Place) {
    let colour = CURVES[index % CURVES.len()];
    canvas.raw(&format!("<circle class=\"{class}\" cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"2.8\" fill=\"{colour}\"/>\n"));
}

#[cfg(test)]
mod tests {
    use super::*;

    fn plot(points: Vec<(f64, f64)>) -> LogPlot {
        LogPlot {
            name: "p".into(),
            title: "t".into(),
            x: "n".into(),
            y: "error".into(),
            series: vec![Series { name: "a < b".into(), points, joined: true }],
            guides: vec![("slope −1".into(), 1e-3, -1.0)],
        }
    }

    #[test]
    fn positive_points_are_drawn_inside_the_frame_and_named() {
        let figure = plot(vec![(1.0, 1e-3), (10.0, 0.0), (100.0, 1e-5)]).figure().expect("numbers");
        assert_eq!(figure.svg.matches("class=\"point\"").count(), 2);
        assert!(figure.svg.contains("a &lt; b") && figure.svg.contains(">slope −1<"));
        assert!(figure.png(1.0).expect("a picture").len() > 2000);
    }

    #[test]
    fn nothing_to_draw_leaves_the_axes_and_infinite_numbers_are_refused() {
        assert!(!plot(vec![(f64::NAN, 1.0), (1.0, f64::NAN)]).figure().expect("axes").svg.contains("NaN"));
        assert!(!plot(vec![]).figure().expect("axes").svg.contains("NaN"));
        assert!(matches!(plot(vec![(1.0, f64::INFINITY)]).figure(), Err(FigureError::Number { .. })));
    }
}
