//! Data of the QP, its answer, its errors, and the checks at the border.

use std::borrow::Cow;
use thiserror::Error;

use crate::checks::{check_finite, check_intervals, check_size};
use crate::{InputError, Matrix, Vector};

/// The quadratic term ½ dᵀ H d.
#[derive(Debug, Clone, Copy)]
pub enum Metric<'a> {
    /// H = u I with u > 0.
    ScaledIdentity(f64),
    /// H = diag(h) with h_i > 0.
    Diagonal(&'a Vector),
    /// A symmetric positive definite matrix.
    Dense(&'a Matrix),
}

impl<'a> Metric<'a> {
    /// The product H d.
    pub fn apply(&self, step: &Vector) -> Vector {
        match self {
            Self::ScaledIdentity(weight) => step * *weight,
            Self::Diagonal(diagonal) => step.component_mul(diagonal),
            Self::Dense(matrix) => *matrix * step,
        }
    }

    /// The diagonal entry H_ii.
    pub(super) fn diagonal_entry(&self, index: usize) -> f64 {
        match self {
            Self::ScaledIdentity(weight) => *weight,
            Self::Diagonal(diagonal) => diagonal[index],
            Self::Dense(matrix) => matrix[(index, index)],
        }
    }

    /// The diagonal of H for n variables.
    pub(super) fn diagonal(self, dimension: usize) -> Cow<'a, [f64]> {
        match self {
            Self::Diagonal(diagonal) => Cow::Borrowed(diagonal.as_slice()),
            _ => Cow::Owned((0..dimension).map(|i| self.diagonal_entry(i)).collect()),
        }
    }
}

/// min v + ½ dᵀ H d subject to cuts, two-sided rows and a box; n variables, m cuts, p rows.
#[derive(Debug, Clone, Copy)]
pub struct EpigraphQp<'a> {
    /// The metric H, n × n.
    pub metric: Metric<'a>,
    /// Slopes g_j of the cuts, m vectors of n entries, m ≥ 1.
    pub slopes: &'a [Vector],
    /// Offsets e_j of the cuts, m finite numbers of any sign.
    pub offsets: &'a [f64],
    /// Identity of each cut, m distinct numbers that keep their meaning from one call to the next (warm start).
    pub cut_ids: &'a [u64],
    /// The matrix A, p × n.
    pub rows: &'a Matrix,
    /// Lower sides of the rows, p entries, −∞ where open.
    pub row_lower: &'a Vector,
    /// Upper sides of the rows, p entries, +∞ where open; equal sides make an equality.
    pub row_upper: &'a Vector,
    /// Lower bounds of d, n entries, −∞ where open.
    pub lower: &'a Vector,
    /// Upper bounds of d, n entries, +∞ where open; equal bounds fix a variable.
    pub upper: &'a Vector,
}

/// Which method produced an answer.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum QpMethod {
    /// The dual active-set method.
    ActiveSet,
    /// The interior-point method; refinement by the active-set method brought no better answer.
    InteriorPoint,
}

/// Minimiser, multipliers and certificate.
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct QpSolution {
    /// The minimiser d.
    pub step: Vector,
    /// v = max_j g_jᵀ d − e_j, up to the rounding of active cuts that are far steeper than another one.
    pub epigraph: f64,
    /// π_j ≥ 0 with sum 1, one per cut.
    pub cut_multipliers: Vec<f64>,
    /// μ_i, one per row: positive if the upper side binds, negative if the lower side binds.
    pub row_multipliers: Vec<f64>,
    /// ν_i, one per variable, signed like the row multipliers.
    pub bound_multipliers: Vec<f64>,
    /// Relative residual of the KKT system, see [`kkt_residual`](super::kkt_residual); at most 1e-10.
    pub kkt_residual: f64,
    /// Changes of the active set made for this answer.
    pub pivots: usize,
    /// The method behind the answer.
    pub method: QpMethod,
}

/// Work done by a solver since it was made.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct QpCounts {
    /// Quadratic programs taken on; those with unusable data are not counted.
    pub solves: usize,
    /// Changes of the active set.
    pub pivots: usize,
    /// Calls handed to the interior-point method; 0 without the feature `interior-point`.
    pub fallbacks: usize,
}

/// Why there is no answer.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum QpError {
    /// The data have a wrong size or a value that is not allowed.
    #[error(transparent)]
    Input(#[from] InputError),
    /// No point satisfies rows and box.
    #[error("rows and box have no common point: relative violation {violation:.3e}")]
    Infeasible {
        /// Violation, relative to the size of the violated side and of its terms, of a side that cannot be satisfied
        /// together with the others.
        violation: f64,
    },
    /// No method that is built in reached the required accuracy.
    #[error("the quadratic program was not solved: relative KKT residual {kkt_residual:.3e}")]
    NotSolved {
        /// Smallest residual reached.
        kkt_residual: f64,
    },
}

impl EpigraphQp<'_> {
    /// Number of variables n.
    pub fn dimension(&self) -> usize {
        self.lower.len()
    }

    /// Checks sizes, finiteness, intervals and the metric (positive definiteness of a dense one is seen when it is
    /// factorised).
    pub(super) fn validate(&self) -> Result<(), InputError> {
        let (n, m, p) = (self.dimension(), self.slopes.len(), self.rows.nrows());
        check_size("cuts", m.max(1), m)?;
        check_size("offsets", m, self.offsets.len())?;
        check_size("cut_ids", m, self.cut_ids.len())?;
        check_size("upper bounds", n, self.upper.len())?;
        check_size("constraint row", n, self.rows.ncols())?;
        check_size("row_lower", p, self.row_lower.len())?;
        check_size("row_upper", p, self.row_upper.len())?;
        for slope in self.slopes {
            InputError::check_vector("slope", n, slope)?;
        }
        check_finite("offsets", self.offsets)?;
        check_finite("constraint rows", self.rows.as_slice())?;
        check_intervals("variable", self.lower, self.upper)?;
        check_intervals("row", self.row_lower, self.row_upper)?;
        self.validate_metric()
    }

    fn validate_metric(&self) -> Result<(), InputError> {
        let n = self.dimension();
        match self.metric {
            Metric::ScaledIdentity(weight) => check_positive(weight),
            Metric::Diagonal(diagonal) => {
                check_size("metric", n, diagonal.len())?;
                diagonal.iter().try_for_each(|&entry| check_positive(entry))
            }
            Metric::Dense(matrix) => {
                check_size("metric rows", n, matrix.nrows())?;
                check_size("metric columns", n, matrix.ncols())?;
                check_finite("metric", matrix.as_slice())?;
                (0..n).try_for_each(|i| check_positive(matrix[(i, i)]))?;
                check_symmetric(matrix)
            }
        }
    }
}

fn check_positive(value: f64) -> Result<(), InputError> {
    if value > 0.0 && value.is_finite() {
        return Ok(());
    }
    Err(InputError::OutOfRange { setting: "metric", value: value.to_string(), allowed: "finite and > 0" })
}

fn check_symmetric(matrix: &Matrix) -> Result<(), InputError> {
    for j in 0..matrix.ncols() {
        for i in 0..j {
            let gap = (matrix[(i, j)] - matrix[(j, i)]).abs();
            if gap > 1e-12 * (matrix[(i, i)] * matrix[(j, j)]).sqrt() {
                let value = format!("asymmetry {gap:e} at ({i}, {j})");
                return Err(InputError::OutOfRange { setting: "metric", value, allowed: "symmetric" });
            }
        }
    }
    Ok(())
}
