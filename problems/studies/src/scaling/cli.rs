//! The command line of the study.

use crate::scaling::cases::{Case, SceneName, Subject, Variant, option_name};
use crate::scaling::{measure, table};
use clap::Parser;
use problems::commands::{Failure, arguments, finish, json, notice};
use serde::Serialize;
use std::path::PathBuf;
use std::process::ExitCode;

/// Work, time and memory of the contact solvers over growing meshes.
#[derive(Debug, Clone, Parser)]
#[command(name = "scaling", version)]
struct Options {
    /// s up to 12; direct condensation up to 35 bricks per edge.
    #[arg(long, conflicts_with = "case")]
    full: bool,
    /// Print one JSON object on stdout.
    #[arg(long)]
    json: bool,
    /// Which scene.
    #[arg(long, value_enum, default_value_t = SceneName::Signorini)]
    scene: SceneName,
    /// One case only: N bricks and S subdomains per edge of each body.
    #[arg(long, value_name = "N/S", value_parser = Case::parse)]
    case: Option<Case>,
    /// The first load case of a scene file on its own mesh, in place of the paper's scenes; may be given several times.
    #[arg(long, value_name = "SCENE.toml", conflicts_with_all = ["case", "full", "scene"])]
    file: Vec<PathBuf>,
    /// One solver only.
    #[arg(long, value_enum)]
    variant: Option<Variant>,
    /// Clusters of about C³ subdomains, which share six rigid motions; several, with commas, are measured in turn.
    #[arg(long, value_name = "C", value_delimiter = ',', default_value = "1")]
    clusters: Vec<usize>,
}

/// Everything measured in one run.
#[derive(Serialize)]
struct ScalingReport {
    machine_threads: usize,
    /// One entry per case, solver and clusters.
    rows: Vec<measure::ScalingRow>,
    /// Messages about cases that could not be measured.
    failures: Vec<String>,
}

/// What is measured, in order.
fn plan(options: &Options) -> Vec<(Subject, Variant, usize)> {
    let subjects: Vec<Subject> = if options.file.is_empty() {
        let cases = options.case.map_or_else(|| Case::all(options.full), |case| vec![case]);
        cases.into_iter().map(|case| Subject::Paper(options.scene, case)).collect()
    } else {
        options.file.iter().cloned().map(Subject::File).collect()
    };
    let mut plan = vec![];
    for subject in subjects {
        for variant in options.variant.map_or_else(|| subject.variants(options.full), |variant| vec![variant]) {
            let torn = variant.preconditioner().is_some();
            let clusters = options.clusters.iter().filter(|&&c| torn || c == 1);
            plan.extend(clusters.map(|&c| (subject.clone(), variant, c)));
        }
    }
    plan
}

/// Runs the binary with the arguments of the process and returns its exit status.
pub fn run() -> ExitCode {
    finish(execute(&arguments()), None)
}

/// Measures what the arguments ask for; cases that fail are listed in the report.
fn execute(options: &Options) -> Result<String, Failure> {
    let (mut rows, mut failures, plan) = (Vec::new(), Vec::new(), plan(options));
    if plan.is_empty() {
        return Err(Failure::Input("--clusters is allowed with solvers on total FETI only".into()));
    }
    for (subject, variant, clusters) in plan {
        match measure::row(&subject, variant, clusters) {
            Ok(row) => {
                notice(&table::progress(&row));
                rows.push(row);
            }
            Err(Failure::Input(reason)) => return Err(Failure::Input(reason)),
            Err(failure) => failures.push(format!("{subject} {}: {failure}", option_name(&variant))),
        }
    }
    let machine_threads = std::thread::available_parallelism().map_or(1, usize::from);
    let report = ScalingReport { machine_threads, rows, failures };
    let text = if options.json { json(&report)? } else { table::markdown(machine_threads, &report.rows) };
    if report.failures.is_empty() {
        return Ok(text);
    }
    Err(Failure::Incomplete { text, reason: report.failures.join("; "), status: 1 })
}
