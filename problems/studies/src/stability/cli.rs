//! The command line of the study.

use crate::stability::case::{self, CaseOutcome, Record};
use crate::stability::{all, random};
use clap::Parser;
use problems::commands::{Failure, Folder, arguments, finish, notice};
use std::path::PathBuf;
use std::process::ExitCode;

/// What the contact solvers do with stiff and extreme cases.
#[derive(Debug, Clone, Parser)]
#[command(name = "stability", version)]
struct Options {
    /// Only cases whose group or name contains this text.
    #[arg(long, value_name = "TEXT")]
    only: Option<String>,
    /// Random scenes instead of the cases: so many of them.
    #[arg(long, value_name = "COUNT", conflicts_with = "only", value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    random: Option<u32>,
    /// Seed of the random scenes.
    #[arg(long, value_name = "SEED", default_value_t = 1, requires = "random")]
    seed: u64,
    /// Folder for the files of random scenes that fell short.
    #[arg(long, value_name = "DIR", requires = "random")]
    out: Option<PathBuf>,
}

/// Runs the binary with the arguments of the process and returns its exit status.
pub fn run() -> ExitCode {
    finish(execute(&arguments()), None)
}

/// Runs what the arguments select; the text belongs on stdout, also when cases are broken.
fn execute(options: &Options) -> Result<String, Failure> {
    if let Some(count) = options.random {
        return at_random(options, count as usize);
    }
    let wanted = |text: &str| options.only.as_deref().is_none_or(|only| text.contains(only));
    let cases = all().into_iter().filter(|case| wanted(case.group) || wanted(&case.name));
    let run = |case: case::Case| {
        let record = case.run();
        notice(&record.progress());
        record
    };
    let records: Vec<Record> = cases.map(run).collect();
    if records.is_empty() {
        return Err(Failure::Input(format!("--only {}: no case", options.only.as_deref().unwrap_or_default())));
    }
    let text = case::markdown(&records);
    let broken: Vec<&str> =
        records.iter().filter(|record| record.outcome == CaseOutcome::Broken).map(|record| &*record.name).collect();
    if broken.is_empty() {
        return Ok(text);
    }
    Err(Failure::Incomplete { text, reason: format!("not as expected: {}", broken.join("; ")), status: 1 })
}

/// The study of random scenes.
fn at_random(options: &Options, count: usize) -> Result<String, Failure> {
    let report = random::run(options.seed, count);
    if let Some(path) = &options.out {
        let folder = Folder::create(path, 1 << 20, false)?;
        for short in &report.short {
            folder.write(&format!("{:05}.toml", short.index), format!("# {}\n{}", short.reason, short.text))?;
        }
    }
    Ok(report.markdown())
}
