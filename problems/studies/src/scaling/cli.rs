//! The command line of the study, and what its warm states differ by.

use crate::scaling::cases::{Case, Extent, SceneName, Variant};
use crate::scaling::report::Report;
use crate::scaling::{children, measure, table};
use clap::Parser;
use nonsmooth::verify::seeded_direction;
use problems::commands::Failure;
use std::process::ExitCode;

/// Work, time and memory of the contact solvers over growing meshes.
#[derive(Debug, Clone, Parser)]
#[command(version)]
pub struct Arguments {
    /// s = 2 and 3 only.
    #[arg(long, conflicts_with_all = ["full", "case"])]
    pub quick: bool,
    /// s up to 7; direct condensation up to 35 bricks per edge.
    #[arg(long, conflicts_with = "case")]
    pub full: bool,
    /// Print one JSON object on stdout.
    #[arg(long)]
    pub json: bool,
    /// Which scene.
    #[arg(long, value_enum, default_value_t = SceneName::Signorini)]
    pub scene: SceneName,
    /// One case only: N bricks and S subdomains per edge of each body.
    #[arg(long, value_name = "N/S", value_parser = Case::parse)]
    pub case: Option<Case>,
    /// One solver only; with --case it is measured in this process.
    #[arg(long, value_enum)]
    pub variant: Option<Variant>,
}

/// Seed of the change of the controls.
const SEED: u64 = 20_231;
/// Largest change of a control, relative to the height of the body: 0.1 mm for the 100 mm of Example 5.1.
const CHANGE: f64 = 1e-3;

impl Arguments {
    fn extent(&self) -> Extent {
        match (self.quick, self.full) {
            (true, _) => Extent::Quick,
            (_, true) => Extent::Full,
            _ => Extent::Usual,
        }
    }

    /// What is measured, in order.
    fn plan(&self) -> Vec<(Case, Variant)> {
        let extent = self.extent();
        let cases = self.case.map_or_else(|| extent.cases(), |case| vec![case]);
        let variants = |case: Case| {
            let all = case.variants(extent).into_iter().filter(|&variant| self.variant.is_none_or(|v| v == variant));
            all.map(move |variant| (case, variant)).collect::<Vec<_>>()
        };
        cases.into_iter().flat_map(variants).collect()
    }
}

/// Runs the binary.
pub fn run() -> ExitCode {
    let arguments = Arguments::parse();
    let result = execute(&arguments).and_then(|report| {
        let text = if arguments.json {
            serde_json::to_string_pretty(&report).map_err(|error| Failure::Computation(error.to_string()))? + "\n"
        } else {
            table::markdown(&report)
        };
        print!("{text}");
        if report.failures.is_empty() { Ok(()) } else { Err(Failure::Computation(report.failures.join("; "))) }
    });
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            eprintln!("error: {failure}");
            failure.exit_code()
        }
    }
}

/// Measures what the arguments ask for; cases that fail are listed in the report.
///
/// # Errors
/// [`Failure`] for bad input, and for a failing case that was asked for alone.
fn execute(arguments: &Arguments) -> Result<Report, Failure> {
    if let (Some(case), Some(variant)) = (arguments.case, arguments.variant) {
        let change = change(arguments.scene, case)?;
        return Ok(Report::new(vec![measure::row(arguments.scene, case, variant, &change)?], Vec::new()));
    }
    let (mut rows, mut failures) = (Vec::new(), Vec::new());
    for (case, variant) in arguments.plan() {
        match children::row(arguments.scene, case, variant) {
            Ok(row) => {
                eprintln!("{}", table::progress(&row));
                rows.push(row);
            }
            Err(Failure::Input(reason)) => return Err(Failure::Input(reason)),
            Err(failure) => {
                eprintln!("{failure}");
                failures.push(failure.to_string());
            }
        }
    }
    Ok(Report::new(rows, failures))
}

/// Change of the controls between two evaluations, mm.
fn change(scene: SceneName, case: Case) -> Result<Vec<f64>, Failure> {
    let scene = scene.scene(case)?;
    let controls = scene.control_points[0] * scene.control_points[1];
    Ok(seeded_direction(controls, SEED).iter().map(|entry| CHANGE * scene.start_height * entry).collect())
}
