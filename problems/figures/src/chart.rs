//! Axes around a rectangle, drawn by plotters; curves and marks inside.
//!
//! plotters places everything on whole pixels, so it draws ten times as large as the figure.

use super::FigureError;
use super::canvas::{Canvas, INK, LABEL, Place, Stroke, raised};
use super::png::FAMILY;
use super::scale::Axis;
use plotters::coord::ranged1d::{DefaultFormatting, KeyPointHint, Ranged};
use plotters::prelude::*;
use std::ops::Range;

/// Pixels of plotters per point.
const FINENESS: f64 = 10.0;
/// Colour of grid lines.
const GRID: RGBColor = RGBColor(225, 225, 225);
const AXIS: RGBColor = RGBColor(34, 34, 34);
/// plotters writes font sizes divided by this number.
const PLOTTERS_FONT: f64 = 1.24;

/// A rectangle with axes at its left and its lower side.
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
    /// Room at the left for labels and title of the upward axis, points; none: not labelled.
    pub left: Option<f64>,
    /// Room below for labels and title of the axis across, points; none: not labelled.
    pub below: Option<f64>,
    /// Lines across the frame at the ticks.
    pub grid: bool,
}

impl Frame {
    /// Place of shares of both axes, the upward one counted from below.
    pub fn place(&self, [across, up]: [f64; 2]) -> Place {
        [self.left + across * self.width, self.top + (1.0 - up) * self.height]
    }

    /// Axes with ticks, labels and titles.
    pub fn axes(&self, canvas: &mut Canvas, across: &Axis, up: &Axis, parts: Parts) -> Result<(), FigureError> {
        let mut text = String::new();
        self.plot([canvas.width, canvas.height], across, up, parts, &mut text)
            .map_err(|error| FigureError::Drawing(error.to_string()))?;
        canvas.raw(&format!("<g transform=\"scale({})\">\n", 1.0 / FINENESS));
        canvas.raw(&inner(&text));
        canvas.raw("</g>\n");
        let corners = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]].map(|share| self.place(share));
        canvas.outline(&corners, Stroke::solid(INK, 0.8));
        Ok(())
    }

    /// Ticks are given to plotters as shares, so that its own ranges and labels, which fail for extreme numbers, are not used.
    fn plot(
        &self,
        size: [f64; 2],
        across: &Axis,
        up: &Axis,
        parts: Parts,
        text: &mut String,
    ) -> Result<(), DrawingAreaErrorKind<std::io::Error>> {
        let pixels = |length: f64| (FINENESS * length).round().max(0.0) as u32;
        let (left, below) = (parts.left.unwrap_or(0.0), parts.below.unwrap_or(0.0));
        let root = SVGBackend::with_string(text, (pixels(size[0]), pixels(size[1]))).into_drawing_area();
        let shares = |axis: &Axis| Shares(axis.ticks.iter().map(|tick| tick.share).collect());
        let label = |axis: &Axis, share: f64| {
            let nearest = axis.ticks.iter().min_by(|a, b| (a.share - share).abs().total_cmp(&(b.share - share).abs()));
            nearest.map_or_else(String::new, |tick| tick.label.clone())
        };
        let mut chart = ChartBuilder::on(&root)
            .margin_left(pixels(self.left - left))
            .margin_top(pixels(self.top))
            .margin_right(pixels(size[0] - self.left - self.width))
            .margin_bottom(pixels(size[1] - self.top - self.height - below))
            .y_label_area_size(pixels(left))
            .x_label_area_size(pixels(below))
            .build_cartesian_2d(shares(across), shares(up))?;
        let font = (FAMILY, PLOTTERS_FONT * FINENESS * LABEL).into_font().color(&AXIS);
        let (across_label, up_label) = (|share: &f64| label(across, *share), |share: &f64| label(up, *share));
        let mut mesh = chart.configure_mesh();
        // An axis that is disabled loses ticks and numbers as well as its line.
        match parts.below {
            Some(_) => mesh.x_desc(across.title.clone()),
            None => mesh.disable_x_axis(),
        };
        match parts.left {
            Some(_) => mesh.y_desc(up.title.clone()),
            None => mesh.disable_y_axis(),
        };
        let grid = if parts.grid { GRID.to_rgba() } else { TRANSPARENT };
        mesh.bold_line_style(grid.stroke_width(7))
            .light_line_style(TRANSPARENT)
            .axis_style(AXIS.stroke_width(8))
            .set_all_tick_mark_size(35)
            .label_style(font.clone())
            .axis_desc_style(font)
            .x_label_formatter(&across_label)
            .y_label_formatter(&up_label);
        mesh.draw()?;
        drop(chart);
        root.present()
    }
}

/// An axis from 0 to 1 with ticks at given places.
struct Shares(Vec<f64>);

impl Ranged for Shares {
    type FormatOption = DefaultFormatting;
    type ValueType = f64;

    fn map(&self, share: &f64, (from, to): (i32, i32)) -> i32 {
        from + (f64::from(to - from) * share).round() as i32
    }

    fn key_points<Hint: KeyPointHint>(&self, hint: Hint) -> Vec<f64> {
        if hint.weight().allow_light_points() { Vec::new() } else { self.0.clone() }
    }

    fn range(&self) -> Range<f64> {
        0.0..1.0
    }
}

/// The elements inside plotters' SVG element, each on one line, superscripts raised. Their font is that of the whole figure, which
/// names a family to fall back on as well.
fn inner(svg: &str) -> String {
    let mut text = String::new();
    for line in svg.lines().filter(|line| !line.starts_with("<svg") && !line.starts_with("</svg")) {
        if line.starts_with('<') {
            text += &line.replace(&format!(" font-family=\"{FAMILY}\""), "");
        } else {
            // plotters puts what is written on a line of its own.
            text += &raised(line, FINENESS * LABEL);
        }
        if !line.starts_with("<text") && line.starts_with('<') {
            text.push('\n');
        }
    }
    text
}
