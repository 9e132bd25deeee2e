//! What is recorded about a case; the keys of the JSON.

use contact::equilibrium::{Kink, Residuals, StatusCounts};
use serde::Serialize;

/// How a case ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum CaseOutcome {
    /// Solved to its certificate; the independent paths agree.
    Solved,
    /// Refused with a typed error that names the cause.
    Refused,
    /// A known limit: not solved, or not by every path, for the cause stated.
    Limit,
    /// Not what was expected.
    #[default]
    Broken,
}

/// What one solver did.
#[derive(Debug, Clone, Default, Serialize)]
pub struct Path {
    pub solver: &'static str,
    /// Newton steps or fixed point steps.
    pub steps: usize,
    /// Products with the dual operator.
    pub products: usize,
    /// Certificates, if a state was found.
    pub residuals: Option<Residuals>,
    /// Numbers of nodes per status, if a state was found.
    pub status: Option<StatusCounts>,
    /// Distance to the nearest kink, if a state was found.
    pub kink: Option<Kink>,
    /// Kind of the error, if the case was refused.
    pub refusal: Option<String>,
    /// Text of the error.
    pub reason: Option<String>,
}

/// One case with its outcome.
#[derive(Debug, Clone, Default, Serialize)]
pub struct Record {
    pub group: &'static str,
    /// Name of the case.
    pub name: String,
    pub outcome: CaseOutcome,
    /// Cause of a refusal or limit, what broke, or a finding.
    pub remark: String,
    /// What the solvers did.
    pub paths: Vec<Path>,
    /// Largest difference of contact forces between the paths, over the largest force.
    pub force_difference: Option<f64>,
    /// Largest difference of shape sensitivities between the paths, over the largest.
    pub subgradient_difference: Option<f64>,
    /// Contraction factor of the slip bounds at the state, exact (from the condensed matrices).
    pub contraction: Option<f64>,
    /// Condition number of Newton's matrix on the contact displacements.
    pub condition: Option<f64>,
    /// Seconds of the case, all paths.
    pub seconds: f64,
}

impl Record {
    /// A record without solver paths.
    pub fn plain(outcome: CaseOutcome, remark: String) -> Self {
        Self { outcome, remark, ..Self::default() }
    }

    /// Largest certificate over TFETI and direct condensation (the successive approximations are asked for less).
    pub fn largest_residual(&self) -> Option<f64> {
        self.paths.iter().take(2).filter_map(|path| path.residuals.as_ref()).map(Residuals::largest).reduce(f64::max)
    }
}

/// Numbers of cases per outcome.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize)]
pub struct Counts {
    /// Solved to the certificate.
    pub solved: usize,
    /// Number of cases refused with a correct reason.
    pub refused: usize,
    /// Number of cases beyond a documented limit.
    pub limits: usize,
    /// Number of cases whose result is not as expected.
    pub broken: usize,
}

/// Records of all cases with their counts.
#[derive(Debug, Clone, Serialize)]
pub struct StabilityReport {
    /// Numbers of cases per outcome.
    pub counts: Counts,
    /// Records in the order of the cases.
    pub records: Vec<Record>,
}

impl StabilityReport {
    /// Counts the outcomes of the records.
    pub fn new(records: Vec<Record>) -> Self {
        let count = |outcome| records.iter().filter(|record| record.outcome == outcome).count();
        let counts = Counts {
            solved: count(CaseOutcome::Solved),
            refused: count(CaseOutcome::Refused),
            limits: count(CaseOutcome::Limit),
            broken: count(CaseOutcome::Broken),
        };
        Self { counts, records }
    }
}
