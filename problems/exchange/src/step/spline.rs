//! The B-spline heights of a surface, with their control points in space.

use crate::error::{ExchangeError, all_finite, counted};

/// Heights over the rectangle [0, a] × [0, b], or one moved from there, as a tensor product of clamped B-splines.
#[derive(Debug, Clone, PartialEq)]
pub struct SplineHeights {
    degrees: [usize; 2],
    knots: [Vec<f64>; 2],
    corner: [f64; 2],
    size: [f64; 2],
    heights: Vec<f64>,
}

impl SplineHeights {
    /// B-splines of these degrees on these knots (ascending, all repetitions listed), over a rectangle of `size` mm;
    /// the control heights (mm) are row major, index i·n₂ + j with i along x₁.
    ///
    /// # Errors
    /// [`ExchangeError::Count`] unless there is a height for every pair of basis functions, [`ExchangeError::Number`]
    /// for numbers that are not finite, degrees of 0, and knots that descend or are not clamped.
    pub fn new(
        degrees: [usize; 2],
        knots: [Vec<f64>; 2],
        size: [f64; 2],
        heights: Vec<f64>,
    ) -> Result<Self, ExchangeError> {
        for (&degree, knots) in degrees.iter().zip(&knots) {
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
        all_finite("length", &size)?;
        let [n1, n2]: [usize; 2] = std::array::from_fn(|axis| knots[axis].len() - degrees[axis] - 1);
        counted("control heights", n1 * n2, heights.len())?;
        all_finite("control height", &heights)?;
        Ok(Self { degrees, knots, corner: [0.0; 2], size, heights })
    }

    /// The heights over a rectangle with another least corner, mm.
    #[must_use]
    pub fn at(self, corner: [f64; 2]) -> Self {
        Self { corner, ..self }
    }

    /// Degree along an axis.
    pub(super) fn degree(&self, axis: usize) -> usize {
        self.degrees[axis]
    }

    /// Ends of the rectangle along x₁ and x₂, mm.
    pub(super) fn ends(&self) -> [[f64; 2]; 2] {
        std::array::from_fn(|axis| [self.corner[axis], self.corner[axis] + self.size[axis]])
    }

    /// Control points per axis.
    pub(super) fn counts(&self) -> [usize; 2] {
        std::array::from_fn(|axis| self.knots[axis].len() - self.degrees[axis] - 1)
    }

    /// Control point (i, j), mm.
    pub(super) fn point(&self, i: usize, j: usize) -> [f64; 3] {
        [self.abscissa(0, i), self.abscissa(1, j), self.heights[i * self.counts()[1] + j]]
    }

    /// Greville abscissa of a basis function along an axis, mm.
    fn abscissa(&self, axis: usize, index: usize) -> f64 {
        let (degree, knots) = (self.degrees[axis], &self.knots[axis]);
        let (first, last) = (knots[0], knots[knots.len() - 1]);
        let mean = knots[index + 1..=index + degree].iter().sum::<f64>() / degree as f64;
        self.corner[axis] + self.size[axis] * (mean - first) / (last - first)
    }

    /// Distinct knots along an axis, each with its multiplicity.
    pub(super) fn distinct_knots(&self, axis: usize) -> Vec<(f64, usize)> {
        let runs = self.knots[axis].chunk_by(|a, b| a == b);
        runs.map(|run| (run[0], run.len())).collect()
    }
}
