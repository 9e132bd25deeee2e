//! What Python is told of a run.

use crate::certificate::Certificate;
use crate::convert::{self, json};
use nonsmooth::{Polyhedron, Report, Termination, Vector};
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// The report of a run, with the set that its certificate refers to.
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

impl<'py> IntoPyObject<'py> for RunOutcome {
    type Target = PyDict;
    type Output = Bound<'py, PyDict>;
    type Error = PyErr;

    /// A dictionary; `RunOutcome` in `_engine.pyi` lists its entries.
    fn into_pyobject(self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let Self { report, set, subgradient, runs } = self;
        let dict = PyDict::new(py);
        dict.set_item("x", convert::array(py, &report.solution))?;
        dict.set_item("value", report.value)?;
        dict.set_item("subgradient", subgradient.map(|subgradient| convert::array(py, &subgradient)))?;
        dict.set_item("reason", reason(&report.termination))?;
        dict.set_item("confirmed", report.is_confirmed())?;
        dict.set_item("message", message(&report.termination))?;
        dict.set_item("advice", report.advice())?;
        dict.set_item("convex", report.certificate.as_ref().is_some_and(|certificate| certificate.convex))?;
        let gap = if let Termination::Stationary { gap, .. } = report.termination { gap } else { None };
        dict.set_item("gap", gap)?;
        dict.set_item("runs", json(&runs)?)?;
        dict.set_item("counts", json(&report.counts)?)?;
        dict.set_item("history", json(&report.history)?)?;
        dict.set_item("constraints", json(&report.constraints)?)?;
        dict.set_item("start_value", report.start_value)?;
        dict.set_item("largest_violation", report.largest_violation)?;
        dict.set_item("penalty", report.penalty)?;
        dict.set_item("seconds", report.seconds)?;
        dict.set_item("warnings", report.warnings)?;
        dict.set_item("certificate", report.certificate.map(|certificate| Certificate { certificate, set }))?;
        Ok(dict)
    }
}

/// Name of the reason why a run ended.
fn reason(termination: &Termination) -> &'static str {
    match termination {
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

/// Why a run ended, with numbers.
fn message(termination: &Termination) -> String {
    match termination {
        Termination::OracleFailing { failures, last } => {
            format!("fun failed {failures} times in a row near the best point; last: {last}")
        }
        termination => termination.to_string(),
    }
}
