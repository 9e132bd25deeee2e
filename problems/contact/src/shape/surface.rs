//! F_α(x₁, x₂) = Σ α_ij N_i(x₁/a) N_j(x₂/b): the face of a block whose heights are controls.

use crate::shape::bspline::Basis;

/// A tensor-product spline surface with m₁ × m₂ control heights, index i·m₂ + j.
#[derive(Debug, Clone, PartialEq)]
pub struct SplineSurface {
    bases: [Basis; 2],
}

impl SplineSurface {
    pub(crate) fn new(bases: [Basis; 2]) -> Self {
        Self { bases }
    }

    pub(crate) fn bases(&self) -> &[Basis; 2] {
        &self.bases
    }

    /// Control points per axis.
    pub fn counts(&self) -> [usize; 2] {
        [self.bases[0].count(), self.bases[1].count()]
    }

    /// Degrees along both axes.
    pub fn degrees(&self) -> [usize; 2] {
        [self.bases[0].degree(), self.bases[1].degree()]
    }

    /// Knots along both axes on [0, 1], repetitions listed.
    pub fn knots(&self) -> [&[f64]; 2] {
        [self.bases[0].knots(), self.bases[1].knots()]
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

    /// The weights of the controls in the height at a place on [0, 1]², those that are not zero.
    pub fn weights(&self, place: [f64; 2]) -> Vec<(usize, f64)> {
        let [first, second]: [Vec<f64>; 2] = std::array::from_fn(|axis| self.bases[axis].values(place[axis]));
        let all = first.iter().flat_map(|a| second.iter().map(move |b| a * b)).enumerate();
        all.filter(|(_, weight)| *weight != 0.0).collect()
    }

    /// The height at a place on [0, 1]², mm.
    pub fn height(&self, controls: &[f64], place: [f64; 2]) -> f64 {
        self.weights(place).into_iter().map(|(control, weight)| weight * controls[control]).sum()
    }
}
