//! What a run leaves behind: solution, reason of the end, certificate, counts, history.

mod certificate;
mod composite_proof;
mod constraints;
mod observer;
mod proof_check;
mod record;
mod stop;
mod termination;

pub use certificate::{Certificate, CertificateCheck};
pub use composite_proof::CompositeProof;
pub use constraints::{ConstraintCut, ConstraintProof, ConstraintReport};
pub use observer::{Observer, TablePrinter};
pub use proof_check::ProofCheck;
pub(crate) use record::Noted;
pub use record::{Counts, IterationRecord, Origin, StepKind, TrialCounts};
pub use stop::StopRule;
pub use termination::Termination;

use crate::{Vector, plain};
use serde::{Deserialize, Serialize};
use std::fmt;

/// The result of a run. `Display` is a one-page summary.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub struct Report {
    /// The admissible point that the termination speaks about; where a limit or a failure ended the run, the lowest one
    /// evaluated.
    #[serde(with = "plain::vector")]
    pub solution: Vector,
    /// Θ there.
    pub value: f64,
    /// Θ at the (admissible) start.
    pub start_value: f64,
    /// Why the run ended.
    pub termination: Termination,
    /// How stationary the solution is, with everything needed to check it; none if no subproblem was solved.
    pub certificate: Option<Certificate>,
    /// The nonlinear constraints at the solution.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub constraints: Vec<ConstraintReport>,
    /// The weight ρ of the violation in the merit that the run has ended with, in units of Θ per length; none without
    /// nonlinear constraints.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub penalty: Option<f64>,
    /// Numbers of evaluations, steps and subproblems.
    pub counts: Counts,
    /// One record per evaluation.
    pub history: Vec<IterationRecord>,
    /// Largest relative violation of the admissible set among all points evaluated.
    pub largest_violation: f64,
    /// What went wrong without ending the run: [`Journaled::complete`](crate::Journaled::complete) adds to it, the
    /// method does not.
    pub warnings: Vec<String>,
    /// Seconds used; with those of earlier invocations after [`Journaled::complete`](crate::Journaled::complete).
    pub seconds: f64,
}

/// Entries printed of a solution; of a longer one the last is printed too.
const MAX_PRINTED_ENTRIES: usize = 8;

/// The entries of a vector, those in the middle of a long one left out.
fn shortened(x: &Vector) -> String {
    let text = |value: &f64| format!("{value:.6e}");
    let mut entries: Vec<String> = x.iter().take(MAX_PRINTED_ENTRIES).map(text).collect();
    if let Some(last) = x.iter().skip(MAX_PRINTED_ENTRIES).last() {
        if x.len() > MAX_PRINTED_ENTRIES + 1 {
            entries.push("…".to_owned());
        }
        entries.push(text(last));
    }
    format!("[{}]", entries.join(", "))
}

/// Constraints printed of a report: the active ones first.
const MAX_PRINTED_CONSTRAINTS: usize = 8;

impl Report {
    /// Whether the solution satisfies all nonlinear constraints to their tolerance.
    pub fn is_feasible(&self) -> bool {
        self.constraints.iter().all(|constraint| constraint.satisfied)
    }

    /// Whether the end is confirmed as stationary, and all nonlinear constraints are satisfied there.
    pub fn is_confirmed(&self) -> bool {
        self.termination.is_confirmed() && self.is_feasible()
    }

    /// Advice on the next attempt, by the reason of the end.
    pub fn advice(&self) -> &'static str {
        self.termination.advice(self.certificate.as_ref().is_some_and(|certificate| certificate.convex))
    }

    fn write_constraints(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Some(penalty) = self.penalty else { return Ok(()) };
        let mut order: Vec<usize> = (0..self.constraints.len()).collect();
        let key = |j: usize| (self.constraints[j].violation, self.constraints[j].multiplier.abs());
        order.sort_by(|&a, &b| key(b).partial_cmp(&key(a)).unwrap_or(std::cmp::Ordering::Equal));
        let state = if self.is_feasible() { "satisfied" } else { "VIOLATED" };
        writeln!(f, "nonlinear:   {} constraints, {state}; penalty weight {penalty:.2e}", self.constraints.len())?;
        for &j in order.iter().take(MAX_PRINTED_CONSTRAINTS) {
            let ConstraintReport { value, violation, multiplier, .. } = &self.constraints[j];
            let violation = format!("relative violation {violation:.1e}");
            writeln!(f, "             c[{j}] = {value:.3e}, {violation}, multiplier {multiplier:.6e}")?;
        }
        Ok(())
    }
}

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "stopped:     {}", self.termination)?;
        writeln!(f, "             {}", self.advice())?;
        writeln!(
            f,
            "objective:   {:.10e}  (start {:.10e}), {} variables",
            self.value,
            self.start_value,
            self.solution.len()
        )?;
        writeln!(f, "solution:    {}", shortened(&self.solution))?;
        if let Some(certificate) = &self.certificate {
            writeln!(f, "certificate: {certificate}")?;
        }
        writeln!(f, "constraints: largest relative violation of a point evaluated {:.1e}", self.largest_violation)?;
        self.write_constraints(f)?;
        let counts = &self.counts;
        writeln!(
            f,
            "work:        {} evaluations: {} serious, {} null, {} refined, {} failed; {} restarts",
            counts.evaluations, counts.serious, counts.null, counts.refined, counts.failed, counts.restarts
        )?;
        let trials = &counts.trials;
        writeln!(
            f,
            "             trial points: {} of the cuts, {} of the curved model, {} of the composite model, {} for the confirmation",
            trials.cuts, trials.curved_model, trials.composite_model, trials.confirmation
        )?;
        if counts.jacobians > 0 {
            writeln!(f, "             {} Jacobians", counts.jacobians)?;
        }
        writeln!(
            f,
            "             {} subproblems ({} by the fallback solver); {:.3} s for the whole run",
            counts.qp_solves, counts.qp_fallbacks, self.seconds
        )?;
        for warning in &self.warnings {
            writeln!(f, "warning:     {warning}")?;
        }
        Ok(())
    }
}
