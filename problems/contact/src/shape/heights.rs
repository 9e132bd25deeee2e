//! The height surface that shapes the lower block: heights of its columns of nodes are linear in the controls.

use crate::body::mesh::Grid;
use crate::error::SceneError;
use crate::shape::{ShapeBounds, ShapeMap, SplineKind, SplineSurface};
use serde::{Deserialize, Serialize};

/// A spline surface over the base of a block, with its bounds and its start.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct HeightShape {
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

/// x₃ of node (i, j, k) is F_α·k/n₃; x₁ and x₂ do not change.
pub(crate) fn height_map(surface: &SplineSurface, grid: &Grid) -> ShapeMap {
    let heights = surface.height_map(grid);
    let [_, _, layers] = grid.nodes();
    let base = grid.places().flat_map(|[x1, x2]| std::iter::repeat_n([x1, x2, 0.0], layers)).collect();
    let rows = grid.columns().flat_map(|(i, j)| {
        let weights = heights.weights(i, j);
        (0..layers).flat_map(move |k| {
            let share = k as f64 / (layers - 1) as f64;
            let scaled = weights.iter().map(|&(control, weight)| (control, share * weight));
            [vec![], vec![], if k == 0 { vec![] } else { scaled.collect() }]
        })
    });
    ShapeMap::new(base, surface.control_count(), rows)
}
