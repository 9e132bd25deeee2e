//! Classes of the nodes of plane grids, with arrows at the nodes: panels side by side.

use super::canvas::{Canvas, INK, LABEL, Place, Stroke, TITLE, text_width};
use super::chart::{Frame, Parts, ROOM_BELOW};
use super::error::{FigureError, below, cells, count, finite, positive, some};
use super::figure::Figure;
use super::nodes::PlaneGrid;
use super::panel_layout::{PanelLayout, ROOM_LEFT};
use super::scale::{Axis, behind, nice_below, number};

/// Every node is in one of a few classes, which have a colour each. Where there are arrows, their middles are at the
/// nodes, all on one scale; on fine grids only some are drawn.
///
/// ```
/// use figures::{ClassPanel, Classes};
/// let classes = Classes {
///     name: "status".into(),
///     title: "Contact status".into(),
///     axes: ["x₁ (mm)".into(), "x₂ (mm)".into()],
///     classes: vec!["open".into(), "stick".into(), "slip".into()],
///     arrows: Some(("traction".into(), "MPa".into())),
///     panels: vec![ClassPanel {
///         caption: "start".into(),
///         counts: [2, 2],
///         origin: [0.0, 0.0],
///         size: [10.0, 10.0],
///         classes: vec![0, 1, 2, 2],
///         arrows: vec![[0.0, 0.0], [5.0, 0.0], [10.0, 0.0], [0.0, 10.0]],
///     }],
/// };
/// let figure = classes.figure()?;
/// assert!(figure.svg.contains("open 1, stick 1, slip 2"));
/// assert!(figure.svg.contains("<title>node (1, 0) at (10, 0): slip, traction (10, 0) MPa</title>"));
/// # Ok::<(), figures::FigureError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Classes {
    /// Name of the figure, for files.
    pub name: String,
    /// Title above the figure; it states what is seen.
    pub title: String,
    /// Names and units of both axes.
    pub axes: [String; 2],
    /// Names of the classes, palest colour first.
    pub classes: Vec<String>,
    /// What the arrows are, and their unit; none: there are no arrows.
    pub arrows: Option<(String, String)>,
    /// The panels, from left to right.
    pub panels: Vec<ClassPanel>,
}

/// One grid of nodes.
#[derive(Debug, Clone, PartialEq)]
pub struct ClassPanel {
    /// What distinguishes it from the other panels.
    pub caption: String,
    /// Nodes n₁, n₂ along both axes, at least 2.
    pub counts: [usize; 2],
    /// Position of the first node.
    pub origin: [f64; 2],
    /// Lengths between the first and the last node along both axes, > 0.
    pub size: [f64; 2],
    /// The class of every node, index i·n₂ + j with i along the first axis.
    pub classes: Vec<usize>,
    /// The arrow of every node along both axes; as many as nodes where the figure has arrows.
    pub arrows: Vec<[f64; 2]>,
}

/// Colours of the classes; black arrows are seen on all.
const COLOURS: [&str; 5] = ["#e9e9e9", "#8fbbe3", "#f2b277", "#9fd3a8", "#d3a6d9"];
/// Most arrows along an axis.
const MAX_ARROWS: usize = 16;
/// Length of the longest arrow, in distances of arrows.
const LONGEST: f64 = 1.1;

impl Classes {
    /// Draws it.
    ///
    /// # Errors
    /// [`FigureError`] without panels or classes; unless a panel has at least 2 × 2 nodes, a class per node that
    /// exists, an arrow per node if there are arrows, sides of positive length, and all numbers are finite.
    pub fn figure(&self) -> Result<Figure, FigureError> {
        some(&self.name, "panels", self.panels.len())?;
        some(&self.name, "classes", self.classes.len())?;
        self.panels.iter().try_for_each(|panel| self.check(panel))?;
        let grids: Vec<PlaneGrid> = self.panels.iter().map(ClassPanel::grid).collect();
        let captions: Vec<[String; 2]> =
            self.panels.iter().map(|panel| [panel.caption.clone(), self.counted(panel)]).collect();
        let layout = PanelLayout::new(&grids, &captions, 0.0);
        let arrows = self.arrow_scale(&layout);
        let names = self.classes.iter().map(|name| text_width(name, LABEL));
        let label = arrows.iter().map(|(_, _, label)| text_width(label, LABEL));
        let legend = names.chain(label).fold(0.0, f64::max) + 54.0;
        let width = (layout.right + legend).max(text_width(&self.title, TITLE) + 32.0);
        let mut canvas = Canvas::new(width, layout.foot + ROOM_BELOW + 8.0);
        canvas.text([16.0, 22.0], TITLE, &self.title);
        let end = layout.frames[0].top + 22.0 * self.classes.len() as f64 + 50.0;
        layout.write(&mut canvas, &captions, end);
        for (index, panel) in self.panels.iter().enumerate() {
            let points = arrows.as_ref().map_or(0.0, |(points, ..)| *points);
            self.draw(&mut canvas, layout.frames[index], panel, points);
        }
        let (x, mut y) = (layout.right, layout.frames[0].top + 2.0);
        for (index, name) in self.classes.iter().enumerate() {
            canvas.rectangle([x, y], [16.0, 12.0], colour(index));
            canvas.outline(&[[x, y], [x + 16.0, y], [x + 16.0, y + 12.0], [x, y + 12.0]], Stroke::solid(INK, 0.6));
            canvas.text([x + 24.0, y + 10.0], LABEL, name);
            y += 22.0;
        }
        if let Some((points, value, label)) = arrows {
            canvas.arrow([[x, y + 14.0], [x + points * value, y + 14.0]], Stroke::solid(INK, 1.0));
            canvas.text([x, y + 34.0], LABEL, &label);
        }
        Ok(Figure::new(&self.name, &self.title, canvas))
    }

    fn check(&self, panel: &ClassPanel) -> Result<(), FigureError> {
        cells(&self.name, &panel.counts)?;
        let nodes = panel.counts[0].saturating_mul(panel.counts[1]);
        count(&self.name, "classes of a panel", nodes, panel.classes.len())?;
        count(&self.name, "arrows of a panel", if self.arrows.is_some() { nodes } else { 0 }, panel.arrows.len())?;
        below(&self.name, "class", &panel.classes, self.classes.len())?;
        finite(&self.name, "arrow", panel.arrows.iter().flatten().copied())?;
        finite(&self.name, "origin", panel.origin)?;
        positive(&self.name, "side", panel.size)
    }

    /// "open 4, stick 2"
    fn counted(&self, panel: &ClassPanel) -> String {
        let count = |class: usize| panel.classes.iter().filter(|other| **other == class).count();
        let parts = self.classes.iter().enumerate().map(|(class, name)| format!("{name} {}", count(class)));
        parts.collect::<Vec<_>>().join(", ")
    }

    /// Points per unit of the arrows, the value of the arrow in the legend and its label; none without arrows.
    fn arrow_scale(&self, layout: &PanelLayout) -> Option<(f64, f64, String)> {
        let (quantity, unit) = self.arrows.as_ref()?;
        let lengths = self.panels.iter().flat_map(|panel| &panel.arrows).map(|[a, b]| a.hypot(*b));
        let largest = lengths.fold(0.0, f64::max);
        let distance = self.panels.iter().zip(&layout.frames).map(|(panel, frame)| {
            let [n1, n2] = panel.counts.map(|nodes| (nodes - 1) as f64);
            panel.stride() as f64 * (frame.width / n1).min(frame.height / n2)
        });
        let longest = LONGEST * distance.fold(f64::INFINITY, f64::min);
        if largest == 0.0 {
            return Some((0.0, 0.0, format!("no {quantity}")));
        }
        let value = nice_below(largest);
        Some((longest / largest, value, format!("{quantity} {}{}", number(value), behind(unit))))
    }

    fn draw(&self, canvas: &mut Canvas, frame: Frame, panel: &ClassPanel, points: f64) {
        let [n1, n2] = panel.counts;
        let last = [n1 - 1, n2 - 1].map(|nodes| nodes as f64);
        let place = |[i, j]: [f64; 2]| frame.place([(i / last[0]).clamp(0.0, 1.0), (j / last[1]).clamp(0.0, 1.0)]);
        let cell = |node: usize| -> [Place; 4] {
            let [i, j] = [(node / n2) as f64, (node % n2) as f64];
            [[i - 0.5, j - 0.5], [i + 0.5, j - 0.5], [i + 0.5, j + 0.5], [i - 0.5, j + 0.5]].map(place)
        };
        for class in 0..self.classes.len() {
            let nodes = (0..n1 * n2).filter(|node| panel.classes[*node] == class);
            let areas: Vec<[Place; 4]> = nodes.map(cell).collect();
            canvas.area(colour(class), areas.iter().map(<[Place; 4]>::as_slice));
        }
        let axis = |index: usize| {
            let ends = [panel.origin[index], panel.origin[index] + panel.size[index]];
            Axis::linear(&self.axes[index], "", ends, 0.0, 5)
        };
        frame.axes(canvas, &axis(0), &axis(1), Parts { left: ROOM_LEFT, grid: false });
        for (node, [a, b]) in panel.arrows.iter().enumerate() {
            let drawn = [node / n2, node % n2].iter().all(|index| index.is_multiple_of(panel.stride()));
            let [x, y] = place([(node / n2) as f64, (node % n2) as f64]);
            let [dx, dy] = [points * a, -points * b];
            // Shorter ones are no arrows any more.
            if drawn && dx.hypot(dy) > 0.7 {
                let [dx, dy] = [0.5 * dx, 0.5 * dy];
                // Arrows at the edges are moved inwards: beyond the edges stand captions and labels.
                let x = inside(x, dx.abs(), [frame.left, frame.left + frame.width]);
                let y = inside(y, dy.abs(), [frame.top, frame.top + frame.height]);
                canvas.arrow([[x - dx, y - dy], [x + dx, y + dy]], Stroke::solid(INK, 0.9));
            }
        }
        let text = |node: usize| {
            let class = &self.classes[panel.classes[node]];
            self.arrows.as_ref().map_or_else(
                || class.clone(),
                |(quantity, unit)| {
                    let [a, b] = panel.arrows[node].map(number);
                    format!("{class}, {quantity} ({a}, {b}){}", behind(unit))
                },
            )
        };
        panel.grid().name_nodes(canvas, frame, text);
    }
}

/// The middle of a line of this half length, moved so that the line lies between two ends; the middle between them if
/// it is longer.
fn inside(middle: f64, half: f64, [low, high]: [f64; 2]) -> f64 {
    if high - low < 2.0 * half { 0.5 * (low + high) } else { middle.clamp(low + half, high - half) }
}

fn colour(class: usize) -> &'static str {
    COLOURS[class % COLOURS.len()]
}

impl ClassPanel {
    fn grid(&self) -> PlaneGrid {
        PlaneGrid { counts: self.counts, origin: self.origin, size: self.size }
    }

    /// Every how many nodes an arrow is drawn.
    fn stride(&self) -> usize {
        self.counts.map(|nodes| nodes.div_ceil(MAX_ARROWS)).into_iter().max().unwrap_or(1)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn classes(arrows: bool) -> Classes {
        let nodes = 40 * 3;
        let panel = ClassPanel {
            caption: "c".into(),
            counts: [40, 3],
            origin: [0.0; 2],
            size: [40.0, 3.0],
            classes: (0..nodes).map(|node| node % 2).collect(),
            arrows: if arrows { vec![[1.0, 2.0]; nodes] } else { vec![] },
        };
        Classes {
            name: "s".into(),
            title: "t".into(),
            axes: ["x".into(), "y".into()],
            classes: vec!["open".into(), "closed".into()],
            arrows: arrows.then(|| ("traction".into(), "MPa".into())),
            panels: vec![panel],
        }
    }

    #[test]
    fn arrows_are_thinned_on_fine_grids_and_absent_where_there_are_none() {
        let heads = |figure: &Figure| figure.svg.matches(&format!("fill=\"{INK}\" d=\"M")).count();
        let (with, without) = (classes(true).figure().expect("numbers"), classes(false).figure().expect("numbers"));
        // Every third node: 14 × 1, and the one of the legend.
        assert_eq!((heads(&with), heads(&without)), (15, 0));
        assert!(with.svg.contains("traction 2 MPa<") && !without.svg.contains("MPa"));
        assert_eq!(without.svg.matches("<title>node").count(), 120);
    }

    #[test]
    fn arrows_stay_inside_their_panel() {
        let ends = [10.0, 20.0];
        for (middle, half, expected) in [(10.0, 2.0, 12.0), (15.0, 2.0, 15.0), (20.0, 2.0, 18.0), (10.0, 6.0, 15.0)] {
            assert_eq!(inside(middle, half, ends), expected, "{middle}");
        }
    }

    #[test]
    fn classes_that_do_not_exist_and_arrows_that_are_missing_are_refused() {
        let mut wrong = classes(true);
        wrong.panels[0].classes[7] = 2;
        assert!(matches!(wrong.figure(), Err(FigureError::Number { index: 7, .. })));
        let mut wrong = classes(true);
        wrong.panels[0].arrows.pop();
        assert!(matches!(wrong.figure(), Err(FigureError::Count { .. })));
        let mut wrong = classes(false);
        wrong.panels[0].size[1] = 0.0;
        assert!(matches!(wrong.figure(), Err(FigureError::Number { .. })));
    }
}
