//! The norm in which the engine measures distances of points, and its dual for subgradients.
//!
//! ```text
//! ‖d‖² = Σ wᵢ dᵢ²,     ‖g‖*² = Σ gᵢ²/wᵢ,     wᵢ = 1/Dᵢ²
//! ```

use crate::bundle::config::VariableScaling;
use crate::{InputError, Matrix, Polyhedron, Vector};
use serde::{Deserialize, Serialize};

/// A diagonal norm; `weights` are the wᵢ.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ScaledNorm {
    weights: Vector,
}

impl ScaledNorm {
    /// The Euclidean norm.
    pub fn euclidean(dimension: usize) -> Self {
        Self { weights: Vector::from_element(dimension, 1.0) }
    }

    /// The norm that a scaling and the box of the admissible set ask for.
    pub(crate) fn new(scaling: &VariableScaling, set: &Polyhedron) -> Result<Self, InputError> {
        match scaling {
            VariableScaling::Unit => Ok(Self::euclidean(set.dimension())),
            VariableScaling::FromBox => Ok(Self::from_box(set)),
            VariableScaling::Typical(sizes) if sizes.len() == set.dimension() => {
                Ok(Self { weights: sizes.map(|size| 1.0 / (size * size)) })
            }
            VariableScaling::Typical(sizes) => {
                Err(InputError::Dimension { what: "scaling.typical", expected: set.dimension(), found: sizes.len() })
            }
        }
    }

    /// Widths relative to their geometric mean; fixed variables do not count.
    fn from_box(set: &Polyhedron) -> Self {
        let widths = set.upper() - set.lower();
        if widths.iter().any(|width| !width.is_finite()) {
            return Self::euclidean(set.dimension());
        }
        let logs: Vec<f64> = widths.iter().filter(|width| **width > 0.0).map(|width| width.ln()).collect();
        let mean = (logs.iter().sum::<f64>() / logs.len().max(1) as f64).exp();
        Self { weights: widths.map(|width| if width > 0.0 { (mean / width).powi(2) } else { 1.0 }) }
    }

    /// The weights wᵢ.
    pub fn weights(&self) -> &Vector {
        &self.weights
    }

    /// Adds `factor` · W to a matrix.
    pub(crate) fn add_to(&self, matrix: &mut Matrix, factor: f64) {
        for (i, weight) in self.weights.iter().enumerate() {
            matrix[(i, i)] += factor * weight;
        }
    }

    /// ‖d‖².
    pub fn squared(&self, d: &Vector) -> f64 {
        self.weights.iter().zip(d.iter()).map(|(w, d)| w * d * d).sum()
    }

    /// ‖d‖.
    pub fn length(&self, d: &Vector) -> f64 {
        self.squared(d).sqrt()
    }

    /// ‖g‖*.
    pub fn dual_length(&self, g: &Vector) -> f64 {
        self.weights.iter().zip(g.iter()).map(|(w, g)| g * g / w).sum::<f64>().sqrt()
    }

    /// W d, the gradient of ½‖d‖².
    pub fn lower_index(&self, d: &Vector) -> Vector {
        self.weights.component_mul(d)
    }

    /// ‖x − y‖².
    pub fn squared_distance(&self, x: &Vector, y: &Vector) -> f64 {
        self.weights.iter().zip(x.iter().zip(y.iter())).map(|(w, (x, y))| w * (x - y) * (x - y)).sum()
    }
}
