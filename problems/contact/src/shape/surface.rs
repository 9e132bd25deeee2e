//! F_α(x₁, x₂) = Σ α_ij N_i(x₁/a) N_j(x₂/b): heights linear in the controls.

use crate::body::mesh::Grid;
use crate::error::SceneError;
use crate::shape::bspline::Basis;
use crate::shape::pieces::Pieces;

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

    pub(crate) fn of_bases(bases: [Basis; 2]) -> Self {
        Self { bases }
    }

    pub(crate) fn bases(&self) -> &[Basis; 2] {
        &self.bases
    }

    /// Control points per axis.
    pub fn counts(&self) -> [usize; 2] {
        [self.bases[0].count(), self.bases[1].count()]
    }

    /// The number of controls of the surface.
    pub fn control_count(&self) -> usize {
        self.bases[0].count() * self.bases[1].count()
    }

    /// Places (x₁, x₂) of the controls, spread evenly over a base of `size` mm.
    pub fn places(&self, size: [f64; 2]) -> impl Iterator<Item = [f64; 2]> + use<> {
        let counts = self.counts();
        let along = move |axis: usize, index: usize| size[axis] * index as f64 / (counts[axis] - 1) as f64;
        (0..counts[0]).flat_map(move |i| (0..counts[1]).map(move |j| [along(0, i), along(1, j)]))
    }

    /// Places of the control points of the surface x₃ = Σ α_ij N_i N_j along both axes, mm, as a STEP file has them:
    /// the means of p neighbouring knots (Greville abscissae), with which Σ x_i N_i = x.
    pub fn control_places(&self, size: [f64; 2]) -> [Vec<f64>; 2] {
        std::array::from_fn(|axis| self.bases[axis].greville().into_iter().map(|place| size[axis] * place).collect())
    }

    /// ∫∫ N_i N_j over the unit square, per control.
    pub fn integrals(&self) -> Vec<f64> {
        let (first, second) = (self.bases[0].integrals(), self.bases[1].integrals());
        first.iter().flat_map(|a| second.iter().map(move |b| a * b)).collect()
    }

    /// Degrees along both axes.
    pub fn degrees(&self) -> [usize; 2] {
        [self.bases[0].degree(), self.bases[1].degree()]
    }

    /// Knots along both axes on [0, 1], repetitions listed.
    pub fn knots(&self) -> [&[f64]; 2] {
        [self.bases[0].knots(), self.bases[1].knots()]
    }

    /// The map from controls to the heights of the columns of `grid`.
    pub fn height_map(&self, grid: &Grid) -> HeightMap {
        self.height_map_at(std::array::from_fn(|axis| {
            let cells = grid.cells[axis];
            (0..=cells).map(|index| index as f64 / cells as f64).collect()
        }))
    }

    /// The map from controls to the heights where lines cross; places along both axes on [0, 1].
    pub fn height_map_at(&self, places: [Vec<f64>; 2]) -> HeightMap {
        let along = std::array::from_fn(|axis| places[axis].iter().map(|&t| self.bases[axis].values(t)).collect());
        HeightMap { along, counts: self.counts() }
    }

    /// The smooth pieces of the surface over a base of `size` mm: its polynomials lie between knots, and a B-spline is
    /// nowhere larger than its largest coefficient.
    pub fn pieces(&self, controls: &[f64], size: [f64; 2]) -> Pieces {
        let lines = std::array::from_fn(|axis: usize| {
            let mut knots = self.bases[axis].knots().to_vec();
            knots.dedup();
            knots.into_iter().map(|knot| size[axis] * knot).collect()
        });
        let largest = |orders: [usize; 2]| -> f64 {
            let coefficients = self.derivative(controls, orders).unwrap_or_default();
            let scale: f64 = (0..2).map(|axis| size[axis].powi(orders[axis] as i32)).product();
            coefficients.iter().fold(0.0, |largest: f64, value| largest.max(value.abs())) / scale
        };
        Pieces { lines, curvature: [largest([2, 0]), largest([1, 1]), largest([0, 2])] }
    }

    /// Coefficients of a derivative on the unit square, in any order; none where it vanishes between knots.
    fn derivative(&self, controls: &[f64], [first, second]: [usize; 2]) -> Option<Vec<f64>> {
        let repeated = |basis: &Basis, values: Vec<f64>, order: usize| {
            (0..order).try_fold((basis.clone(), values), |(basis, values), _| basis.derivative(&values))
        };
        let [n1, n2] = self.counts();
        let lines = (0..n2).map(|j| (0..n1).map(|i| controls[i * n2 + j]).collect());
        let lines = lines.map(|line| Some(repeated(&self.bases[0], line, first)?.1)).collect::<Option<Vec<_>>>()?;
        let crossed = (0..lines[0].len()).map(|i| lines.iter().map(|line| line[i]).collect());
        let crossed = crossed.map(|line| Some(repeated(&self.bases[1], line, second)?.1));
        Some(crossed.collect::<Option<Vec<_>>>()?.concat())
    }
}

impl HeightMap {
    /// The weights of the controls in the height of column (i, j), those that are not zero.
    pub(crate) fn weights(&self, i: usize, j: usize) -> Vec<(usize, f64)> {
        let (first, second) = (&self.along[0][i], &self.along[1][j]);
        let all = first.iter().flat_map(|a| second.iter().map(move |b| a * b)).enumerate();
        all.filter(|(_, weight)| *weight != 0.0).collect()
    }

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
    fn second_derivatives_are_bounded_closely() {
        // 3 s² − 2 s t over a base of 2 mm × 5 mm, as a Bézier surface: the bounds are the derivatives themselves.
        let polar = |i: usize, j: usize| 3.0 * f64::from(u8::from(i == 2)) - 2.0 * (i as f64 / 2.0) * (j as f64 / 2.0);
        let controls: Vec<f64> = (0..9).map(|index| polar(index / 3, index % 3)).collect();
        let surface = SplineSurface::new(SplineKind::Bezier, [3, 3]).expect("valid");
        let pieces = surface.pieces(&controls, [2.0, 5.0]);
        assert_eq!(pieces.lines, [vec![0.0, 2.0], vec![0.0, 5.0]]);
        for (found, expected) in pieces.curvature.iter().zip([6.0 / 4.0, 2.0 / 10.0, 0.0]) {
            assert!((found - expected).abs() < 1e-13, "{:?}", pieces.curvature);
        }
        // Between its knots a surface of degree 1 is bilinear: of the second derivatives it has the mixed one only.
        let bilinear = SplineSurface::new(SplineKind::BSpline(1), [3, 3]).expect("valid").pieces(&controls, [2.0, 5.0]);
        assert_eq!(bilinear.lines, [vec![0.0, 1.0, 2.0], vec![0.0, 2.5, 5.0]]);
        assert!(bilinear.curvature[0] == 0.0 && bilinear.curvature[1] > 0.0 && bilinear.curvature[2] == 0.0);
    }

    #[test]
    fn constant_controls_give_a_flat_surface_and_the_maps_are_adjoint() {
        let grid = Grid { cells: [7, 5, 2], corner: [0.0; 2], size: [100.0, 50.0] };
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
