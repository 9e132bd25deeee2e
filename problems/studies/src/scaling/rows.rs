//! What is measured of one case with one solver: keys of the JSON output.

use crate::scaling::cases::{Case, SceneName, Variant};
use contact::equilibrium::{StageSeconds, Work};
use serde::Serialize;

/// Where a solve starts from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Start {
    /// Without a warm start.
    Cold,
    /// From the state of slightly different controls.
    Warm,
}

/// Work and time of a state.
#[derive(Debug, Clone, Serialize)]
pub struct Solve {
    /// Kind of the start.
    pub start: Start,
    /// Relative Newton residual asked for.
    pub tolerance: f64,
    /// Relative Newton residual reached.
    pub residual: f64,
    /// Steps and products with the dual operator.
    pub work: Work,
    /// The objective Σσ⁴, MPa⁴.
    pub objective: f64,
    /// Wall-clock time, s.
    pub seconds: f64,
    /// Stages of these; none for direct condensation.
    pub stages: Option<StageSeconds>,
}

/// Work and time of a subgradient.
#[derive(Debug, Clone, Serialize)]
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
#[derive(Debug, Clone, Serialize)]
pub struct Sample {
    /// Work and time of the state.
    pub state: Solve,
    /// Work and time of the subgradient.
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

/// One case with one solver.
#[derive(Debug, Clone, Serialize)]
pub struct ScalingRow {
    /// Scene that was measured.
    pub scene: SceneName,
    /// Bricks and subdomains per edge.
    #[serde(flatten)]
    pub case: Case,
    /// Contact solver that was measured.
    pub variant: Variant,
    /// Subdomains per edge of a cluster.
    pub clusters: usize,
    /// Rigid amplitudes of the clusters; none for direct condensation.
    pub coarse_unknowns: Option<usize>,
    /// Torn degrees of freedom; untorn ones for direct condensation.
    pub dofs: usize,
    /// Rows of B; contact rows for direct condensation.
    pub multipliers: usize,
    /// Number of nodes on the contact boundary.
    pub contact_nodes: usize,
    /// Seconds of what is done once per run: patterns, symbolic analysis, rows.
    pub setup_seconds: f64,
    /// State to 1e-8 and subgradient to 1e-8 from nothing: the repetition of median time.
    pub cold: Sample,
    /// State and subgradient to 1e-8 after a small change of the controls, started from the old multipliers.
    pub warm: Option<Sample>,
    /// States to other tolerances.
    pub others: Vec<Solve>,
    /// Peak resident memory of the process in this case, GiB; none where the system does not tell.
    pub peak_memory: Option<f64>,
    /// Messages about solves that did not reach their tolerance.
    pub failures: Vec<String>,
}

impl ScalingRow {
    /// The state solved from `start` to `tolerance`.
    pub fn solve(&self, start: Start, tolerance: f64) -> Option<&Solve> {
        let timed = std::iter::once(&self.cold).chain(&self.warm).map(|sample| &sample.state);
        timed.chain(&self.others).find(|solve| solve.start == start && solve.tolerance == tolerance)
    }
}
