//! Panels with bodies in space side by side: title, captions, arrows of the axes, note and colour bar around them.

use super::canvas::{Canvas, INK, LABEL, Place, Stroke, TITLE, TITLE_ROOM, text_width};
use super::error::FigureError;
use super::figure::Figure;
use super::levels::ColourScale;
use super::oblique::{Point, Sheet, View, bounds, paint};

/// Larger side of a panel, points.
const SIDE: f64 = 300.0;
/// Length of an arrow of the axes, points.
const ARROW: f64 = 30.0;
/// Least height of the colour bar, so that its labels have room.
const MIN_BAR_HEIGHT: f64 = 130.0;
const MARGIN: f64 = 16.0;

/// All of a figure but the values of its panels.
pub(super) struct PanelRow<'a> {
    pub name: &'a str,
    pub title: &'a str,
    /// What is written at the arrows of the axes.
    pub axes: &'a [String; 3],
    pub note: &'a str,
    pub scale: &'a ColourScale,
    pub panels: Vec<Panel>,
}

/// What is seen in a panel.
pub(super) struct Panel {
    /// Two lines above it.
    pub captions: [String; 2],
    pub bodies: Vec<Vec<Sheet>>,
    /// Sheets before everything else.
    pub front: Vec<Sheet>,
}

impl Panel {
    fn points(&self) -> impl Iterator<Item = Point> + Clone {
        let sheets = self.bodies.iter().flatten().chain(&self.front);
        sheets.flat_map(|sheet| sheet.points.iter().copied())
    }
}

impl PanelRow<'_> {
    /// All panels show the same part of space, so that equal places in them are equal points.
    pub fn figure(&self) -> Result<Figure, FigureError> {
        let [across, up] = bounds(self.panels.iter().flat_map(Panel::points));
        let extents = [across, up].map(|[low, high]| high - low);
        let points = SIDE / extents[0].max(extents[1]);
        if !(points.is_finite() && points > 0.0) {
            let (what, value, allowed) =
                ("extent on the drawing, axis", extents[0], "numbers > 0 on one axis or the other");
            return Err(FigureError::Number { figure: self.name.to_owned(), what, index: 0, value, allowed });
        }
        let size = extents.map(|extent| points * extent);
        let (top, height) = (76.0, size[1].max(MIN_BAR_HEIGHT));
        let mut left = MARGIN;
        let lefts: Vec<f64> = self
            .panels
            .iter()
            .map(|panel| {
                let here = left;
                left += panel.captions.iter().fold(size[0], |width, text| width.max(text_width(text, LABEL))) + 30.0;
                here
            })
            .collect();
        let bar_title = text_width(&self.scale.axis.title, LABEL);
        // Arrows end at their labels; the note begins right of those.
        let labels = self.axes.iter().fold(0.0_f64, |width, label| width.max(text_width(label, LABEL)));
        let note = MARGIN + 2.0 * ARROW + labels + 24.0;
        let width = [
            bar_title + left,
            left + 75.0,
            MARGIN + text_width(self.title, TITLE),
            note + text_width(self.note, LABEL),
        ];
        let width = width.into_iter().fold(0.0, f64::max) + MARGIN;
        let mut canvas = Canvas::new(width, top + height + 84.0);
        canvas.text([MARGIN, 22.0], TITLE, self.title);
        for (panel, &left) in self.panels.iter().zip(&lefts) {
            let origin = [left - points * across[0], top + 0.5 * (height - size[1]) - points * up[0]];
            let view = View { origin, scale: points };
            canvas.raw("<g class=\"panel\">\n");
            paint(&mut canvas, &view, &panel.bodies, self.scale);
            for sheet in &panel.front {
                paint(&mut canvas, &view, &[vec![sheet.clone()]], self.scale);
            }
            canvas.raw("</g>\n");
            canvas.text([left, top - 30.0], LABEL, &panel.captions[0]);
            canvas.text([left, top - 14.0], LABEL, &panel.captions[1]);
        }
        self.scale.bar(&mut canvas, [left, top], height);
        let foot = top + height;
        for (index, start) in lefts.iter().enumerate() {
            let end = lefts.get(index + 1).map_or(left - 8.0, |next| next - 8.0);
            canvas.part([start - 8.0, TITLE_ROOM], [end, foot + 10.0]);
        }
        canvas.part([left - 8.0, TITLE_ROOM], [canvas.width, foot + 10.0]);
        canvas.part([0.0, foot + 10.0], [note + text_width(self.note, LABEL) + MARGIN, canvas.height]);
        directions(&mut canvas, self.axes, [MARGIN + 8.0, foot + 58.0]);
        canvas.text([note, foot + 62.0], LABEL, self.note);
        Ok(Figure::new(self.name, self.title, canvas))
    }
}

/// The directions of the three axes as arrows with labels.
pub(super) fn directions(canvas: &mut Canvas, axes: &[String; 3], origin: Place) {
    let view = View { origin, scale: ARROW };
    for (axis, label) in axes.iter().enumerate() {
        let end = view.place(std::array::from_fn(|other| f64::from(u8::from(other == axis))));
        canvas.arrow([origin, end], Stroke::solid(INK, 1.0));
        let gap = if axis == 2 { [6.0, 2.0] } else { [5.0, 0.34 * LABEL] };
        canvas.text([end[0] + gap[0], end[1] + gap[1]], LABEL, label);
    }
}
