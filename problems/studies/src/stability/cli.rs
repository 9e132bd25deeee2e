//! The command line of the study.

use crate::stability::record::{Outcome, Record, Report};
use crate::stability::{case, table};
use clap::Parser;
use problems::commands::{Failure, finish, json};
use std::process::ExitCode;

/// What the solvers and the optimizer do with stiff and extreme cases.
#[derive(Debug, Clone, Parser)]
#[command(name = "stability", version)]
pub struct Arguments {
    /// The fast subset only.
    #[arg(long)]
    pub quick: bool,
    /// Only cases whose group or name contains this text.
    #[arg(long, value_name = "TEXT")]
    pub only: Option<String>,
    /// Print one JSON object on stdout.
    #[arg(long)]
    pub json: bool,
}

/// Runs the binary.
pub fn run() -> ExitCode {
    finish(execute(&Arguments::parse()))
}

/// Runs the cases that the arguments select; the text belongs on stdout, also when cases are broken.
fn execute(arguments: &Arguments) -> Result<String, Failure> {
    let report = Report::new(select(arguments)?);
    let text = if arguments.json { json(&report)? } else { table::markdown(&report) };
    let broken: Vec<&str> = report.records.iter().filter(|r| r.outcome == Outcome::Broken).map(|r| &*r.name).collect();
    if broken.is_empty() {
        return Ok(text);
    }
    Err(Failure::Incomplete { text, reason: format!("not as expected: {}", broken.join("; ")), status: 1 })
}

fn select(arguments: &Arguments) -> Result<Vec<Record>, Failure> {
    let wanted = |text: &str| arguments.only.as_deref().is_none_or(|only| text.contains(only));
    let mut records = Vec::new();
    for case in case::all() {
        if (wanted(case.group) || wanted(&case.name)) && (case.quick || !arguments.quick) {
            let record = case.run();
            eprintln!("{}", table::progress(&record));
            records.push(record);
        }
    }
    if records.is_empty() {
        return Err(Failure::Input(format!("--only {}: no case", arguments.only.as_deref().unwrap_or_default())));
    }
    Ok(records)
}
