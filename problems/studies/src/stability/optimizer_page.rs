//! The page of the optimizer's study: the parts that are asked for, as text or as one JSON object.

use crate::stability::mixed_units::{UnitReport, mixed_units};
use crate::stability::optimizer_terminations::{TerminationReport, markdown, terminations};
use clap::ValueEnum;
use problems::commands::{Failure, json};
use serde::Serialize;

/// A part of the study.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Part {
    /// The collection and the runs in mixed units.
    All,
    /// The collection of test problems in all its variants.
    Collection,
    /// Convex problems whose variables have different units.
    Units,
}

/// Runs that are listed one by one.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Listed {
    /// Those with a false termination, those that do not reach the minimum, and those that do not say so.
    Short,
    /// All runs.
    All,
}

/// What the parts came to.
#[derive(Debug, Serialize)]
struct Reports {
    #[serde(flatten)]
    collection: Option<TerminationReport>,
    #[serde(skip_serializing_if = "Option::is_none")]
    units: Option<UnitReport>,
}

impl Reports {
    fn false_terminations(&self) -> usize {
        let collection = self.collection.as_ref().map_or(0, |report| report.offenders.len());
        collection + self.units.as_ref().map_or(0, |report| report.false_terminations)
    }

    fn text(&self, listed: Option<Listed>) -> String {
        let mut parts: Vec<String> = self.collection.iter().map(markdown).collect();
        if let Some(report) = &self.units {
            parts.push(report.markdown());
            parts.extend(listed.map(|listed| report.list(listed == Listed::All)));
        }
        parts.join("\n")
    }
}

/// The page; `only` selects runs in mixed units by their names. A false termination is a failure that keeps the text.
///
/// # Errors
/// [`Failure::Incomplete`] with the text, and [`Failure::Input`] for options of another part.
pub fn page(part: Part, only: Option<&str>, listed: Option<Listed>, as_json: bool) -> Result<String, Failure> {
    if part != Part::Units && (only.is_some() || listed.is_some()) {
        return Err(Failure::Input("--only and --list need --optimizer units".to_owned()));
    }
    let collection = (part != Part::Units).then(|| terminations(|_| true)).transpose().map_err(Failure::computation)?;
    let wanted = |name: &str| only.is_none_or(|only| name.contains(only));
    let units = (part != Part::Collection).then(|| mixed_units(wanted)).transpose().map_err(Failure::Computation)?;
    if units.as_ref().is_some_and(|report| report.runs == 0) {
        return Err(Failure::Input(format!("--only {}: no run", only.unwrap_or_default())));
    }
    let reports = Reports { collection, units };
    let text = if as_json { json(&reports)? } else { reports.text(listed) };
    match reports.false_terminations() {
        0 => Ok(text),
        count => Err(Failure::Incomplete { text, reason: format!("{count} false terminations"), status: 1 }),
    }
}
