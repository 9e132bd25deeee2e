//! Values on the skins of bodies as panels side by side, on one colour scale.

use super::error::{FigureError, count, finite, mesh, some};
use super::figure::Figure;
use super::levels::ColourScale;
use super::oblique::Skin;
use super::panels::{Panel, PanelRow};
use super::scale::{behind, number};
use super::view::View;

/// Bodies in space: one or more panels with one colour scale and one scale of lengths. What is hidden is left out. Of a
/// panel with more than 1500 faces to be seen, mesh lines are left out; the more faces its values change in, the
/// coarser are its colours.
///
/// ```
/// use figures::{SolidBody, SolidPanel, Solids, View, box_faces};
/// let bit = |node: u8, place: u8| f64::from(node >> place & 1);
/// let corner = |node| [100.0 * bit(node, 2), 50.0 * bit(node, 1), 50.0 * bit(node, 0)];
/// let body = |peak: f64| SolidBody {
///     points: (0..8).map(corner).collect(),
///     faces: box_faces([2, 2, 2]),
///     values: vec![0.0, 0.0, 0.0, 0.0, 0.0, peak, 0.0, 0.0],
/// };
/// let panel = |caption: &str, peak: f64| SolidPanel { caption: caption.into(), bodies: vec![body(peak)] };
/// let solids = Solids {
///     name: "von_mises".into(),
///     title: "Von Mises stress".into(),
///     quantity: "stress".into(),
///     unit: "MPa".into(),
///     axes: ["x₁ (100 mm)".into(), "x₂ (50 mm)".into(), "x₃".into()],
///     note: "displacements × 20".into(),
///     view: View::default(),
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
    /// The direction from which they are seen.
    pub view: View,
    /// The panels, from left to right.
    pub panels: Vec<SolidPanel>,
}

/// A panel with its bodies.
#[derive(Debug, Clone, PartialEq)]
pub struct SolidPanel {
    /// What distinguishes it from the other panels.
    pub caption: String,
    /// The bodies.
    pub bodies: Vec<SolidBody>,
}

/// The skin of a body. A skin that is open is seen from both sides.
#[derive(Debug, Clone, PartialEq)]
pub struct SolidBody {
    /// Where the points are drawn; any unit of length.
    pub points: Vec<[f64; 3]>,
    /// Triangles and quadrilaterals between points, counterclockwise seen from outside.
    pub faces: Vec<Vec<usize>>,
    /// One value per point.
    pub values: Vec<f64>,
}

impl Solids {
    /// Draws it.
    ///
    /// # Errors
    /// [`FigureError`] without panels, bodies or faces; unless every face joins three or four different points, there
    /// is a value per point, all numbers are finite and the points do not all lie on one spot of the drawing.
    pub fn figure(&self) -> Result<Figure, FigureError> {
        some(&self.name, "panels", self.panels.len())?;
        for (number, panel) in self.panels.iter().enumerate() {
            some(&self.name, &format!("bodies in panel {number}"), panel.bodies.len())?;
            for (index, body) in panel.bodies.iter().enumerate() {
                body.check(&self.name, &format!("panel {number}, body {index}"))?;
            }
        }
        let values = |panel: &SolidPanel| -> Vec<f64> {
            panel.bodies.iter().flat_map(|body| body.values.iter().copied()).collect()
        };
        let scale = ColourScale::new(&self.quantity, &self.unit, self.panels.iter().flat_map(values));
        let panels = self.panels.iter().map(|panel| {
            let largest = number(values(panel).into_iter().fold(f64::NEG_INFINITY, f64::max));
            Panel {
                captions: [panel.caption.clone(), format!("largest {largest}{}", behind(&self.unit))],
                skins: panel.bodies.iter().map(SolidBody::skin).collect(),
            }
        });
        PanelRow {
            name: &self.name,
            title: &self.title,
            axes: &self.axes,
            note: &self.note,
            view: self.view,
            scale: &scale,
            panels: panels.collect(),
        }
        .figure()
    }
}

impl SolidBody {
    fn check(&self, figure: &str, part: &str) -> Result<(), FigureError> {
        mesh(figure, part, &self.points, &self.faces)?;
        count(figure, &format!("values in {part}"), self.points.len(), self.values.len())?;
        finite(figure, &format!("{part}, value"), self.values.iter().copied())
    }

    fn skin(&self) -> Skin {
        Skin::new(&self.points, &self.faces, Some(self.values.clone()))
    }
}
