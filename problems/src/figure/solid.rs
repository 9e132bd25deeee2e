//! Values on the outside of blocks as panels side by side, on one colour scale.

use super::error::{count, finite, some};
use super::levels::ColourScale;
use super::oblique::Sheet;
use super::panels::{Panel, Row};
use super::scale::number;
use super::{Figure, FigureError};

/// Blocks seen from the front, the right and above: one or more panels with one colour scale and one scale of lengths.
///
/// ```
/// use problems::figure::{SolidBlock, SolidPanel, Solids};
/// let corner = |node: u8| [100.0 * f64::from(node >> 2 & 1), 50.0 * f64::from(node >> 1 & 1), 50.0 * f64::from(node & 1)];
/// let block = |peak: f64| SolidBlock {
///     nodes: [2, 2, 2],
///     points: (0..8).map(corner).collect(),
///     values: vec![0.0, 0.0, 0.0, 0.0, 0.0, peak, 0.0, 0.0],
/// };
/// let panel = |caption: &str, peak: f64| SolidPanel { caption: caption.into(), blocks: vec![block(peak)] };
/// let solids = Solids {
///     name: "von_mises".into(),
///     title: "Von Mises stress".into(),
///     quantity: "stress".into(),
///     unit: "MPa".into(),
///     axes: ["x₁ (100 mm)".into(), "x₂ (50 mm)".into(), "x₃".into()],
///     note: "displacements × 20".into(),
///     panels: vec![panel("initial", 14_809.0), panel("optimal", 4082.0)],
/// };
/// let figure = solids.figure()?;
/// assert!(figure.svg.contains("largest 4082 MPa"));
/// # Ok::<(), problems::figure::FigureError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Solids {
    /// Name of the figure, for files.
    pub name: String,
    /// What is seen.
    pub title: String,
    /// What the values are.
    pub quantity: String,
    /// Unit of the values.
    pub unit: String,
    /// What is written at the arrows of the three axes: names, lengths.
    pub axes: [String; 3],
    /// A line below: how the points were magnified or moved.
    pub note: String,
    /// The panels, from left to right.
    pub panels: Vec<SolidPanel>,
}

/// Some blocks.
#[derive(Debug, Clone, PartialEq)]
pub struct SolidPanel {
    /// What distinguishes it from the other panels.
    pub caption: String,
    /// The blocks; they must not interlock.
    pub blocks: Vec<SolidBlock>,
}

/// A block of points, neighbours in the order of the axes (right-handed).
#[derive(Debug, Clone, PartialEq)]
pub struct SolidBlock {
    /// Points n₁, n₂, n₃ along the axes, at least 2.
    pub nodes: [usize; 3],
    /// Where the points are drawn, index (i·n₂ + j)·n₃ + k; any unit of length.
    pub points: Vec<[f64; 3]>,
    /// One value per point.
    pub values: Vec<f64>,
}

impl Solids {
    /// Draws it.
    ///
    /// # Errors
    /// [`FigureError`] without panels or blocks; unless a block has at least 2 × 2 × 2 points, a value per point, all numbers
    /// are finite and the points do not all lie on one spot of the drawing.
    pub fn figure(&self) -> Result<Figure, FigureError> {
        some(&self.name, "panels", self.panels.len())?;
        for panel in &self.panels {
            some(&self.name, "blocks of a panel", panel.blocks.len())?;
            for block in &panel.blocks {
                block.check(&self.name)?;
            }
        }
        let blocks = || self.panels.iter().flat_map(|panel| panel.blocks.iter());
        let scale =
            ColourScale::new(&self.quantity, &self.unit, blocks().flat_map(|block| block.values.iter().copied()));
        let space = if self.unit.is_empty() { "" } else { " " };
        let panels = self.panels.iter().map(|panel| {
            let values = panel.blocks.iter().flat_map(|block| block.values.iter().copied());
            let largest = number(values.fold(f64::NEG_INFINITY, f64::max));
            Panel {
                captions: [panel.caption.clone(), format!("largest {largest}{space}{}", self.unit)],
                bodies: panel.blocks.iter().map(SolidBlock::sheets).collect(),
                front: Vec::new(),
            }
        });
        Row {
            name: &self.name,
            title: &self.title,
            axes: &self.axes,
            note: &self.note,
            scale: &scale,
            panels: panels.collect(),
        }
        .figure()
    }
}

impl SolidBlock {
    fn check(&self, figure: &str) -> Result<(), FigureError> {
        for (index, nodes) in self.nodes.into_iter().enumerate() {
            if nodes < 2 {
                let (what, value, allowed) = ("points along axis", nodes as f64, "numbers from 2");
                return Err(FigureError::Number { figure: figure.into(), what, index, value, allowed });
            }
        }
        let [n1, n2, n3] = self.nodes;
        let points = n1.saturating_mul(n2).saturating_mul(n3);
        count(figure, "points of a block", points, self.points.len())?;
        count(figure, "values of a block", points, self.values.len())?;
        finite(figure, "coordinate", self.points.iter().flatten().copied())?;
        finite(figure, "value", self.values.iter().copied())
    }

    /// The six faces, turned outwards.
    fn sheets(&self) -> Vec<Sheet> {
        let last = self.nodes.map(|count| count - 1);
        // Axis a face is normal to, at its end or beginning; first × second axis of the face points outwards.
        let faces = [
            (2, true, [0, 1]),
            (2, false, [1, 0]),
            (0, true, [1, 2]),
            (0, false, [2, 1]),
            (1, true, [2, 0]),
            (1, false, [0, 2]),
        ];
        let sheet = |(normal, end, axes): (usize, bool, [usize; 2])| {
            let counts = axes.map(|axis| self.nodes[axis]);
            let nodes = (0..counts[0] * counts[1]).map(|index| {
                let mut node = [0; 3];
                node[normal] = if end { last[normal] } else { 0 };
                node[axes[0]] = index / counts[1];
                node[axes[1]] = index % counts[1];
                (node[0] * self.nodes[1] + node[1]) * self.nodes[2] + node[2]
            });
            Sheet {
                counts,
                points: nodes.clone().map(|node| self.points[node]).collect(),
                values: Some(nodes.map(|node| self.values[node]).collect()),
            }
        };
        faces.into_iter().map(sheet).collect()
    }
}
