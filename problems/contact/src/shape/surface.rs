//! F_α(x₁, x₂) = Σ α_ij N_i(x₁/a) N_j(x₂/b): heights linear in the controls.

use crate::body::mesh::Grid;
use crate::error::SceneError;
use crate::shape::bspline::Basis;

/// Which spline carries the surface.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub enum SplineKind {
    /// Clamped uniform B-spline of this degree.
    BSpline(usize),
    /// Bézier surface: the degree is the number of control points along the axis less one.
    Bezier,
}

/// A tensor-product spline surface with m₁ × m₂ control heights, index i·m₂ + j.
#[derive(Debug, Clone, PartialEq)]
pub struct SplineSurface {
    bases: [Basis; 2],
}

/// Basis values of the columns of a grid: the linear map from controls to heights.
#[derive(Debug, Clone)]
pub struct HeightMap {
    along: [Vec<Vec<f64>>; 2],
    counts: [usize; 2],
}

impl SplineSurface {
    /// A surface of `counts` control points per axis.
    ///
    /// # Errors
    /// [`SceneError::OutOfRange`] when there are too few control points for the degree.
    pub fn new(kind: SplineKind, counts: [usize; 2]) -> Result<Self, SceneError> {
        let basis = |count: usize| {
            let degree = match kind {
                SplineKind::BSpline(degree) => degree,
                SplineKind::Bezier => count.saturating_sub(1),
            };
            Basis::clamped_uniform(degree, count)
        };
        Ok(Self { bases: [basis(counts[0])?, basis(counts[1])?] })
    }

    /// Control points per axis.
    pub fn counts(&self) -> [usize; 2] {
        [self.bases[0].count(), self.bases[1].count()]
    }

    /// Number of controls.
    pub fn control_count(&self) -> usize {
        self.bases[0].count() * self.bases[1].count()
    }

    /// Places (x₁, x₂) of the controls, spread evenly over a base of `size` mm.
    pub fn places(&self, size: [f64; 2]) -> impl Iterator<Item = [f64; 2]> + use<> {
        let counts = self.counts();
        let along = move |axis: usize, index: usize| size[axis] * index as f64 / (counts[axis] - 1) as f64;
        (0..counts[0]).flat_map(move |i| (0..counts[1]).map(move |j| [along(0, i), along(1, j)]))
    }

    /// ∫∫ N_i N_j over the unit square, per control.
    pub fn integrals(&self) -> Vec<f64> {
        let (first, second) = (self.bases[0].integrals(), self.bases[1].integrals());
        first.iter().flat_map(|a| second.iter().map(move |b| a * b)).collect()
    }

    /// The map from controls to the heights of the columns of `grid`.
    pub fn height_map(&self, grid: &Grid) -> HeightMap {
        let along = std::array::from_fn(|axis| {
            let cells = grid.cells[axis];
            (0..=cells).map(|index| self.bases[axis].values(index as f64 / cells as f64)).collect()
        });
        HeightMap { along, counts: self.counts() }
    }
}

impl HeightMap {
    /// Heights of all columns of the grid, mm.
    pub fn heights(&self, controls: &[f64]) -> Vec<f64> {
        let mut heights = Vec::with_capacity(self.along[0].len() * self.along[1].len());
        for first in &self.along[0] {
            // Contract the first axis once per grid line.
            let line: Vec<f64> = (0..self.counts[1])
                .map(|j| first.iter().enumerate().map(|(i, value)| value * controls[i * self.counts[1] + j]).sum())
                .collect();
            for second in &self.along[1] {
                heights.push(second.iter().zip(&line).map(|(value, control)| value * control).sum());
            }
        }
        heights
    }

    /// The transposed map: from sensitivities of the heights to sensitivities of the controls.
    pub fn pull_back(&self, sensitivities: &[f64]) -> Vec<f64> {
        let mut controls = vec![0.0; self.counts[0] * self.counts[1]];
        let columns = self.along[1].len();
        for (line, first) in self.along[0].iter().enumerate() {
            let mut contracted = vec![0.0; self.counts[1]];
            for (column, second) in self.along[1].iter().enumerate() {
                for (entry, value) in contracted.iter_mut().zip(second) {
                    *entry += value * sensitivities[line * columns + column];
                }
            }
            for (i, value) in first.iter().enumerate() {
                for (j, entry) in contracted.iter().enumerate() {
                    controls[i * self.counts[1] + j] += value * entry;
                }
            }
        }
        controls
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn constant_controls_give_a_flat_surface_and_the_maps_are_adjoint() {
        let grid = Grid { cells: [7, 5, 2], size: [100.0, 50.0] };
        let surface = SplineSurface::new(SplineKind::BSpline(3), [6, 5]).expect("valid");
        let map = surface.height_map(&grid);
        assert!(map.heights(&[4.0; 30]).iter().all(|height| (height - 4.0).abs() < 1e-14));
        let controls: Vec<f64> = (0..30).map(|i| (i as f64).sin()).collect();
        let dual: Vec<f64> = (0..48).map(|i| (0.3 * i as f64).cos()).collect();
        let left: f64 = map.heights(&controls).iter().zip(&dual).map(|(a, b)| a * b).sum();
        let right: f64 = map.pull_back(&dual).iter().zip(&controls).map(|(a, b)| a * b).sum();
        assert!((left - right).abs() < 1e-12);
        assert!((surface.integrals().iter().sum::<f64>() - 1.0).abs() < 1e-14);
    }
}
