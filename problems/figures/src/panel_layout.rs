//! Where the panels of plans stand: side by side, each to scale, two lines of text above.

use super::canvas::{Canvas, LABEL, TITLE_ROOM, text_width};
use super::chart::{Frame, ROOM_BELOW, ROOM_LEFT};
use super::plan::Plan;

/// Longer side of a panel, points.
const SIDE: f64 = 280.0;
/// Least ratio of the sides of a panel; slimmer ones are not drawn to scale.
const MIN_SIDE_RATIO: f64 = 0.25;
/// Upper side of the panels, points.
const TOP: f64 = 72.0;

/// Panels side by side.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct PanelLayout {
    pub frames: Vec<Frame>,
    /// Where each panel ends, and its captions.
    pub ends: Vec<f64>,
    /// Where the panels end, with a distance.
    pub right: f64,
    /// Lower side of the tallest panel.
    pub foot: f64,
}

impl PanelLayout {
    /// Panels of some plans, each with room for its captions and for something behind it.
    pub fn new(plans: &[Plan<'_>], captions: &[[String; 2]], behind: f64) -> Self {
        let (mut left, mut foot) = (16.0, TOP);
        let mut frames = Vec::new();
        let mut ends = Vec::new();
        for (plan, captions) in plans.iter().zip(captions) {
            // On a narrow page a panel stands alone, so that every panel has labels of its own.
            left += ROOM_LEFT;
            let [width, height] = sides(plan.size);
            frames.push(Frame { left, top: TOP, width, height });
            let text = captions.iter().fold(0.0_f64, |width, text| width.max(text_width(text, LABEL)));
            ends.push(left + width.max(text));
            left += width.max(text) + behind + if behind > 0.0 { 20.0 } else { 36.0 };
            foot = foot.max(TOP + height);
        }
        Self { frames, ends, right: left, foot }
    }

    /// The captions above the panels. Every panel is a part of the figure, and so is what stands right of all panels
    /// and ends at some height.
    pub fn write(&self, canvas: &mut Canvas, captions: &[[String; 2]], end: f64) {
        let foot = self.foot + ROOM_BELOW + 8.0;
        let lefts: Vec<f64> = self.frames.iter().map(|frame| frame.left - ROOM_LEFT - 8.0).collect();
        for (index, left) in lefts.iter().enumerate() {
            canvas.part([*left, TITLE_ROOM], [lefts.get(index + 1).copied().unwrap_or(self.right - 4.0), foot]);
        }
        if self.right < canvas.width - 1.0 {
            canvas.part([self.right - 4.0, TITLE_ROOM], [canvas.width, end]);
        }
        for (frame, [first, second]) in self.frames.iter().zip(captions) {
            canvas.text([frame.left, frame.top - 26.0], LABEL, first);
            canvas.text([frame.left, frame.top - 10.0], LABEL, second);
        }
    }
}

/// Width and height of a panel, points.
fn sides([first, second]: [f64; 2]) -> [f64; 2] {
    let ratio = (second / first).clamp(MIN_SIDE_RATIO, 1.0 / MIN_SIDE_RATIO);
    if ratio > 1.0 { [SIDE / ratio, SIDE] } else { [SIDE, SIDE * ratio] }
}
