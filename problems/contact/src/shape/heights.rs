//! The height surface that shapes a block: heights of its columns of nodes are linear in the controls.

use crate::body::mesh::BlockFace;
use crate::error::SceneError;
use crate::scene::Block;
use crate::shape::{BodyMap, SplineKind, SplineSurface};
use serde::{Deserialize, Serialize};

/// The face of a block that a height surface shapes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema), schemars(rename = "ShapedFaceName", transform = crate::schema::names_only))]
pub enum ShapedFace {
    /// The upper surface.
    #[default]
    Top,
    /// The lower surface.
    Bottom,
}

impl ShapedFace {
    /// The face of the block.
    pub fn block_face(self) -> BlockFace {
        match self {
            Self::Top => BlockFace::Top,
            Self::Bottom => BlockFace::Bottom,
        }
    }
}

/// The constants of the admissible set U.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct ShapeBounds {
    /// C₀, smallest control height, mm.
    pub minimum_height: f64,
    /// C₁, bound of the slope between neighbouring controls.
    pub slope: f64,
    /// Least and largest volume [C₂₁, C₂₂], mm³.
    pub volume: [f64; 2],
}

/// A spline surface over the base of a block, with its bounds and its start.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct HeightShape {
    /// The face that it shapes.
    pub face: ShapedFace,
    /// Kind of the spline surface.
    pub spline: SplineKind,
    /// Control points along x₁, x₂.
    pub control_points: [usize; 2],
    /// Constants of the admissible set.
    pub bounds: ShapeBounds,
    /// All controls at the start, mm.
    pub start_height: f64,
    /// What the bending of the surface counts in the objective, unit of Θ; the bending has no unit. 0: nothing.
    pub fairness: f64,
}

impl HeightShape {
    /// The spline surface.
    ///
    /// # Errors
    /// [`SceneError::OutOfRange`] when there are too few control points for the degree.
    pub fn surface(&self) -> Result<SplineSurface, SceneError> {
        SplineSurface::new(self.spline, self.control_points)
    }
}

/// x₃ of node (i, j, k) is interpolated between the two faces, of which one is F_α; x₁ and x₂ do not change.
pub(crate) fn height_map(surface: &SplineSurface, block: &Block, face: ShapedFace) -> BodyMap {
    let grid = block.grid();
    let heights = surface.height_map(&grid);
    let [_, _, layers] = grid.nodes();
    let [bottom, top] = block.heights();
    let of_top = move |k: usize| k as f64 / (layers - 1) as f64;
    // What of a height the shaped face and the other one have at layer k.
    let shares = move |k: usize| match face {
        ShapedFace::Top => [of_top(k), 1.0 - of_top(k)],
        ShapedFace::Bottom => [1.0 - of_top(k), of_top(k)],
    };
    let fixed = if face == ShapedFace::Top { bottom } else { top };
    let base = grid.places().zip(&fixed).flat_map(|([x1, x2], &height)| {
        (0..layers).map(move |k| {
            let share = shares(k)[1];
            [x1, x2, if share == 0.0 { 0.0 } else { share * height }]
        })
    });
    let rows = grid.columns().flat_map(|(i, j)| {
        let weights = heights.weights(i, j);
        (0..layers).flat_map(move |k| {
            let share = shares(k)[0];
            let scaled = weights.iter().map(|&(control, weight)| (control, share * weight));
            [vec![], vec![], if share == 0.0 { vec![] } else { scaled.collect() }]
        })
    });
    BodyMap { base: base.collect(), middles: 0, controls: surface.control_count(), rows: rows.collect() }
}
