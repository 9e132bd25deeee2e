//! The command line of the study.

use crate::stability::optimizer::{self, Part};
use crate::stability::record::{CaseOutcome, Record, StabilityReport};
use crate::stability::{matrix, random, table};
use clap::Parser;
use problems::commands::{Failure, Folder, arguments, finish, json, notice};
use std::path::PathBuf;
use std::process::ExitCode;

/// What the solvers and the optimizer do with stiff and extreme cases.
#[derive(Debug, Clone, Parser)]
#[command(name = "stability", version)]
pub struct StabilityArguments {
    /// The fast subset only.
    #[arg(long)]
    pub quick: bool,
    /// Only cases whose group or name contains this text; with `--optimizer`, only runs whose name does, and each with its end.
    #[arg(long, value_name = "TEXT")]
    pub only: Option<String>,
    /// Random scenes instead of the cases: so many of them.
    #[arg(long, value_name = "COUNT", conflicts_with_all = ["quick", "only"], value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    pub random: Option<u32>,
    /// Seed of the random scenes.
    #[arg(long, value_name = "SEED", default_value_t = 1, requires = "random")]
    pub seed: u64,
    /// Folder for the files of random scenes that fell short.
    #[arg(long, value_name = "DIR", requires = "random")]
    pub out: Option<PathBuf>,
    /// What the optimizer says at the end of its runs, held against what is true; minutes.
    #[arg(long, value_name = "PART", conflicts_with = "quick")]
    pub optimizer: Option<Part>,
    /// Print one JSON object on stdout.
    #[arg(long)]
    pub json: bool,
}

/// Runs the binary with the arguments of the process and returns its exit status.
pub fn run() -> ExitCode {
    finish(execute(&arguments()), None)
}

/// Runs the cases that the arguments select; the text belongs on stdout, also when cases are broken.
fn execute(arguments: &StabilityArguments) -> Result<String, Failure> {
    if let Some(part) = arguments.optimizer {
        return optimizer::page(part, arguments.only.as_deref(), arguments.json);
    }
    if let Some(count) = arguments.random {
        return at_random(arguments, count as usize);
    }
    let report = StabilityReport::new(select(arguments)?);
    let text = if arguments.json { json(&report)? } else { table::markdown(&report) };
    let broken: Vec<&str> =
        report.records.iter().filter(|r| r.outcome == CaseOutcome::Broken).map(|r| &*r.name).collect();
    if broken.is_empty() {
        return Ok(text);
    }
    Err(Failure::Incomplete { text, reason: format!("not as expected: {}", broken.join("; ")), status: 1 })
}

/// The study of random scenes.
fn at_random(arguments: &StabilityArguments, count: usize) -> Result<String, Failure> {
    let report = random::run(arguments.seed, count);
    if let Some(path) = &arguments.out {
        let folder = Folder::create(path, 1 << 20, false)?;
        for short in report.short() {
            folder.write(&format!("{:05}.toml", short.index), format!("# {}\n{}", short.reason, short.text))?;
        }
    }
    if arguments.json { json(&report) } else { Ok(report.markdown()) }
}

fn select(arguments: &StabilityArguments) -> Result<Vec<Record>, Failure> {
    let wanted = |text: &str| arguments.only.as_deref().is_none_or(|only| text.contains(only));
    let mut records = Vec::new();
    for case in matrix::all() {
        if (wanted(case.group) || wanted(&case.name)) && (case.quick || !arguments.quick) {
            let record = case.run();
            notice(&table::progress(&record));
            records.push(record);
        }
    }
    if records.is_empty() {
        return Err(Failure::Input(format!("--only {}: no case", arguments.only.as_deref().unwrap_or_default())));
    }
    Ok(records)
}
