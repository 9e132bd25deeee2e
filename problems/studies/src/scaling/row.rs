//! What is measured of one case with one solver: keys of the JSON output.

use crate::scaling::bandwidth::Bandwidth;
use crate::scaling::cases::{Case, SceneName, Variant};
use crate::scaling::solve::{Sample, Solve, Start};
use crate::scaling::threads::Threads;
use serde::{Deserialize, Serialize};

/// One case with one solver.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Row {
    /// The scene.
    pub scene: SceneName,
    /// The mesh.
    #[serde(flatten)]
    pub case: Case,
    /// The solver.
    pub variant: Variant,
    /// Torn degrees of freedom; untorn ones for direct condensation.
    pub dofs: usize,
    /// Rows of B; contact rows for direct condensation.
    pub multipliers: usize,
    /// Contact nodes.
    pub contact_nodes: usize,
    /// Seconds of what is done once per run: patterns, symbolic analysis, rows.
    pub setup_seconds: f64,
    /// State to 1e-8 and subgradient to 1e-8 from nothing: the repetition of median time.
    pub cold: Sample,
    /// The same after a small change of the controls, from the old multipliers.
    pub warm: Option<Sample>,
    /// States to other tolerances.
    pub others: Vec<Solve>,
    /// Peak resident memory of the process up to here, GiB; none where the system does not tell.
    pub peak_memory: Option<f64>,
    /// Times with one and two threads.
    pub threads: Option<Threads>,
    /// Speed of the dual operator per number of threads.
    pub bandwidth: Vec<Bandwidth>,
    /// Solves that did not reach their tolerance, in words.
    pub failures: Vec<String>,
}

impl Row {
    /// The state solved from `start` to `tolerance`.
    pub fn solve(&self, start: Start, tolerance: f64) -> Option<&Solve> {
        let timed = std::iter::once(&self.cold).chain(&self.warm).map(|sample| &sample.state);
        timed.chain(&self.others).find(|solve| solve.start == start && solve.tolerance == tolerance)
    }
}
