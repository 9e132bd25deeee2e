//! Coordinates in which the metric is the identity.
//!
//! ```text
//! H = L Lᵀ,   z = Lᵀ d,   ã = L⁻¹ g,   dᵀ H d = |z|²,   gᵀ d = ãᵀ z
//! ```

use nalgebra::{Cholesky, Dyn};

use crate::{InputError, Matrix, Vector};

use super::problem::Metric;

/// The factor L of the metric.
#[derive(Debug, Clone)]
pub(super) enum Coordinates {
    /// L = diag(√H_ii): bounds of single variables stay bounds of single coordinates.
    Axes {
        /// √H_ii.
        lengths: Vec<f64>,
        /// H_ii.
        diagonal: Vec<f64>,
    },
    /// Dense lower triangular L.
    Dense(Box<Cholesky<f64, Dyn>>),
}

/// Keeps the factor of the last dense metric, which often stays the same over many calls.
#[derive(Debug, Clone, Default)]
pub(super) struct CoordinatesCache {
    matrix: Option<(Matrix, Coordinates)>,
}

impl CoordinatesCache {
    pub(super) fn factorise(&mut self, metric: Metric<'_>, dimension: usize) -> Result<Coordinates, InputError> {
        let matrix = match metric {
            Metric::ScaledIdentity(weight) => return Ok(Coordinates::axes(vec![weight; dimension])),
            Metric::Diagonal(diagonal) => return Ok(Coordinates::axes(diagonal.as_slice().to_vec())),
            Metric::Dense(matrix) => matrix,
        };
        if let Some((known, coordinates)) = &self.matrix
            && known == matrix
        {
            return Ok(coordinates.clone());
        }
        let factor = Cholesky::new(matrix.clone()).ok_or_else(|| InputError::OutOfRange {
            setting: "metric",
            value: "an indefinite or singular matrix".to_owned(),
            allowed: "positive definite",
        })?;
        let coordinates = Coordinates::Dense(Box::new(factor));
        self.matrix = Some((matrix.clone(), coordinates.clone()));
        Ok(coordinates)
    }
}

impl Coordinates {
    fn axes(diagonal: Vec<f64>) -> Self {
        Self::Axes { lengths: diagonal.iter().map(|entry| entry.sqrt()).collect(), diagonal }
    }

    /// L⁻¹ g, with room for the extra entry of a column of the factors.
    pub(super) fn normal(&self, gradient: &[f64]) -> Vec<f64> {
        let mut normal = Vec::with_capacity(gradient.len() + 1);
        match self {
            Self::Axes { lengths, .. } => normal.extend(gradient.iter().zip(lengths).map(|(g, l)| g / l)),
            Self::Dense(factor) => {
                let mut solved = Vector::from_column_slice(gradient);
                factor.l_dirty().solve_lower_triangular_mut(&mut solved);
                normal.extend_from_slice(solved.as_slice());
            }
        }
        normal
    }

    /// Replaces a sum of gradients by d = −H⁻¹ sum.
    pub(super) fn minimiser(&self, sum: &mut Vector) {
        match self {
            Self::Axes { diagonal, .. } => sum.iter_mut().zip(diagonal).for_each(|(s, h)| *s = -*s / h),
            Self::Dense(factor) => {
                factor.solve_mut(sum);
                sum.neg_mut();
            }
        }
    }

    /// √H_ii if coordinate i is variable i up to scale; none for a dense metric.
    pub(super) fn axis_length(&self, index: usize) -> Option<f64> {
        match self {
            Self::Axes { lengths, .. } => Some(lengths[index]),
            Self::Dense(_) => None,
        }
    }
}
