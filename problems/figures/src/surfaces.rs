//! Heights over a plane as surfaces in space side by side, on one colour scale.

use super::error::{FigureError, finite, some};
use super::figure::Figure;
use super::levels::ColourScale;
use super::oblique::Skin;
use super::panels::{Panel, PanelRow};
use super::plan::Plan;
use super::regions::{around, sides};
use super::scale::{behind, extent, nice_below, number};
use super::view::{Point, View};

/// Heights over a plane, seen from the front, the right and above; magnified so that small differences are seen.
///
/// ```
/// use figures::{SurfacePanel, Surfaces, grid_faces};
/// let panel = |caption: &str, peak: f64| SurfacePanel {
///     caption: caption.into(),
///     points: vec![
///         [0.0, 0.0, 45.0], [0.0, 50.0, 45.0],
///         [50.0, 0.0, peak], [50.0, 50.0, 45.0],
///         [100.0, 0.0, 45.0], [100.0, 50.0, 45.0],
///     ],
///     faces: grid_faces([3, 2]),
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

/// One surface.
#[derive(Debug, Clone, PartialEq)]
pub struct SurfacePanel {
    /// What distinguishes it from the other panels.
    pub caption: String,
    /// The points; the third coordinate is the height.
    pub points: Vec<[f64; 3]>,
    /// Triangles and quadrilaterals between points, side by side seen from above.
    pub faces: Vec<Vec<usize>>,
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
    /// [`FigureError`] without panels or faces; unless every face joins three or four different points, the points of a
    /// panel have an extent along both axes, and all numbers are finite.
    pub fn figure(&self) -> Result<Figure, FigureError> {
        some(&self.name, "panels", self.panels.len())?;
        let plans: Vec<Vec<[f64; 2]>> = self.panels.iter().map(SurfacePanel::plan).collect();
        let plans = plans.iter().zip(&self.panels).enumerate().map(|(index, (plan, panel))| {
            finite(&self.name, &format!("panel {index}, x₃ of point"), panel.heights())?;
            Plan::new(&self.name, &format!("panel {index}"), plan, &panel.faces)
        });
        let plans = plans.collect::<Result<Vec<Plan<'_>>, FigureError>>()?;
        let scale = ColourScale::new(&self.quantity, &self.unit, self.panels.iter().flat_map(SurfacePanel::heights));
        let (low, high) = extent(self.panels.iter().flat_map(SurfacePanel::heights)).unwrap_or((0.0, 0.0));
        let longest = plans.iter().flat_map(|plan| plan.size).fold(0.0, f64::max);
        let level = high - low <= MIN_MAGNIFIED_DIFFERENCE * low.abs().max(high.abs());
        let times = if level { 1.0 } else { nice_below(MAX_SHOWN_HEIGHT * longest / (high - low)) };
        let magnified = Magnified { less: low, times, foot: -FOOT_HEIGHT * longest };
        let (times, unit) = (number(times), behind(&self.unit));
        let panels = self.panels.iter().zip(&plans).map(|(panel, plan)| {
            let [low, high] = extent(panel.heights()).map_or([0.0; 2], |(low, high)| [low, high]).map(number);
            Panel {
                captions: [panel.caption.clone(), format!("{low} to {high}{unit}")],
                skins: panel.skins(magnified, plan).into(),
            }
        });
        let side = |index: usize| {
            let side = number(plans[0].size[index]);
            let name = ["x₁", "x₂"][index];
            let same = plans.iter().all(|plan| number(plan.size[index]) == side);
            if same { format!("{name} ({side}{unit})") } else { name.to_owned() }
        };
        PanelRow {
            name: &self.name,
            title: &self.title,
            axes: &[side(0), side(1), "x₃".to_owned()],
            note: &format!("heights × {times}"),
            view: View::default(),
            scale: &scale,
            panels: panels.collect(),
        }
        .figure()
    }
}

impl SurfacePanel {
    fn heights(&self) -> Vec<f64> {
        self.points.iter().map(|point| point[2]).collect()
    }

    fn plan(&self) -> Vec<[f64; 2]> {
        self.points.iter().map(|[x, y, _]| [*x, *y]).collect()
    }

    /// The surface, and below its sides walls, which are grey.
    fn skins(&self, magnified: Magnified, plan: &Plan<'_>) -> [Skin; 2] {
        let raised = |[x, y, height]: &Point| [*x, *y, magnified.times * (height - magnified.less)];
        let top: Vec<Point> = self.points.iter().map(raised).collect();
        let foot = top.iter().map(|[x, y, _]| [*x, *y, magnified.foot]);
        let walls = top.iter().copied().chain(foot).collect();
        let sides = sides(&plan.faces);
        let ends =
            plan.faces.iter().flat_map(|face| around(face)).filter(|(a, b)| sides[&[*a.min(b), *a.max(b)]].len() == 1);
        // Counterclockwise faces have the outside at the right of their sides.
        let wall = |(a, b): (usize, usize)| vec![a + top.len(), b + top.len(), b, a];
        let faces = ends.map(wall).collect();
        [
            Skin { faces: plan.faces.clone(), values: Some(self.heights()), points: top, two_sided: true },
            Skin { points: walls, faces, values: None, two_sided: false },
        ]
    }
}
