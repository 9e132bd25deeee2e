//! Panels with bodies in space side by side: title, captions, arrows of the axes, note and colour bar around them.

use super::canvas::{Anchor, Canvas, INK, LABEL, Place, Stroke, TITLE, TITLE_ROOM, text_width};
use super::error::FigureError;
use super::figure::Figure;
use super::levels::ColourScale;
use super::oblique::{Skin, paint};
use super::view::{Point, Projection, View};

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
    pub view: View,
    pub scale: &'a ColourScale,
    pub panels: Vec<Panel>,
}

/// What is seen in a panel.
pub(super) struct Panel {
    /// Two lines above it.
    pub captions: [String; 2],
    pub skins: Vec<Skin>,
}

impl Panel {
    fn points(&self) -> impl Iterator<Item = Point> + Clone {
        self.skins.iter().flat_map(|skin| skin.points.iter().copied())
    }
}

impl PanelRow<'_> {
    /// All panels show the same part of space, so that equal places in them are equal points.
    pub fn figure(&self) -> Result<Figure, FigureError> {
        let [across, up] = self.view.bounds(self.panels.iter().flat_map(Panel::points));
        let extents = [across, up].map(|[low, high]| high - low);
        let points = SIDE / extents[0].max(extents[1]);
        if !(points.is_finite() && points > 0.0) {
            let (what, allowed) = ("extent on the drawing, axis".to_owned(), "numbers > 0 on one axis or the other");
            return Err(FigureError::Number {
                figure: self.name.to_owned(),
                what,
                index: 0,
                value: extents[0],
                allowed,
            });
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
        // The note begins right of the labels of the axes.
        let [before, behind] = axes_room(self.view, self.axes);
        let note = MARGIN + before + behind + 24.0;
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
            let projection = Projection { view: self.view, origin, scale: points };
            canvas.raw("<g class=\"panel\">\n");
            paint(&mut canvas, &projection, &panel.skins, self.scale);
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
        directions(&mut canvas, self.view, self.axes, [MARGIN, foot + 58.0]);
        canvas.text([note, foot + 62.0], LABEL, self.note);
        Ok(Figure::new(self.name, self.title, canvas))
    }
}

/// Where the arrow of an axis ends, if it begins at 0.
fn arrow_end(view: View, axis: usize) -> Place {
    let unit = std::array::from_fn(|other| f64::from(u8::from(other == axis)));
    Projection { view, origin: [0.0; 2], scale: ARROW }.place(unit)
}

/// Room at the left and at the right of the origin of the arrows that [`directions`] draws.
fn axes_room(view: View, axes: &[String; 3]) -> [f64; 2] {
    axes.iter().enumerate().fold([8.0, 2.0 * ARROW - 8.0], |[before, behind], (axis, label)| {
        let (x, width) = (arrow_end(view, axis)[0], text_width(label, LABEL) + 5.0);
        if x < -1.0 { [before.max(width - x), behind] } else { [before, behind.max(width + x + 16.0)] }
    })
}

/// The directions of the three axes as arrows with labels, from some left side on; the arrows begin at a height.
pub(super) fn directions(canvas: &mut Canvas, view: View, axes: &[String; 3], [left, height]: Place) {
    let origin = [left + axes_room(view, axes)[0], height];
    for (axis, label) in axes.iter().enumerate() {
        let [x, y] = arrow_end(view, axis);
        let end = [origin[0] + x, origin[1] + y];
        canvas.arrow([origin, end], Stroke::solid(INK, 1.0));
        // The third axis points upwards.
        let below = if axis == 2 { 2.0 } else { 0.34 * LABEL };
        let (gap, anchor) = if x < -1.0 { (-5.0, Anchor::End) } else { (5.0, Anchor::Start) };
        canvas.anchored([end[0] + gap, end[1] + below], LABEL, anchor, label);
    }
}
