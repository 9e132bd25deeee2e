//! Heights over rectangles as surfaces in space side by side, on one colour scale.

use super::error::{FigureError, grid, some};
use super::figure::Figure;
use super::levels::ColourScale;
use super::oblique::{Point, Sheet};
use super::panels::{Panel, PanelRow};
use super::scale::{behind, extent, nice_below, number};

/// Heights over rectangles, seen from the front, the right and above; magnified so that small differences are seen.
///
/// ```
/// use figures::{SurfacePanel, Surfaces};
/// let panel = |caption: &str, peak: f64| SurfacePanel {
///     caption: caption.into(),
///     counts: [3, 2],
///     size: [100.0, 50.0],
///     heights: vec![45.0, 45.0, peak, 45.0, 45.0, 45.0],
/// };
/// let surfaces = Surfaces {
///     name: "surface".into(),
///     title: "Surface".into(),
///     quantity: "height".into(),
///     unit: "mm".into(),
///     panels: vec![panel("initial", 45.0), panel("optimal", 47.0)],
/// };
/// let figure = surfaces.figure()?;
/// assert!(figure.svg.contains("heights × 10"));
/// # Ok::<(), figures::FigureError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Surfaces {
    /// Name of the figure, for files.
    pub name: String,
    /// Title above the figure; it states what is seen.
    pub title: String,
    /// What the heights are.
    pub quantity: String,
    /// Unit of heights and sides.
    pub unit: String,
    /// The panels, from left to right.
    pub panels: Vec<SurfacePanel>,
}

/// One grid of heights.
#[derive(Debug, Clone, PartialEq)]
pub struct SurfacePanel {
    /// What distinguishes it from the other panels.
    pub caption: String,
    /// Nodes n₁, n₂ along both axes, at least 2.
    pub counts: [usize; 2],
    /// Lengths between the first and the last node along both axes, > 0.
    pub size: [f64; 2],
    /// One height per node, index i·n₂ + j with i along the first axis.
    pub heights: Vec<f64>,
}

/// Differences of the heights are drawn at most as large as this share of the longest side.
const MAX_SHOWN_HEIGHT: f64 = 0.3;
/// What is drawn below the lowest height, as a share of the longest side.
const FOOT_HEIGHT: f64 = 0.06;
/// Differences relative to the heights that are no longer magnified: the colour scale does not show them either.
const MIN_MAGNIFIED_DIFFERENCE: f64 = 1e-6;

/// What is taken off all heights, and what they are multiplied by.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Magnified {
    less: f64,
    times: f64,
    foot: f64,
}

impl Surfaces {
    /// Draws it.
    ///
    /// # Errors
    /// [`FigureError`] without panels; unless a panel has at least 2 × 2 nodes, a height per node, sides of positive
    /// length, and all numbers are finite.
    pub fn figure(&self) -> Result<Figure, FigureError> {
        some(&self.name, "panels", self.panels.len())?;
        for panel in &self.panels {
            grid(&self.name, panel.counts, panel.size, ["height", "heights of a panel"], &panel.heights)?;
        }
        let heights = || self.panels.iter().flat_map(|panel| panel.heights.iter().copied());
        let scale = ColourScale::new(&self.quantity, &self.unit, heights());
        let (low, high) = extent(heights()).unwrap_or((0.0, 0.0));
        let longest = self.panels.iter().flat_map(|panel| panel.size).fold(0.0, f64::max);
        let level = high - low <= MIN_MAGNIFIED_DIFFERENCE * low.abs().max(high.abs());
        let times = if level { 1.0 } else { nice_below(MAX_SHOWN_HEIGHT * longest / (high - low)) };
        let magnified = Magnified { less: low, times, foot: -FOOT_HEIGHT * longest };
        let (times, unit) = (number(times), behind(&self.unit));
        let panels = self.panels.iter().map(|panel| {
            let [low, high] =
                extent(panel.heights.iter().copied()).map_or([0.0; 2], |(low, high)| [low, high]).map(number);
            Panel {
                captions: [panel.caption.clone(), format!("{low} to {high}{unit}")],
                bodies: vec![vec![panel.top(magnified)]],
                front: panel.walls(magnified),
            }
        });
        let side = |index: usize| {
            let side = self.panels[0].size[index];
            let name = ["x₁", "x₂"][index];
            let same = self.panels.iter().all(|panel| panel.size[index] == side);
            if same { format!("{name} ({}{unit})", number(side)) } else { name.to_owned() }
        };
        PanelRow {
            name: &self.name,
            title: &self.title,
            axes: &[side(0), side(1), "x₃".to_owned()],
            note: &format!("heights × {times}"),
            scale: &scale,
            panels: panels.collect(),
        }
        .figure()
    }
}

impl SurfacePanel {
    fn point(&self, magnified: Magnified, [i, j]: [usize; 2]) -> Point {
        let place = [i, j];
        let [x, y] = [0, 1].map(|axis| self.size[axis] * place[axis] as f64 / (self.counts[axis] - 1) as f64);
        [x, y, magnified.times * (self.heights[i * self.counts[1] + j] - magnified.less)]
    }

    fn top(&self, magnified: Magnified) -> Sheet {
        let [n1, n2] = self.counts;
        let nodes = (0..n1 * n2).map(|node| [node / n2, node % n2]);
        Sheet {
            counts: self.counts,
            points: nodes.map(|node| self.point(magnified, node)).collect(),
            values: Some(self.heights.clone()),
        }
    }

    /// Walls below the surface on the two sides of the rectangle that are turned towards the viewer, x₂ = 0 and x₁ =
    /// max.
    fn walls(&self, magnified: Magnified) -> Vec<Sheet> {
        let [n1, n2] = self.counts;
        let wall = |nodes: Vec<[usize; 2]>| {
            let points = nodes.iter().flat_map(|&node| {
                let above = self.point(magnified, node);
                [[above[0], above[1], magnified.foot], above]
            });
            Sheet { counts: [nodes.len(), 2], points: points.collect(), values: None }
        };
        vec![wall((0..n1).map(|i| [i, 0]).collect()), wall((0..n2).map(|j| [n1 - 1, j]).collect())]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn surfaces(heights: Vec<f64>) -> Surfaces {
        let counts = [3, heights.len() / 3];
        Surfaces {
            name: "s".into(),
            title: "t".into(),
            quantity: "h".into(),
            unit: "mm".into(),
            panels: vec![SurfacePanel { caption: "c".into(), counts, size: [3.0, 1.0], heights }],
        }
    }

    #[test]
    fn flat_surfaces_are_not_magnified_and_small_differences_are() {
        let flat = surfaces(vec![7.0; 6]).figure().expect("numbers");
        assert!(flat.svg.contains("heights × 1<"), "a flat surface has nothing to magnify");
        // A difference of 0.001 may be drawn up to 0.9 high: 500 times.
        let waved = surfaces(vec![7.0, 7.0, 7.001, 7.0, 7.0, 7.0]).figure().expect("numbers");
        assert!(waved.svg.contains("heights × 500<"));
        assert_eq!(waved, surfaces(vec![7.0, 7.0, 7.001, 7.0, 7.0, 7.0]).figure().expect("numbers"));
    }

    #[test]
    fn heights_that_cannot_be_drawn_are_refused() {
        assert!(matches!(surfaces(vec![f64::NAN; 6]).figure(), Err(FigureError::Number { index: 0, .. })));
        assert!(matches!(surfaces(vec![1.0; 7]).figure(), Err(FigureError::Count { .. })));
        assert!(matches!(surfaces(vec![1.0; 3]).figure(), Err(FigureError::Number { .. })));
    }
}
