//! What is asked of a solved shape, and what comes back, as data: all processes are asked the same.

use crate::equilibrium::{Diagnosis, Sensitivities, SolvedBody, Tangents, TangentsOf};
use serde::{Deserialize, Serialize};

/// A question about a solved shape.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub enum Call {
    /// Sensitivities for a dual, to a tolerance.
    Sensitivities(Vec<f64>, f64),
    /// Tangents for changes of the controls, to a tolerance.
    Tangents(Vec<Vec<f64>>, TangentsOf, f64),
    /// Contraction and condition.
    Diagnose,
    /// Estimate of the contraction, for at most so many products.
    Contraction(usize),
    /// Rounding of the contact forces.
    ForceRounding,
    /// All bodies.
    Bodies,
}

/// The answer to a [`Call`], of the variant with the same name.
#[derive(Debug)]
pub enum Reply {
    Sensitivities(Sensitivities),
    Tangents(Tangents),
    Diagnose(Diagnosis),
    Contraction(f64),
    ForceRounding(f64),
    Bodies(Vec<SolvedBody>),
}

impl Reply {
    /// Products with the dual operator that an answer cost.
    pub fn products(&self) -> usize {
        match self {
            Self::Sensitivities(found) => found.applications,
            Self::Tangents(found) => found.applications,
            _ => 0,
        }
    }
}
