//! B-spline surfaces by their control points in space; heights of a surface as one of them.

use crate::error::{ExchangeError, all_finite, counted};

/// A tensor product of clamped B-splines with control points in space, mm.
#[derive(Debug, Clone, PartialEq)]
pub struct SplinePatch {
    degrees: [usize; 2],
    knots: [Vec<f64>; 2],
    points: Vec<[f64; 3]>,
}

impl SplinePatch {
    /// B-splines of these degrees on these knots (ascending, all repetitions listed); the control points (mm) are row
    /// major, index i·n₂ + j with i along the first parameter.
    ///
    /// # Errors
    /// [`ExchangeError::Count`] unless there is a control point for every pair of basis functions,
    /// [`ExchangeError::Number`] for numbers that are not finite, degrees of 0, and knots that descend or are not
    /// clamped.
    pub fn new(degrees: [usize; 2], knots: [Vec<f64>; 2], points: Vec<[f64; 3]>) -> Result<Self, ExchangeError> {
        let counts = checked_counts(degrees, &knots)?;
        counted("control points", counts[0] * counts[1], points.len())?;
        all_finite("coordinate of a control point", points.as_flattened())?;
        Ok(Self { degrees, knots, points })
    }

    /// Degree along an axis.
    pub(super) fn degree(&self, axis: usize) -> usize {
        self.degrees[axis]
    }

    /// Control points per axis.
    pub(super) fn counts(&self) -> [usize; 2] {
        counts(self.degrees, &self.knots)
    }

    /// Control point (i, j), mm.
    pub(super) fn point(&self, i: usize, j: usize) -> [f64; 3] {
        self.points[i * self.counts()[1] + j]
    }

    /// Distinct knots along an axis, each with its multiplicity.
    pub(super) fn distinct_knots(&self, axis: usize) -> Vec<(f64, usize)> {
        let runs = self.knots[axis].chunk_by(|a, b| a == b);
        runs.map(|run| (run[0], run.len())).collect()
    }
}

fn counts(degrees: [usize; 2], knots: &[Vec<f64>; 2]) -> [usize; 2] {
    [0, 1].map(|axis| knots[axis].len() - degrees[axis] - 1)
}

/// Basis functions along both axes.
fn checked_counts(degrees: [usize; 2], knots: &[Vec<f64>; 2]) -> Result<[usize; 2], ExchangeError> {
    for (&degree, knots) in degrees.iter().zip(knots) {
        let allowed = "at least 1";
        if degree == 0 {
            return Err(ExchangeError::Number { what: "degree", index: 0, value: 0.0, allowed });
        }
        counted("knots along an axis", knots.len().max(2 * degree + 2), knots.len())?;
        all_finite("knot", knots)?;
        let end = knots.len() - 1;
        let clamped = knots[0] == knots[degree] && knots[end] == knots[end - degree] && knots[0] < knots[end];
        if let (Some(index), _) | (None, Some(index)) =
            ((1..knots.len()).find(|&index| knots[index] < knots[index - 1]), (!clamped).then_some(0))
        {
            let allowed = "ascending knots, the first and the last ones repeated degree + 1 times";
            return Err(ExchangeError::Number { what: "knot", index, value: knots[index], allowed });
        }
    }
    Ok(counts(degrees, knots))
}

/// Heights over a rectangle [a, a + ℓ₁] × [b, b + ℓ₂].
#[derive(Debug, Clone, PartialEq)]
pub struct SplineHeights {
    patch: SplinePatch,
    ends: [[f64; 2]; 2],
}

impl SplineHeights {
    /// B-splines of these degrees on these knots (ascending, all repetitions listed), over a rectangle of `size` mm
    /// with this least corner; the control heights (mm) are row major, index i·n₂ + j with i along x₁.
    ///
    /// # Errors
    /// [`ExchangeError::Count`] unless there is a height for every pair of basis functions, [`ExchangeError::Number`]
    /// for numbers that are not finite, degrees of 0, and knots that descend or are not clamped.
    pub fn new(
        degrees: [usize; 2],
        knots: [Vec<f64>; 2],
        (corner, size): ([f64; 2], [f64; 2]),
        heights: &[f64],
    ) -> Result<Self, ExchangeError> {
        let [n1, n2] = checked_counts(degrees, &knots)?;
        all_finite("length", &size)?;
        counted("control heights", n1 * n2, heights.len())?;
        all_finite("control height", heights)?;
        // The Greville abscissa of a basis function.
        let abscissa = |axis: usize, index: usize| {
            let (degree, knots) = (degrees[axis], &knots[axis]);
            let (first, last) = (knots[0], knots[knots.len() - 1]);
            let mean = knots[index + 1..=index + degree].iter().sum::<f64>() / degree as f64;
            corner[axis] + size[axis] * (mean - first) / (last - first)
        };
        let point = |index: usize| [abscissa(0, index / n2), abscissa(1, index % n2), heights[index]];
        let patch = SplinePatch::new(degrees, knots.clone(), (0..n1 * n2).map(point).collect())?;
        Ok(Self { patch, ends: [0, 1].map(|axis| [corner[axis], corner[axis] + size[axis]]) })
    }

    /// The surface in space.
    pub fn patch(&self) -> &SplinePatch {
        &self.patch
    }

    /// Ends of the rectangle along x₁ and x₂, mm.
    pub(super) fn ends(&self) -> [[f64; 2]; 2] {
        self.ends
    }
}
