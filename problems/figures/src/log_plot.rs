//! Curves over two logarithmic axes, with straight lines of given slopes.

use super::canvas::{Canvas, Place, Stroke, TITLE, text_width};
use super::chart::{Frame, Parts, ROOM_BELOW};
use super::colours::curve;
use super::error::{FigureError, finite};
use super::figure::Figure;
use super::marks::{self, Sign, legend_width};
use super::scale::Axis;

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
    /// Title above the figure; it states what is seen.
    pub title: String,
    /// Name and unit of the horizontal axis.
    pub x: String,
    /// Name and unit of the vertical axis.
    pub y: String,
    /// Curves, drawn in this order.
    pub series: Vec<Series>,
    /// Straight lines y = factor·x^slope with their names.
    pub guides: Vec<(String, f64, f64)>,
}

/// Size of the frame, points.
const SIZE: [f64; 2] = [460.0, 320.0];
/// Colour of the straight lines.
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
        let guide = Stroke::dashed(GUIDE, 1.0);
        let series = self.series.iter().enumerate().map(|(index, series)| (Sign::Point(index), series.name.clone()));
        let guides = self.guides.iter().map(|(name, ..)| (Sign::Line(guide), name.clone()));
        let legend: Vec<_> = series.chain(guides).collect();
        let right = frame.left + SIZE[0] + 14.0;
        let width = (right + legend_width(&legend)).max(text_width(&self.title, TITLE) + 32.0);
        let mut canvas = Canvas::new(width, frame.top + SIZE[1] + ROOM_BELOW + 8.0);
        canvas.text([16.0, 22.0], TITLE, &self.title);
        frame.axes(&mut canvas, &across, &up, Parts { left: 66.0, grid: true });
        let place = |x: f64, y: f64| Some(frame.place([across.share(x)?, up.share(y)?]));
        canvas.clipped("inside", [frame.left, frame.top], SIZE, |canvas| {
            for (_, factor, slope) in &self.guides {
                let ends: Vec<Place> =
                    across.ends().into_iter().filter_map(|x| place(x, factor * x.powf(*slope))).collect();
                canvas.line(&ends, guide);
            }
            for (index, series) in self.series.iter().enumerate() {
                let places: Vec<Place> = series.visible().filter_map(|(x, y)| place(x, y)).collect();
                if series.joined {
                    canvas.line(&places, Stroke::solid(curve(index), 1.2));
                }
                places.into_iter().for_each(|at| marks::point(canvas, "point", index, at));
            }
        });
        marks::legend(&mut canvas, [right, frame.top + 8.0], &legend);
        Ok(Figure::new(&self.name, &self.title, canvas))
    }
}

impl Series {
    fn visible(&self) -> impl Iterator<Item = (f64, f64)> {
        self.points.iter().copied().filter(|(x, y)| *x > 0.0 && *y > 0.0)
    }
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
    }

    #[test]
    fn nothing_to_draw_leaves_the_axes_and_infinite_numbers_are_refused() {
        assert!(!plot(vec![(f64::NAN, 1.0), (1.0, f64::NAN)]).figure().expect("axes").svg.contains("NaN"));
        assert!(!plot(vec![]).figure().expect("axes").svg.contains("NaN"));
        assert!(matches!(plot(vec![(1.0, f64::INFINITY)]).figure(), Err(FigureError::Number { .. })));
    }
}
