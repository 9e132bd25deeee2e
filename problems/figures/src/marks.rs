//! Marks of curves and paths, and the legend that explains them.

use super::canvas::{Canvas, INK, LABEL, Place, Stroke, escaped, text_width};
use super::colours::{CURVES, curve};

/// Half the size of a mark, points.
const MARK: f64 = 3.8;
/// Length of the lines in a legend, points.
const LINE: f64 = 22.0;
/// Distance of the names in a legend from its left side, points.
const INDENT: f64 = 29.0;
/// Height of a row of a legend, points.
const ROW: f64 = 20.0;

/// What stands before a name in a legend.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Sign<'a> {
    /// The mark of a kind, with the kind's number.
    Mark(&'a str, usize),
    /// The shape of a kind without its colour.
    Shape(&'a str, usize),
    /// A square of a colour.
    Swatch(&'a str),
    Line(Stroke<'a>),
}

/// Kinds of steps in the order in which they appear, with their numbers.
pub(super) fn kinds<'a>(all: impl Iterator<Item = &'a str>) -> Vec<(&'a str, usize)> {
    let mut kinds: Vec<(&str, usize)> = Vec::new();
    for kind in all {
        match kinds.iter_mut().find(|(known, _)| *known == kind) {
            Some((_, count)) => *count += 1,
            None => kinds.push((kind, 1)),
        }
    }
    kinds
}

/// A row of the legend for every kind.
pub(super) fn rows<'a>(kinds: &[(&'a str, usize)]) -> Vec<(Sign<'a>, String)> {
    let row =
        |(index, &(kind, count)): (usize, &(&'a str, usize))| (Sign::Mark(kind, index), format!("{kind} ({count})"));
    kinds.iter().enumerate().map(row).collect()
}

/// Width of a legend with some space at its right, points.
pub(super) fn legend_width(rows: &[(Sign, String)]) -> f64 {
    rows.iter().fold(0.0_f64, |width, (_, name)| width.max(text_width(name, LABEL))) + INDENT + 15.0
}

/// A legend whose first row lies at a height.
pub(super) fn legend(canvas: &mut Canvas, [x, mut y]: Place, rows: &[(Sign, String)]) {
    for (sign, name) in rows {
        let middle = [x + 0.5 * LINE, y];
        match sign {
            Sign::Mark(kind, index) => mark(canvas, &format!("legend {kind}"), *index, mark_colour(*index), middle, ""),
            Sign::Shape(kind, index) => mark(canvas, &format!("legend {kind}"), *index, INK, middle, ""),
            Sign::Swatch(colour) => canvas.rectangle([middle[0] - 5.0, y - 5.0], [10.0, 10.0], colour),
            Sign::Line(stroke) => canvas.line(&[[x, y], [x + LINE, y]], *stroke),
        }
        canvas.text([x + INDENT, y + 0.34 * LABEL], LABEL, name);
        y += ROW;
    }
}

/// The number of a kind.
pub(super) fn number(kinds: &[(&str, usize)], kind: &str) -> usize {
    kinds.iter().position(|(known, _)| *known == kind).unwrap_or(0)
}

/// The colour of a number. Blue is the line's colour.
pub(super) fn mark_colour(index: usize) -> &'static str {
    CURVES[1 + index % (CURVES.len() - 1)]
}

/// A mark with the shape of a number; a browser shows the text, if there is one, over it.
pub(super) fn mark(canvas: &mut Canvas, class: &str, index: usize, colour: &str, [x, y]: Place, text: &str) {
    let r = MARK;
    let shape = match index % 4 {
        0 => format!("M{x:.1} {:.1}l{r} {r} -{r} {r} -{r} -{r}z", y - r),
        1 => format!("M{:.1} {y:.1}a{r} {r} 0 1 0 {d} 0a{r} {r} 0 1 0 -{d} 0z", x - r, d = 2.0 * r),
        2 => format!("M{:.1} {:.1}h{d}v{d}h-{d}z", x - 0.9 * r, y - 0.9 * r, d = 1.8 * r),
        _ => format!("M{x:.1} {:.1}l{r} {d} -{d} 0z", y - r, d = 2.0 * r),
    };
    let class = escaped(class).replace('"', "&quot;");
    let title = if text.is_empty() { String::new() } else { format!("<title>{}</title>", escaped(text)) };
    canvas.raw(&format!(
        "<path class=\"{class}\" d=\"{shape}\" fill=\"{colour}\" stroke=\"#ffffff\" stroke-width=\"0.6\">{title}</path>\n"
    ));
}

/// A point of a series.
pub(super) fn point(canvas: &mut Canvas, class: &str, index: usize, [x, y]: Place) {
    let colour = curve(index);
    canvas.raw(&format!("<circle class=\"{class}\" cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"2.8\" fill=\"{colour}\"/>\n"));
}
