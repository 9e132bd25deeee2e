//! The norm in which the engine measures distances of points, and its dual for subgradients.
//!
//! ```text
//! ‖d‖² = dᵀ W d,     ‖g‖*² = gᵀ W⁻¹ g,     W = diag(1/Dᵢ²)   or   W = M⁻ᵀ M⁻¹
//! ```

use super::config::VariableScaling;
use super::coordinates::Coordinates;
use crate::checks::check_size;
use crate::qp::Metric;
use crate::qp::kernels::{weighted_squared_distance, weighted_squares};
use crate::{InputError, Matrix, Polyhedron, Vector, plain};
use serde::{Deserialize, Serialize};

/// Widths beyond this many times the median width count as no wider.
const MAX_WIDTH_RATIO: f64 = 1e3;

/// The norm of a run, ‖d‖² = dᵀWd, and its dual for subgradients, ‖g‖*² = gᵀW⁻¹g, with a diagonal or a dense W. Vectors
/// have one entry per variable.
///
/// All lengths of a run are in this norm: radii, steps, the aggregate subgradient (in the dual norm), curvatures and
/// the distances of the stopping tests.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ScaledNorm(Scale);

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
enum Scale {
    /// The diagonal of W.
    Weights(#[serde(with = "plain::vector")] Vector),
    /// The matrix M.
    Linear(Coordinates),
}

/// The quadratic term u W of a subproblem.
#[derive(Debug)]
pub(crate) enum WeightedMetric {
    Diagonal(Vector),
    Dense(Matrix),
}

impl WeightedMetric {
    pub(crate) fn metric(&self) -> Metric<'_> {
        match self {
            Self::Diagonal(diagonal) => Metric::Diagonal(diagonal),
            Self::Dense(matrix) => Metric::Dense(matrix),
        }
    }
}

impl ScaledNorm {
    /// The Euclidean norm, in which M is the identity.
    pub(crate) fn euclidean(dimension: usize) -> Self {
        Self(Scale::Weights(Vector::from_element(dimension, 1.0)))
    }

    /// The norm that a scaling and the box of the admissible set ask for.
    pub(crate) fn new(scaling: &VariableScaling, set: &Polyhedron) -> Result<Self, InputError> {
        match scaling {
            VariableScaling::Unit => Ok(Self::euclidean(set.dimension())),
            VariableScaling::FromBox => Ok(Self::from_box(set)),
            VariableScaling::Typical(sizes) => {
                check_size("scaling.typical", set.dimension(), sizes.len())?;
                Ok(Self(Scale::Weights(sizes.map(|size| 1.0 / (size * size)))))
            }
            VariableScaling::Linear(matrix) => {
                check_size("scaling.linear", set.dimension(), matrix.nrows())?;
                Ok(Self(Scale::Linear(Coordinates::try_from(matrix.clone())?)))
            }
        }
    }

    /// D = widths relative to their geometric mean; fixed variables do not count, and have D = 1.
    fn from_box(set: &Polyhedron) -> Self {
        let widths = set.upper() - set.lower();
        if widths.iter().any(|width| !width.is_finite()) {
            return Self::euclidean(set.dimension());
        }
        let mut positive: Vec<f64> = widths.iter().copied().filter(|width| *width > 0.0).collect();
        positive.sort_by(f64::total_cmp);
        // A side that is far wider than the others stands for an open one, and tells no unit.
        let widest = positive.get(positive.len().saturating_sub(1) / 2).map_or(f64::INFINITY, |w| w * MAX_WIDTH_RATIO);
        let mean =
            (positive.iter().map(|width| width.min(widest).ln()).sum::<f64>() / positive.len().max(1) as f64).exp();
        let weight = |width: f64| if width > 0.0 { (mean / width.min(widest)).powi(2) } else { 1.0 };
        Self(Scale::Weights(widths.map(weight)))
    }

    /// The matrix W, n × n, symmetric and positive definite.
    pub fn matrix(&self) -> Matrix {
        match &self.0 {
            Scale::Weights(weights) => Matrix::from_diagonal(weights),
            Scale::Linear(Coordinates { metric, .. }) => metric.clone(),
        }
    }

    /// u W.
    pub(crate) fn weighted(&self, weight: f64) -> WeightedMetric {
        match &self.0 {
            Scale::Weights(weights) => WeightedMetric::Diagonal(weights * weight),
            Scale::Linear(Coordinates { metric, .. }) => WeightedMetric::Dense(metric * weight),
        }
    }

    /// Adds u W to a matrix.
    pub(crate) fn add_to(&self, matrix: &mut Matrix, weight: f64) {
        match self.weighted(weight) {
            WeightedMetric::Diagonal(diagonal) => {
                for (i, entry) in diagonal.iter().enumerate() {
                    matrix[(i, i)] += entry;
                }
            }
            WeightedMetric::Dense(metric) => *matrix += metric,
        }
    }

    /// ‖d‖².
    pub fn squared(&self, d: &Vector) -> f64 {
        match &self.0 {
            Scale::Weights(weights) => weighted_squares(weights.as_slice(), d.as_slice()),
            Scale::Linear(Coordinates { inverse, .. }) => (inverse * d).norm_squared(),
        }
    }

    /// ‖d‖.
    pub fn length(&self, d: &Vector) -> f64 {
        self.squared(d).sqrt()
    }

    /// ‖g‖*.
    pub fn dual_length(&self, g: &Vector) -> f64 {
        match &self.0 {
            Scale::Weights(weights) => weights.iter().zip(g.iter()).map(|(w, g)| g * g / w).sum::<f64>().sqrt(),
            Scale::Linear(Coordinates { matrix, .. }) => matrix.tr_mul(g).norm(),
        }
    }

    /// W d, the gradient of ½‖d‖².
    pub fn lower_index(&self, d: &Vector) -> Vector {
        match &self.0 {
            Scale::Weights(weights) => weights.component_mul(d),
            Scale::Linear(Coordinates { inverse, .. }) => inverse.tr_mul(&(inverse * d)),
        }
    }

    /// M⁻¹ d, whose Euclidean length is ‖d‖.
    pub(crate) fn to_coordinates(&self, d: &Vector) -> Vector {
        match &self.0 {
            Scale::Weights(weights) => d.zip_map(weights, |d, w| d * w.sqrt()),
            Scale::Linear(Coordinates { inverse, .. }) => inverse * d,
        }
    }

    /// How far a step of length 1 can change variable i.
    pub(crate) fn unit(&self, i: usize) -> f64 {
        match &self.0 {
            Scale::Weights(weights) => 1.0 / weights[i].sqrt(),
            Scale::Linear(Coordinates { matrix, .. }) => matrix.row(i).norm(),
        }
    }

    /// Whether W is the identity.
    pub(crate) fn is_euclidean(&self) -> bool {
        matches!(&self.0, Scale::Weights(weights) if weights.iter().all(|weight| *weight == 1.0))
    }

    /// W⁻¹ g, the direction that a subgradient belongs to.
    pub(crate) fn raise_index(&self, g: &Vector) -> Vector {
        match &self.0 {
            Scale::Weights(weights) => g.component_div(weights),
            Scale::Linear(Coordinates { matrix, .. }) => matrix * matrix.tr_mul(g),
        }
    }

    /// Mᵀ g, whose Euclidean length is ‖g‖*.
    pub(crate) fn dual_to_coordinates(&self, g: &Vector) -> Vector {
        match &self.0 {
            Scale::Weights(weights) => g.zip_map(weights, |g, w| g / w.sqrt()),
            Scale::Linear(Coordinates { matrix, .. }) => matrix.tr_mul(g),
        }
    }

    /// MᵀBM, a quadratic form B in the coordinates.
    pub(crate) fn form_in_coordinates(&self, form: Matrix) -> Matrix {
        match &self.0 {
            Scale::Weights(weights) => {
                Matrix::from_fn(form.nrows(), form.ncols(), |i, j| form[(i, j)] / (weights[i] * weights[j]).sqrt())
            }
            Scale::Linear(Coordinates { matrix, .. }) => matrix.tr_mul(&form) * matrix,
        }
    }

    /// M⁻ᵀ B M⁻¹ for a quadratic form B of the coordinates.
    pub(crate) fn form_of_coordinates(&self, form: Matrix) -> Matrix {
        match &self.0 {
            Scale::Weights(weights) => {
                Matrix::from_fn(form.nrows(), form.ncols(), |i, j| form[(i, j)] * (weights[i] * weights[j]).sqrt())
            }
            Scale::Linear(Coordinates { inverse, .. }) => inverse.tr_mul(&form) * inverse,
        }
    }

    /// ‖x − y‖².
    pub(crate) fn squared_distance(&self, x: &Vector, y: &Vector) -> f64 {
        match &self.0 {
            Scale::Weights(weights) => weighted_squared_distance(weights.as_slice(), x.as_slice(), y.as_slice()),
            Scale::Linear(_) => self.squared(&(x - y)),
        }
    }
}
