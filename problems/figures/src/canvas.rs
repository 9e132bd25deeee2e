//! SVG text: lines, areas and writing at positions in points, the origin at the upper left.
//!
//! A superscript is written `^{…}` and raised when the text is drawn.

use std::fmt::Write;

/// Family of all text in figures; the PNG renderer brings its file.
pub(super) const FAMILY: &str = "Ubuntu";
/// Size of captions and titles, points.
pub(super) const TITLE: f64 = 14.0;
/// Size of labels and notes, points.
pub(super) const LABEL: f64 = 12.0;
/// Upper side of what stands below the title of a figure, points.
pub(super) const TITLE_ROOM: f64 = 30.0;
/// Colour of text and frames.
pub(super) const INK: &str = "#222222";
/// Average width of a letter relative to its size, of the widest fonts that browsers take for sans-serif; only decides
/// about distances.
const LETTER: f64 = 0.56;

/// A position in points.
pub(super) type Place = [f64; 2];

/// Which point of a line of text is given.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Anchor {
    Start,
    Middle,
    End,
    /// The middle of a line that reads upwards.
    Upward,
}

/// How a line is drawn.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Stroke<'a> {
    pub colour: &'a str,
    pub width: f64,
    pub dashed: bool,
}

impl<'a> Stroke<'a> {
    pub fn solid(colour: &'a str, width: f64) -> Self {
        Self { colour, width, dashed: false }
    }

    pub fn dashed(colour: &'a str, width: f64) -> Self {
        Self { colour, width, dashed: true }
    }

    fn attributes(self) -> String {
        let dashes = if self.dashed { " stroke-dasharray=\"5 4\"" } else { "" };
        format!("fill=\"none\" stroke=\"{}\" stroke-width=\"{}\"{dashes}", self.colour, self.width)
    }
}

/// A drawing under way.
#[derive(Debug, Clone)]
pub(super) struct Canvas {
    pub width: f64,
    pub height: f64,
    /// Left, top, width and height of what may stand one below the other, in whole points.
    pub parts: Vec<[u32; 4]>,
    body: String,
}

// Writing to a string cannot fail: the results of `write!` are dropped below.
impl Canvas {
    pub fn new(width: f64, height: f64) -> Self {
        Self { width: width.ceil(), height: height.ceil(), parts: Vec::new(), body: String::new() }
    }

    /// One line of text of some size that begins at a place.
    pub fn text(&mut self, at: Place, size: f64, text: &str) {
        self.anchored(at, size, Anchor::Start, text);
    }

    /// One line of text of some size; the place is that of a point on its baseline.
    pub fn anchored(&mut self, [x, y]: Place, size: f64, anchor: Anchor, text: &str) {
        let more = match anchor {
            Anchor::Start => String::new(),
            Anchor::Middle => " text-anchor=\"middle\"".to_owned(),
            Anchor::End => " text-anchor=\"end\"".to_owned(),
            Anchor::Upward => format!(" text-anchor=\"middle\" transform=\"rotate(-90 {x:.1} {y:.1})\""),
        };
        let _ = writeln!(
            self.body,
            "<text x=\"{x:.1}\" y=\"{y:.1}\" font-size=\"{size}\" fill=\"{INK}\"{more}>{}</text>",
            raised(&escaped(text), size)
        );
    }

    /// A line of text in the middle of a place, with a rim that makes it readable on every colour.
    pub fn rimmed(&mut self, [x, y]: Place, size: f64, text: &str) {
        let _ = writeln!(
            self.body,
            "<text x=\"{x:.1}\" y=\"{:.1}\" font-size=\"{size}\" fill=\"{INK}\" text-anchor=\"middle\" stroke=\"#ffffff\" \
             stroke-width=\"3\" stroke-linejoin=\"round\" paint-order=\"stroke\">{}</text>",
            y + 0.35 * size,
            raised(&escaped(text), size)
        );
    }

    /// An arrow from a tail to a tip, its head filled.
    pub fn arrow(&mut self, [tail, tip]: [Place; 2], stroke: Stroke) {
        let along = [tip[0] - tail[0], tip[1] - tail[1]];
        let length = along[0].hypot(along[1]);
        if length > 0.0 {
            let head = (2.5 + 2.0 * stroke.width).min(0.6 * length);
            let along = along.map(|part| part / length);
            let wing = |side: f64| {
                let side = side * head;
                [tip[0] - head * along[0] - side * along[1], tip[1] - head * along[1] + side * along[0]]
            };
            self.line(&[tail, [tip[0] - 0.5 * head * along[0], tip[1] - 0.5 * head * along[1]]], stroke);
            self.area(stroke.colour, [[tip, wing(0.45), wing(-0.45)].as_slice()]);
        }
    }

    /// A line through places.
    pub fn line(&mut self, places: &[Place], stroke: Stroke) {
        let _ = writeln!(self.body, "<path d=\"{}\" {}/>", path(places, false), stroke.attributes());
    }

    /// Lines through places as one path.
    pub fn lines(&mut self, lines: &[Vec<Place>], stroke: Stroke) {
        let paths: String = lines.iter().map(|line| tenths(line)).collect();
        if !paths.is_empty() {
            let stroke = Stroke { width: 10.0 * stroke.width, ..stroke }.attributes();
            let _ = writeln!(
                self.body,
                "<path transform=\"scale(.1)\" {stroke} stroke-linejoin=\"round\" stroke-linecap=\"round\" \
                 d=\"{paths}\"/>"
            );
        }
    }

    /// Draws a closed polygon without filling it.
    pub fn outline(&mut self, places: &[Place], stroke: Stroke) {
        let _ = writeln!(self.body, "<path d=\"{}\" {}/>", path(places, true), stroke.attributes());
    }

    /// Areas of one colour as one path; where they overlap nothing changes. A rim of the same colour hides seams
    /// between neighbours.
    pub fn area<'a>(&mut self, colour: &str, areas: impl IntoIterator<Item = &'a [Place]>) {
        let paths: String = areas.into_iter().map(closed).collect();
        if !paths.is_empty() {
            let rim = format!("stroke=\"{colour}\" stroke-width=\"3\" stroke-linejoin=\"round\"");
            let _ = writeln!(self.body, "<path transform=\"scale(.1)\" {rim} fill=\"{colour}\" d=\"{paths}\"/>");
        }
    }

    /// A rectangle filled with a colour.
    pub fn rectangle(&mut self, [x, y]: Place, [width, height]: [f64; 2], colour: &str) {
        let _ = writeln!(
            self.body,
            "<rect x=\"{x:.1}\" y=\"{y:.1}\" width=\"{width:.1}\" height=\"{height:.1}\" fill=\"{colour}\"/>"
        );
    }

    /// Says that a rectangle is a part that may stand alone; it is cut at the sides of the drawing.
    pub fn part(&mut self, [left, top]: Place, [right, foot]: Place) {
        let [left, top] = [left, top].map(|side| side.max(0.0).floor() as u32);
        let [right, foot] = [right.min(self.width), foot.min(self.height)].map(|side| side.ceil() as u32);
        self.parts.push([left, top, right.saturating_sub(left), foot.saturating_sub(top)]);
    }

    /// SVG elements as they are.
    pub fn raw(&mut self, elements: &str) {
        self.body += elements;
    }

    /// The whole text; all that is drawn has one name, so that a page can show its parts.
    pub fn finish(self, name: &str, title: &str) -> String {
        let Self { width, height, body, .. } = self;
        let name = escaped(name).replace('"', "&quot;");
        format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" viewBox=\"0 0 {width} \
             {height}\" font-family=\"{FAMILY}, sans-serif\">\n<title>{}</title>\n\
             <g id=\"{name}\">\n<rect width=\"{width}\" height=\"{height}\" fill=\"#ffffff\"/>\n{body}</g>\n</svg>\n",
            escaped(title)
        )
    }
}

/// About how wide a text is, points.
pub(super) fn text_width(text: &str, size: f64) -> f64 {
    let letters = text.chars().filter(|letter| !"^{}".contains(*letter)).count();
    LETTER * size * letters as f64
}

/// A text for SVG; control characters, which XML does not know, become spaces.
pub(super) fn escaped(text: &str) -> String {
    let mut safe = String::with_capacity(text.len());
    for letter in text.chars() {
        match letter {
            '&' => safe += "&amp;",
            '<' => safe += "&lt;",
            '>' => safe += "&gt;",
            letter if letter.is_control() || matches!(letter, '\u{fffe}' | '\u{ffff}') => safe.push(' '),
            letter => safe.push(letter),
        }
    }
    safe
}

/// `^{…}` as superscripts in a text that is escaped already.
fn raised(text: &str, size: f64) -> String {
    let (small, rise) = (0.75 * size, 0.35 * size);
    let mut pieces = text.split("^{");
    let mut all = pieces.next().unwrap_or_default().to_owned();
    for piece in pieces {
        let (exponent, rest) = piece.split_once('}').unwrap_or((piece, ""));
        let _ = write!(all, "<tspan dy=\"-{rise:.1}\" font-size=\"{small:.1}\">{exponent}</tspan>");
        if !rest.is_empty() {
            let _ = write!(all, "<tspan dy=\"{rise:.1}\">{rest}</tspan>");
        }
    }
    all
}

fn path(places: &[Place], closed: bool) -> String {
    let mut text = String::new();
    for (index, [x, y]) in places.iter().enumerate() {
        let _ = write!(text, "{}{x:.1} {y:.1}", if index == 0 { 'M' } else { 'L' });
    }
    if closed {
        text.push('Z');
    }
    text
}

/// A closed path in tenths of points.
pub(super) fn closed(places: &[Place]) -> String {
    tenths(places) + "z"
}

/// A path in tenths of points, relative positions: half the length of absolute ones.
fn tenths(places: &[Place]) -> String {
    let mut text = String::new();
    let mut last = [0_i64; 2];
    for (index, place) in places.iter().enumerate() {
        let here = place.map(|coordinate| (10.0 * coordinate).round() as i64);
        let [dx, dy] = [here[0] - last[0], here[1] - last[1]];
        let _ = match index {
            0 => write!(text, "M{dx} {dy}"),
            1 => write!(text, "l{dx} {dy}"),
            _ => write!(text, " {dx} {dy}"),
        };
        last = here;
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn superscripts_are_raised_and_the_rest_comes_back_down() {
        let text = raised("10^{−3} MPa^{4}", 12.0);
        assert_eq!(
            text,
            "10<tspan dy=\"-4.2\" font-size=\"9.0\">−3</tspan><tspan dy=\"4.2\"> MPa</tspan>\
             <tspan dy=\"-4.2\" font-size=\"9.0\">4</tspan>"
        );
        assert_eq!(raised("no closing ^{brace", 10.0).matches("</tspan>").count(), 1);
        assert_eq!(escaped("a<b & \u{1}"), "a&lt;b &amp;  ");
    }

    #[test]
    fn areas_are_written_relative_in_tenths() {
        assert_eq!(closed(&[[1.0, 2.0], [3.04, 2.0], [3.0, 4.5]]), "M10 20l20 0 0 25z");
    }
}
