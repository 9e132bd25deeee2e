//! The command line of the study.

use crate::stability::record::{Outcome, Record, Report};
use crate::stability::{matrix, optimizer_words, table};
use clap::Parser;
use problems::commands::Failure;
use std::process::ExitCode;

/// What the solvers and the optimizer do with stiff and extreme cases.
#[derive(Debug, Clone, Parser)]
#[command(version)]
pub struct Arguments {
    /// The fast subset only.
    #[arg(long)]
    pub quick: bool,
    /// Only cases whose group or name contains this text.
    #[arg(long, value_name = "TEXT")]
    pub only: Option<String>,
    /// What the optimizer says at the end of its runs, over the collection of test problems in all its variants; minutes.
    #[arg(long, conflicts_with_all = ["quick", "only"])]
    pub optimizer: bool,
    /// Print one JSON object on stdout.
    #[arg(long)]
    pub json: bool,
}

/// Runs the binary.
pub fn run() -> ExitCode {
    let arguments = Arguments::parse();
    match execute(&arguments) {
        Ok(text) => {
            print!("{text}");
            ExitCode::SUCCESS
        }
        Err((text, failure)) => {
            print!("{text}");
            eprintln!("error: {failure}");
            failure.exit_code()
        }
    }
}

/// Runs the cases that the arguments select; the text belongs on stdout, also when cases are broken.
fn execute(arguments: &Arguments) -> Result<String, (String, Failure)> {
    let bare = |failure| (String::new(), failure);
    if arguments.optimizer {
        return optimizer_words::page(arguments.json);
    }
    let records = select(arguments).map_err(bare)?;
    let report = Report::new(records);
    let text = if arguments.json {
        let text = serde_json::to_string_pretty(&report);
        text.map_err(|error| bare(Failure::Computation(error.to_string())))? + "\n"
    } else {
        table::markdown(&report)
    };
    let broken: Vec<&str> = report.records.iter().filter(|r| r.outcome == Outcome::Broken).map(|r| &*r.name).collect();
    if broken.is_empty() {
        return Ok(text);
    }
    let failure = Failure::Computation(format!("not as expected: {}", broken.join("; ")));
    Err((text, failure))
}

fn select(arguments: &Arguments) -> Result<Vec<Record>, Failure> {
    let wanted = |text: &str| arguments.only.as_deref().is_none_or(|only| text.contains(only));
    let mut records = Vec::new();
    for case in matrix::all() {
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
