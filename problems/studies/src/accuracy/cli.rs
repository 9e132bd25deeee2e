//! The command line of the study, how much is measured, and all that was.

use crate::accuracy::algebra::AlgebraStudy;
use crate::accuracy::discretisation::MeshStudy;
use crate::accuracy::manufactured::{self, ManufacturedErrors, manufactured_errors};
use crate::accuracy::optimization::OptimizationStudy;
use crate::accuracy::subgradient::SubgradientStudy;
use crate::scaling::SceneName;
use clap::{Parser, ValueEnum};
use problems::commands::{Failure, arguments, finish, json, notice};
use serde::Serialize;
use std::process::ExitCode;
use std::time::Instant;

/// A part of the study.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Part {
    /// Error of the discretisation.
    Discretisation,
    /// Error of the contact solvers.
    Algebra,
    /// Error of the subgradient, kinks.
    Subgradient,
    /// Distance from the minimum.
    Optimization,
}

/// Error against run time: discretisation, contact solvers, subgradient, optimization.
#[derive(Debug, Clone, Parser)]
#[command(name = "accuracy", version)]
struct Options {
    /// Meshes up to 35 bricks per edge, optimization up to 24, instead of a study of about two minutes.
    #[arg(long, conflicts_with = "smoke")]
    full: bool,
    /// A few seconds on the smallest meshes: shows that everything works, not what is true.
    #[arg(long)]
    smoke: bool,
    /// One part only.
    #[arg(long, value_enum)]
    part: Option<Part>,
    /// Print one JSON object on stdout.
    #[arg(long)]
    json: bool,
}

/// Size of the study; meshes are bricks per edge.
#[derive(Debug, Clone, Copy)]
struct Extent {
    /// Meshes of the study of the discretisation.
    meshes: &'static [usize],
    /// Mesh of the study of the contact solvers.
    algebra_mesh: usize,
    /// Exponents e of the tolerances 10^(−e).
    exponents: &'static [i32],
    /// Mesh of the Taylor tables.
    taylor_mesh: usize,
    /// Kinks constructed per scene.
    kinks: usize,
    /// Meshes of the optimization, coarse to fine; all but coarse-to-fine work on the last.
    levels: &'static [usize],
    /// Evaluations per optimization, on each mesh of coarse-to-fine as well.
    evaluations: usize,
}

const SMOKE: Extent = Extent {
    meshes: &[4, 6, 8],
    algebra_mesh: 4,
    exponents: &[2, 6, 10],
    taylor_mesh: 4,
    kinks: 1,
    levels: &[4, 6],
    evaluations: 6,
};
const QUICK: Extent = Extent {
    meshes: &[4, 6, 8, 12, 16, 24],
    algebra_mesh: 8,
    exponents: &[2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12],
    taylor_mesh: 6,
    kinks: 4,
    levels: &[6, 12],
    evaluations: 60,
};
const FULL: Extent =
    Extent { meshes: &[4, 6, 8, 12, 16, 24, 35], algebra_mesh: 12, kinks: 12, levels: &[6, 12, 24], ..QUICK };

/// The scenes of the study.
const SCENES: [SceneName; 2] = [SceneName::Signorini, SceneName::Hertz];
/// Largest mesh of the smooth solution: one sparse factor of the whole block.
const LARGEST_SMOOTH: usize = 24;

/// The study; parts that were not asked for are empty.
#[derive(Debug, Default, Serialize)]
pub struct AccuracyReport {
    machine_threads: usize,
    /// Seconds of the whole study.
    seconds: f64,
    /// Errors for a manufactured smooth solution.
    smooth: Vec<ManufacturedErrors>,
    /// Errors of the discretisation per scene.
    pub discretisation: Vec<MeshStudy>,
    /// Errors of the contact solvers per scene.
    pub algebra: Vec<AlgebraStudy>,
    /// Taylor tables and kinks.
    subgradient: Option<SubgradientStudy>,
    /// Effect of mesh and tolerance on optimizations.
    pub optimization: Option<OptimizationStudy>,
}

/// Runs the binary with the arguments of the process and returns its exit status.
pub fn run() -> ExitCode {
    let options: Options = arguments();
    let text = measure(&options).and_then(|report| if options.json { json(&report) } else { Ok(report.markdown()) });
    finish(text, None)
}

fn measure(options: &Options) -> Result<AccuracyReport, Failure> {
    let clock = Instant::now();
    let extent = if options.smoke {
        SMOKE
    } else if options.full {
        FULL
    } else {
        QUICK
    };
    let machine_threads = std::thread::available_parallelism().map_or(1, usize::from);
    let mut report = AccuracyReport { machine_threads, ..AccuracyReport::default() };
    let wants = |part: Part| options.part.is_none_or(|only| only == part);
    let progress = |what: &str| notice(&format!("{:>7.1} s  {what}", clock.elapsed().as_secs_f64()));
    if wants(Part::Discretisation) {
        let small = extent.meshes.iter().filter(|bricks| **bricks <= LARGEST_SMOOTH);
        report.smooth = small.map(|&bricks| manufactured_errors(bricks)).collect::<Result<_, _>>()?;
        let of = |scene| MeshStudy::new(scene, extent.meshes);
        report.discretisation = SCENES.into_iter().map(of).collect::<Result<_, _>>()?;
        progress("discretisation");
    }
    if wants(Part::Algebra) {
        let of = |scene| AlgebraStudy::new(scene, extent.algebra_mesh, extent.exponents);
        report.algebra = SCENES.into_iter().map(of).collect::<Result<_, _>>()?;
        progress("contact solvers");
    }
    if wants(Part::Subgradient) {
        report.subgradient = Some(SubgradientStudy::new(&SCENES, extent.taylor_mesh, extent.kinks)?);
        progress("subgradient");
    }
    if wants(Part::Optimization) {
        report.optimization = Some(OptimizationStudy::new(SceneName::Signorini, extent.levels, extent.evaluations)?);
        progress("optimization");
    }
    report.seconds = clock.elapsed().as_secs_f64();
    Ok(report)
}

impl AccuracyReport {
    /// The tables of all parts.
    fn markdown(&self) -> String {
        let mut text = format!(
            "{} threads run at once on this machine; the study took {:.0} s.\n",
            self.machine_threads, self.seconds
        );
        text += &manufactured::markdown(&self.smooth);
        text.extend(self.discretisation.iter().map(MeshStudy::markdown));
        text.extend(self.algebra.iter().map(AlgebraStudy::markdown));
        text.extend(self.subgradient.iter().map(SubgradientStudy::markdown));
        text.extend(self.optimization.iter().map(OptimizationStudy::markdown));
        text
    }
}
