//! Values on the outside of blocks as panels side by side, on one colour scale.

use super::error::{FigureError, cells, count, finite, some};
use super::figure::Figure;
use super::levels::ColourScale;
use super::oblique::Sheet;
use super::panels::{Panel, PanelRow};
use super::scale::{behind, number};

/// Blocks seen from the front, the right and above: one or more panels with one colour scale and one scale of lengths.
///
/// ```
/// use figures::{SolidBlock, SolidPanel, Solids};
/// let bit = |node: u8, place: u8| f64::from(node >> place & 1);
/// let corner = |node| [100.0 * bit(node, 2), 50.0 * bit(node, 1), 50.0 * bit(node, 0)];
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
/// # Ok::<(), figures::FigureError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Solids {
    /// Name of the figure, for files.
    pub name: String,
    /// Title above the figure; it states what is seen.
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

/// A panel with its blocks.
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
    /// [`FigureError`] without panels or blocks; unless a block has at least 2 × 2 × 2 points, a value per point, all
    /// numbers are finite and the points do not all lie on one spot of the drawing.
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
        let panels = self.panels.iter().map(|panel| {
            let values = panel.blocks.iter().flat_map(|block| block.values.iter().copied());
            let largest = number(values.fold(f64::NEG_INFINITY, f64::max));
            Panel {
                captions: [panel.caption.clone(), format!("largest {largest}{}", behind(&self.unit))],
                bodies: panel
                    .blocks
                    .iter()
                    .map(|block| faces(block.nodes, &block.points, Some(&block.values)))
                    .collect(),
                front: Vec::new(),
            }
        });
        PanelRow {
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
        cells(figure, &self.nodes)?;
        let [n1, n2, n3] = self.nodes;
        let points = n1.saturating_mul(n2).saturating_mul(n3);
        count(figure, "points of a block", points, self.points.len())?;
        count(figure, "values of a block", points, self.values.len())?;
        finite(figure, "coordinate", self.points.iter().flatten().copied())?;
        finite(figure, "value", self.values.iter().copied())
    }
}

/// The six faces of a block of nodes, turned outwards.
pub(super) fn faces(nodes: [usize; 3], points: &[[f64; 3]], values: Option<&[f64]>) -> Vec<Sheet> {
    let last = nodes.map(|count| count - 1);
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
        let counts = axes.map(|axis| nodes[axis]);
        let places = (0..counts[0] * counts[1]).map(|index| {
            let mut node = [0; 3];
            node[normal] = if end { last[normal] } else { 0 };
            node[axes[0]] = index / counts[1];
            node[axes[1]] = index % counts[1];
            (node[0] * nodes[1] + node[1]) * nodes[2] + node[2]
        });
        Sheet {
            counts,
            points: places.clone().map(|node| points[node]).collect(),
            values: values.map(|values| places.map(|node| values[node]).collect()),
        }
    };
    faces.into_iter().map(sheet).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A box with a corner at `at`, cells of length one, value = height.
    fn block(cells: [usize; 3], at: [f64; 3], bend: f64) -> SolidBlock {
        let nodes = cells.map(|count| count + 1);
        let points: Vec<[f64; 3]> = (0..nodes.iter().product())
            .map(|node| [node / (nodes[1] * nodes[2]), node / nodes[2] % nodes[1], node % nodes[2]])
            .map(|node| std::array::from_fn(|axis| at[axis] + node[axis] as f64))
            .map(|[x, y, z]: [f64; 3]| [x, y, z + bend * (x - at[0]).powi(2)])
            .collect();
        let values = points.iter().map(|point| point[2]).collect();
        SolidBlock { nodes, points, values }
    }

    fn solids(panels: Vec<Vec<SolidBlock>>) -> Solids {
        let panel = |blocks| SolidPanel { caption: "c".into(), blocks };
        Solids {
            name: "s".into(),
            title: "t".into(),
            quantity: "v".into(),
            unit: String::new(),
            axes: ["x".into(), "y".into(), "z".into()],
            note: "n".into(),
            panels: panels.into_iter().map(panel).collect(),
        }
    }

    /// Dark borders of faces.
    fn borders(figure: &Figure) -> usize {
        figure.svg.matches("stroke-width=\"0.7\"").count()
    }

    #[test]
    fn three_faces_of_a_box_are_seen_and_what_is_nearer_covers_the_rest() {
        let one = solids(vec![vec![block([2, 2, 2], [0.0; 3], 0.0)]]).figure().expect("a box");
        assert_eq!(borders(&one), 3);
        // The order in which the boxes are given does not matter: the one at the front is drawn last.
        let (back, front) = (block([2, 2, 2], [0.0, 4.0, 0.0], 0.0), block([2, 2, 2], [0.0; 3], 0.0));
        let two = solids(vec![vec![back.clone(), front.clone()]]).figure().expect("two boxes");
        assert_eq!(borders(&two), 6);
        assert_eq!(two, solids(vec![vec![front, back]]).figure().expect("two boxes"));
    }

    #[test]
    fn a_face_that_hides_a_part_of_itself_is_drawn_quad_by_quad() {
        let bent = solids(vec![vec![block([8, 2, 2], [0.0; 3], 0.6)]]).figure().expect("a bent box");
        assert_eq!(borders(&bent), 0);
    }

    #[test]
    fn one_scale_spans_all_panels() {
        let figure = solids(vec![vec![block([1, 1, 1], [0.0; 3], 0.0)], vec![block([1, 1, 8], [0.0; 3], 0.0)]]);
        let svg = figure.figure().expect("boxes").svg;
        assert!(svg.contains("largest 1<") && svg.contains("largest 8<"));
        assert_eq!(svg.matches("class=\"panel\"").count(), 2);
    }

    #[test]
    fn the_paper_s_mesh_stays_small() {
        let mut block = block([35, 35, 35], [0.0; 3], 0.002);
        block.values =
            block.points.iter().map(|[x, y, z]| (0.2 * x).sin() * (0.3 * y).cos() * (0.1 * z).sin()).collect();
        let svg = solids(vec![vec![block]]).figure().expect("a box").svg;
        assert!(svg.len() < 500_000, "{}", svg.len());
    }

    #[test]
    fn blocks_that_cannot_be_drawn_are_refused() {
        let refused = |change: fn(&mut SolidBlock)| {
            let mut block = block([1, 1, 1], [0.0; 3], 0.0);
            change(&mut block);
            solids(vec![vec![block]]).figure().expect_err("refused")
        };
        assert!(matches!(refused(|block| block.values[3] = f64::NAN), FigureError::Number { index: 3, .. }));
        assert!(matches!(refused(|block| block.nodes[0] = 1), FigureError::Number { .. }));
        assert!(matches!(refused(|block| block.points.truncate(3)), FigureError::Count { .. }));
        assert!(matches!(refused(|block| block.points.fill([1.0; 3])), FigureError::Number { .. }));
        assert!(matches!(solids(vec![]).figure(), Err(FigureError::Empty { .. })));
    }
}
