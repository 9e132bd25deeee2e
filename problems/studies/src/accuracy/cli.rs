//! The command line of the study.

use crate::accuracy::extent::{Extent, Part, SCENES};
use crate::accuracy::manufactured::manufactured_errors;
use crate::accuracy::report::AccuracyReport;
use crate::accuracy::{algebra, discretisation, optimization, pictures, subgradient, tables};
use crate::scaling::SceneName;
use clap::Parser;
use problems::commands::{Failure, Folder, arguments, finish, json, notice};
use std::path::PathBuf;
use std::process::ExitCode;
use std::time::Instant;

/// Error against run time: discretisation, contact solvers, subgradient, optimization.
#[derive(Debug, Clone, Parser)]
#[command(name = "accuracy", version)]
pub struct AccuracyArguments {
    /// Meshes up to 35 bricks per edge, optimization up to 24, instead of a study of about two minutes.
    #[arg(long, conflicts_with = "smoke")]
    pub full: bool,
    /// A few seconds on the smallest meshes: shows that everything works, not what is true.
    #[arg(long)]
    pub smoke: bool,
    /// One part only.
    #[arg(long, value_enum)]
    pub part: Option<Part>,
    /// Print one JSON object on stdout.
    #[arg(long)]
    pub json: bool,
    /// Folder for report.json, report.md and the pictures (SVG; PNG as well with the feature `png`).
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
}

impl AccuracyArguments {
    fn extent(&self) -> Extent {
        match (self.smoke, self.full) {
            (true, _) => Extent::SMOKE,
            (_, true) => Extent::FULL,
            _ => Extent::QUICK,
        }
    }

    fn wants(&self, part: Part) -> bool {
        self.part.is_none_or(|only| only == part)
    }
}

/// Runs the binary with the arguments of the process and returns its exit status.
pub fn run() -> ExitCode {
    let arguments: AccuracyArguments = arguments();
    finish(execute(&arguments), arguments.out.as_deref())
}

/// Measures, writes the folder, and returns what belongs on stdout.
fn execute(arguments: &AccuracyArguments) -> Result<String, Failure> {
    let folder = arguments.out.as_deref().map(|path| Folder::create(path, 1 << 20, false)).transpose()?;
    let report = measure(arguments)?;
    let (object, page) = (json(&report)?, tables::markdown(&report));
    if let Some(folder) = folder {
        folder.write("report.json", &object)?;
        folder.write("report.md", &page)?;
        for figure in pictures::all(&report).map_err(Failure::computation)? {
            folder.draw(&figure)?;
        }
    }
    Ok(if arguments.json { object } else { page })
}

fn measure(arguments: &AccuracyArguments) -> Result<AccuracyReport, Failure> {
    let (clock, extent) = (Instant::now(), arguments.extent());
    let machine_threads = std::thread::available_parallelism().map_or(1, usize::from);
    let mut report = AccuracyReport { machine_threads, ..AccuracyReport::default() };
    let progress = |what: &str| notice(&format!("{:>7.1} s  {what}", clock.elapsed().as_secs_f64()));
    if arguments.wants(Part::Discretisation) {
        for &bricks in extent.meshes.iter().filter(|bricks| **bricks <= LARGEST_SMOOTH) {
            report.smooth.push(manufactured_errors(bricks)?);
        }
        for scene in SCENES {
            report.discretisation.push(discretisation::study(scene, extent.meshes)?);
        }
        progress("discretisation");
    }
    if arguments.wants(Part::Algebra) {
        for scene in SCENES {
            report.algebra.push(algebra::study(scene, extent.algebra_mesh, extent.exponents)?);
        }
        progress("contact solvers");
    }
    if arguments.wants(Part::Subgradient) {
        report.subgradient = Some(subgradient::study(extent)?);
        progress("subgradient");
    }
    if arguments.wants(Part::Optimization) {
        report.optimization.push(optimization::study(SceneName::Signorini, extent)?);
        progress("optimization");
    }
    report.seconds = clock.elapsed().as_secs_f64();
    Ok(report)
}

/// Largest mesh of the smooth solution: one sparse factor of the whole block.
const LARGEST_SMOOTH: usize = 24;
