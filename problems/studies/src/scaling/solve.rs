//! One state and one subgradient with their work and time.

use contact::equilibrium::{StageSeconds, Work};
use serde::{Deserialize, Serialize};

/// Where a solve starts from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Start {
    /// From nothing.
    Cold,
    /// From the state of slightly different controls.
    Warm,
}

/// One state.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Solve {
    /// Where it started.
    pub start: Start,
    /// Relative Newton residual asked for.
    pub tolerance: f64,
    /// Relative Newton residual reached.
    pub residual: f64,
    /// Steps and products.
    pub work: Work,
    /// Σσ⁴, MPa⁴.
    pub objective: f64,
    /// Wall-clock seconds.
    pub seconds: f64,
    /// Stages of these; none for direct condensation.
    pub stages: Option<StageSeconds>,
}

/// One subgradient.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Adjoint {
    /// Relative residual asked for.
    pub tolerance: f64,
    /// Products with the dual operator; 0 for direct condensation.
    pub applications: usize,
    /// Wall-clock seconds of the adjoint system (direct: with the element sums).
    pub seconds: f64,
    /// Wall-clock seconds of the element sums.
    pub shape_seconds: f64,
}

/// A state and its subgradient, both timed.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Sample {
    /// The state.
    pub state: Solve,
    /// The subgradient.
    pub adjoint: Adjoint,
}

impl Solve {
    /// Products with the dual operator; 0 for direct condensation.
    pub fn applications(&self) -> usize {
        self.work.dual_operator_applications
    }
}

impl Sample {
    /// Seconds of state and subgradient.
    pub fn seconds(&self) -> f64 {
        self.state.seconds + self.adjoint.seconds + self.adjoint.shape_seconds
    }
}
