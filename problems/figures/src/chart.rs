//! A rectangle with axes at its left and lower side: ticks, labels, titles, grid lines.

use super::canvas::{Anchor, Canvas, INK, LABEL, Place, Stroke, text_width};
use super::scale::Axis;

/// Room below a frame for the labels and the title of its horizontal axis, points.
pub(super) const ROOM_BELOW: f64 = 42.0;
/// Room at the left for labels and title of the vertical axis, points.
pub(super) const ROOM_LEFT: f64 = 52.0;
/// Length of a tick, points.
const TICK: f64 = 3.5;
/// Distance of the labels from the frame, points.
const GAP: f64 = 7.0;
/// Least distance between labels, points.
const APART: f64 = 3.0;
/// Width of frame and ticks, points.
const LINE: f64 = 0.8;
/// Height of a digit above the baseline, relative to the size of the text.
const DIGIT: f64 = 0.7;
/// Colour of grid lines.
const GRID: &str = "#e1e1e1";

/// A rectangle for curves or for a map.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Frame {
    pub left: f64,
    pub top: f64,
    pub width: f64,
    pub height: f64,
}

/// Which parts of the axes are drawn.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Parts {
    /// Room at the left for ticks, labels and title of the vertical axis, points.
    pub left: f64,
    /// Lines across the frame at the ticks.
    pub grid: bool,
}

impl Frame {
    /// Place of shares of both axes; the vertical one is counted from below.
    pub fn place(&self, [across, up]: [f64; 2]) -> Place {
        [self.left + across * self.width, self.top + (1.0 - up) * self.height]
    }

    /// Draws both axes with their ticks, labels and titles.
    pub fn axes(&self, canvas: &mut Canvas, across: &Axis, up: &Axis, parts: Parts) {
        let (grid, ink) = (Stroke::solid(GRID, 0.7), Stroke::solid(INK, LINE));
        let [middle, foot] = self.place([0.5, 0.0]);
        if parts.grid {
            for tick in &across.ticks {
                canvas.line(&[0.0, 1.0].map(|end| self.place([tick.share, end])), grid);
            }
            for tick in &up.ticks {
                canvas.line(&[0.0, 1.0].map(|end| self.place([end, tick.share])), grid);
            }
        }
        let mut free = f64::NEG_INFINITY;
        for tick in &across.ticks {
            let [x, y] = self.place([tick.share, 0.0]);
            canvas.line(&[[x, y], [x, y + TICK]], ink);
            // On a slim frame, labels give way to those before them.
            let half = 0.5 * text_width(&tick.label, LABEL);
            if x - half >= free {
                canvas.anchored([x, y + GAP + DIGIT * LABEL], LABEL, Anchor::Middle, &tick.label);
                free = x + half + APART;
            }
        }
        canvas.anchored([middle, foot + ROOM_BELOW - 3.0], LABEL, Anchor::Middle, &across.title);
        for tick in &up.ticks {
            let [x, y] = self.place([0.0, tick.share]);
            canvas.line(&[[x - TICK, y], [x, y]], ink);
            canvas.anchored([x - GAP, y + 0.5 * DIGIT * LABEL], LABEL, Anchor::End, &tick.label);
        }
        let title = [self.left - parts.left + DIGIT * LABEL, self.top + 0.5 * self.height];
        canvas.anchored(title, LABEL, Anchor::Upward, &up.title);
        canvas.outline(&[[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]].map(|share| self.place(share)), ink);
    }
}
