//! Log–log pictures as SVG: series with markers, decades as grid, guides of a given slope.

use std::fmt::Write;

/// Points of one name; those that are not positive are left out.
#[derive(Debug, Clone, PartialEq)]
pub struct Series {
    /// Name in the legend.
    pub name: String,
    /// (x, y).
    pub points: Vec<(f64, f64)>,
    /// Whether the points are joined by lines.
    pub joined: bool,
}

/// A picture with two logarithmic axes.
#[derive(Debug, Clone, PartialEq)]
pub struct LogPlot {
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

const WIDTH: f64 = 460.0;
const HEIGHT: f64 = 320.0;
const LEFT: f64 = 72.0;
const TOP: f64 = 36.0;
const LEGEND: f64 = 190.0;
const COLOURS: [&str; 7] = ["#1b6ca8", "#c8553d", "#3a7d44", "#7b4ea3", "#b8860b", "#333333", "#d16ba5"];
/// Most labels per axis.
const LABELS: i32 = 8;

/// One logarithmic axis: exponents of ten at both ends.
#[derive(Debug, Clone, Copy)]
struct Axis {
    low: f64,
    high: f64,
}

impl Axis {
    fn over(values: impl Iterator<Item = f64>) -> Self {
        let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
        for exponent in values.map(f64::log10) {
            (low, high) = (low.min(exponent), high.max(exponent));
        }
        if low > high {
            return Self { low: 0.0, high: 1.0 };
        }
        let room = 0.04 * (high - low).max(0.5);
        let (low, high) = (low - room, high + room);
        // At least one decade line has to be seen.
        if low.ceil() > high.floor() { Self { low: low.floor(), high: high.ceil() } } else { Self { low, high } }
    }

    fn share(self, value: f64) -> f64 {
        (value.log10() - self.low) / (self.high - self.low)
    }

    fn decades(self) -> impl Iterator<Item = i32> {
        let (first, last) = (self.low.ceil() as i32, self.high.floor() as i32);
        let stride = ((last - first) / LABELS + 1).max(1);
        (first..=last).filter(move |exponent| exponent.rem_euclid(stride) == 0)
    }
}

impl LogPlot {
    /// The picture.
    pub fn svg(&self) -> String {
        let visible = || self.series.iter().flat_map(|series| &series.points).filter(|(x, y)| *x > 0.0 && *y > 0.0);
        let (across, up) = (Axis::over(visible().map(|point| point.0)), Axis::over(visible().map(|point| point.1)));
        let place = |x: f64, y: f64| (LEFT + WIDTH * across.share(x), TOP + HEIGHT * (1.0 - up.share(y)));
        let mut svg = format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{:.0}\" height=\"{:.0}\" font-family=\"sans-serif\" \
             font-size=\"12\">\n<rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n\
             <text x=\"{LEFT:.0}\" y=\"22\" font-size=\"14\">{}</text>\n",
            LEFT + WIDTH + LEGEND,
            TOP + HEIGHT + 52.0,
            escaped(&self.title)
        );
        let mut put = |text: String| {
            svg += &text;
            svg.push('\n');
        };
        for exponent in across.decades() {
            let x = place(10.0_f64.powi(exponent), 1.0).0;
            put(format!("<path d=\"M{x:.1} {TOP}v{HEIGHT}\" stroke=\"#ddd\"/>"));
            put(power(x, TOP + HEIGHT + 17.0, "middle", exponent));
        }
        for exponent in up.decades() {
            let y = place(1.0, 10.0_f64.powi(exponent)).1;
            put(format!("<path d=\"M{LEFT} {y:.1}h{WIDTH}\" stroke=\"#ddd\"/>"));
            put(power(LEFT - 6.0, y + 4.0, "end", exponent));
        }
        put(format!(
            "<rect x=\"{LEFT}\" y=\"{TOP}\" width=\"{WIDTH}\" height=\"{HEIGHT}\" fill=\"none\" stroke=\"#555\"/>"
        ));
        put(format!(
            "<text x=\"{:.0}\" y=\"{:.0}\" text-anchor=\"middle\">{}</text>",
            LEFT + WIDTH / 2.0,
            TOP + HEIGHT + 40.0,
            escaped(&self.x)
        ));
        put(format!(
            "<text transform=\"translate(18 {:.0}) rotate(-90)\" text-anchor=\"middle\">{}</text>",
            TOP + HEIGHT / 2.0,
            escaped(&self.y)
        ));
        put(format!(
            "<svg x=\"{LEFT}\" y=\"{TOP}\" width=\"{WIDTH}\" height=\"{HEIGHT}\" viewBox=\"{LEFT} {TOP} {WIDTH} {HEIGHT}\">"
        ));
        for (_, factor, slope) in &self.guides {
            let ends = [across.low, across.high].map(|exponent| 10.0_f64.powf(exponent));
            let [(x1, y1), (x2, y2)] = ends.map(|x| place(x, factor * x.powf(*slope)));
            put(format!("<path d=\"M{x1:.1} {y1:.1}L{x2:.1} {y2:.1}\" stroke=\"#999\" stroke-dasharray=\"5 4\"/>"));
        }
        for (index, series) in self.series.iter().enumerate() {
            let colour = COLOURS[index % COLOURS.len()];
            let points: Vec<(f64, f64)> =
                series.points.iter().filter(|(x, y)| *x > 0.0 && *y > 0.0).map(|&(x, y)| place(x, y)).collect();
            if series.joined {
                let line: Vec<String> = points.iter().map(|(x, y)| format!("{x:.1},{y:.1}")).collect();
                put(format!("<polyline points=\"{}\" fill=\"none\" stroke=\"{colour}\"/>", line.join(" ")));
            }
            for (x, y) in points {
                put(format!("<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"2.6\" fill=\"{colour}\"/>"));
            }
        }
        put("</svg>".into());
        self.legend(&mut svg);
        svg + "</svg>\n"
    }

    fn legend(&self, svg: &mut String) {
        let x = LEFT + WIDTH + 14.0;
        let mut y = TOP + 10.0;
        for (index, series) in self.series.iter().enumerate() {
            let colour = COLOURS[index % COLOURS.len()];
            // Writing to a string cannot fail.
            let _ = writeln!(
                svg,
                "<circle cx=\"{x:.0}\" cy=\"{:.0}\" r=\"3.5\" fill=\"{colour}\"/><text x=\"{:.0}\" y=\"{y:.0}\">{}</text>",
                y - 4.0,
                x + 10.0,
                escaped(&series.name)
            );
            y += 18.0;
        }
        for (name, _, _) in &self.guides {
            let _ = writeln!(
                svg,
                "<path d=\"M{:.0} {:.0}h14\" stroke=\"#999\" stroke-dasharray=\"5 4\"/><text x=\"{:.0}\" y=\"{y:.0}\">{}</text>",
                x - 6.0,
                y - 4.0,
                x + 10.0,
                escaped(name)
            );
            y += 18.0;
        }
    }
}

/// A power of ten as a label.
fn power(x: f64, y: f64, anchor: &str, exponent: i32) -> String {
    format!(
        "<text x=\"{x:.1}\" y=\"{y:.1}\" text-anchor=\"{anchor}\">10<tspan dy=\"-5\" font-size=\"9\">{exponent}</tspan></text>"
    )
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn positive_points_are_drawn_inside_the_frame() {
        let series =
            Series { name: "a < b".into(), points: vec![(1.0, 1e-3), (10.0, 0.0), (100.0, 1e-5)], joined: true };
        let plot = LogPlot {
            title: "t".into(),
            x: "n".into(),
            y: "error".into(),
            series: vec![series],
            guides: vec![("slope −1".into(), 1e-3, -1.0)],
        };
        let svg = plot.svg();
        assert_eq!(svg.matches("r=\"2.6\"").count(), 2);
        assert!(svg.contains("a &lt; b") && svg.contains("slope −1") && svg.trim_end().ends_with("</svg>"));
        let empty = LogPlot { series: vec![], ..plot }.svg();
        assert!(!empty.contains("NaN") && !svg.contains("NaN"));
    }
}
