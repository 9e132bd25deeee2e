//! The report of a run as a Python object.

use crate::certificate::Certificate;
use crate::convert::{self, json};
use nonsmooth::{Polyhedron, Report, Termination, Vector};
use numpy::PyArray1;
use pyo3::prelude::*;

/// The report of a run, with the set that its certificate refers to.
#[pyclass(frozen, module = "nonsmooth._engine")]
#[derive(Debug)]
pub struct RunOutcome {
    /// Report as the engine returns it.
    pub report: Report,
    /// Admissible set, by which the certificate is checked.
    pub set: Polyhedron,
    /// One subgradient at the solution, if it is known.
    pub subgradient: Option<Vector>,
    /// The runs of an optimization that has several.
    pub runs: Vec<serde_json::Value>,
}

#[pymethods]
impl RunOutcome {
    /// The best admissible point.
    #[getter]
    fn x<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        convert::array(py, &self.report.solution)
    }

    /// Value of the function at the solution.
    #[getter]
    fn value(&self) -> f64 {
        self.report.value
    }

    /// One subgradient there, if it is known.
    #[getter]
    fn subgradient<'py>(&self, py: Python<'py>) -> Option<Bound<'py, PyArray1<f64>>> {
        self.subgradient.as_ref().map(|subgradient| convert::array(py, subgradient))
    }

    /// Name of the reason why the run ended.
    #[getter]
    fn reason(&self) -> &'static str {
        match self.report.termination {
            Termination::Stationary { .. } => "stationary",
            Termination::StationaryUnconfirmed { .. } => "stationary_unconfirmed",
            Termination::Infeasible { .. } => "infeasible",
            Termination::Violated { .. } => "violated",
            Termination::DegenerateConstraints { .. } => "degenerate_constraints",
            Termination::NoiseLimit { .. } => "noise_limit",
            Termination::StepTooShort { .. } => "step_too_short",
            Termination::EvaluationLimit => "evaluation_limit",
            Termination::IterationLimit => "iteration_limit",
            Termination::TimeLimit => "time_limit",
            Termination::StoppedByObserver | Termination::Unfinished => "stopped",
            Termination::UnboundedBelow => "unbounded_below",
            Termination::OracleFailing { .. } => "function_failing",
            Termination::OracleContradiction { .. } => "function_contradictory",
            Termination::SubproblemFailed { .. } => "subproblem_failed",
            _ => "other",
        }
    }

    /// Whether the solution is a stationary point and confirmed.
    #[getter]
    fn confirmed(&self) -> bool {
        self.report.is_proved()
    }

    /// Why the run ended, with numbers.
    #[getter]
    fn message(&self) -> String {
        match &self.report.termination {
            Termination::OracleFailing { failures, last } => {
                format!("fun failed {failures} times in a row near the best point; last: {last}")
            }
            termination => termination.to_string(),
        }
    }

    /// What the engine advises; the package has its own advice for users of Python.
    #[getter]
    fn advice(&self) -> &'static str {
        self.report.advice()
    }

    /// Whether the problem was declared convex.
    #[getter]
    fn convex(&self) -> bool {
        self.report.certificate.as_ref().is_some_and(|certificate| certificate.convex)
    }

    /// Largest value minus minimum that the cuts of a convex function leave, if it was declared convex and confirmed.
    #[getter]
    fn gap(&self) -> Option<f64> {
        match self.report.termination {
            Termination::Stationary { gap, .. } => gap,
            _ => None,
        }
    }

    /// The runs of an optimization that has several, as JSON.
    #[getter]
    fn runs(&self) -> PyResult<String> {
        json(&self.runs)
    }

    /// Counts as JSON.
    #[getter]
    fn counts(&self) -> PyResult<String> {
        json(&self.report.counts)
    }

    /// One record per evaluation, as JSON.
    #[getter]
    fn history(&self) -> PyResult<String> {
        json(&self.report.history)
    }

    /// The nonlinear constraints at the solution, as JSON.
    #[getter]
    fn constraints(&self) -> PyResult<String> {
        json(&self.report.constraints)
    }

    /// What went wrong without ending the run.
    #[getter]
    fn warnings(&self) -> Vec<String> {
        self.report.warnings.clone()
    }

    /// Value at the start.
    #[getter]
    fn start_value(&self) -> f64 {
        self.report.start_value
    }

    /// Largest relative violation of the set among all points evaluated.
    #[getter]
    fn largest_violation(&self) -> f64 {
        self.report.largest_violation
    }

    /// Weight of the violation in the merit that the run has ended with; none without nonlinear constraints.
    #[getter]
    fn penalty(&self) -> Option<f64> {
        self.report.penalty
    }

    /// Wall-clock seconds of the run.
    #[getter]
    fn seconds(&self) -> f64 {
        self.report.seconds
    }

    /// The certificate, if a subproblem was solved.
    #[getter]
    fn certificate(&self) -> Option<Certificate> {
        let certificate = self.report.certificate.clone()?;
        Some(Certificate { certificate, set: self.set.clone() })
    }

    /// The summary of one page.
    fn __str__(&self) -> String {
        self.report.to_string()
    }
}
