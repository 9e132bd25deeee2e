//! Minimises the membrane over an obstacle with the bundle-trust engine.

use clap::Parser;
use figures::{ColourScales, Map, MapPanel, grid_faces};
use nonsmooth::{
    Accuracy, BundleTrust, BundleTrustConfig, NonsmoothObjective, Report, Request, StateSolver, TablePrinter, Vector,
};
use problems::commands::{Failure, Folder, arguments, failed, finish, json, printed_with_files};
use problems::membrane::{MembraneObjective, MembraneState, PATCHES, admissible_loads, example};
use std::io;
use std::path::PathBuf;
use std::process::ExitCode;

/// Loads a membrane over a dome so that it takes a wanted shape without pressing on the dome.
/// Exit status: 0 a report was printed, 1 the computation failed, 2 bad input.
#[derive(Debug, Parser)]
#[command(name = "membrane2d", version)]
struct Arguments {
    /// Grid cells per edge
    #[arg(long, value_name = "N", default_value_t = 48, value_parser = clap::value_parser!(u16).range(2..=512))]
    cells: u16,
    /// Evaluations allowed
    #[arg(long, value_name = "K", default_value_t = 400, value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    max_evaluations: u32,
    /// Print one line per evaluation on stderr
    #[arg(long)]
    table: bool,
    /// Print one JSON object instead of the page
    #[arg(long)]
    json: bool,
    /// Write report and pictures of displacement and reaction before and after
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// With --out: rename a DIR that holds results to the first free DIR.1, DIR.2, ...
    #[arg(long, requires = "out")]
    overwrite: bool,
}

fn main() -> ExitCode {
    let arguments: Arguments = arguments();
    finish(run(&arguments), arguments.out.as_deref())
}

fn run(arguments: &Arguments) -> Result<String, Failure> {
    let folder = arguments.out.as_deref().map(|path| Folder::create(path, 1 << 20, arguments.overwrite)).transpose()?;
    let theta = example(usize::from(arguments.cells)).map_err(Failure::computation)?;
    let config = BundleTrustConfig { max_evaluations: arguments.max_evaluations as usize, ..Default::default() };
    let mut method = BundleTrust::new(config)?.constraints(admissible_loads());
    if arguments.table {
        method = method.observer(TablePrinter::new(io::stderr()));
    }
    let start = Vector::zeros(PATCHES * PATCHES);
    let report = method.minimize(&theta, start.clone())?;
    let object = json(&report)?;
    let text = if arguments.json { object.clone() } else { page(&theta, &report)? };
    let write = |folder: &Folder| {
        folder.write("report.json", &object)?;
        let states = [solve(&theta, &start)?, solve(&theta, &report.solution)?];
        pictures(folder, &theta, &states)
    };
    let text = printed_with_files(text, arguments.json, folder.as_ref(), write)?;
    match failed(&report.termination) {
        Some(reason) => Err(Failure::Incomplete { text, reason, status: 1 }),
        None => Ok(text),
    }
}

fn page(theta: &MembraneObjective, report: &Report) -> Result<String, Failure> {
    let state = solve(theta, &report.solution)?;
    let (pressing, touching) = contact(theta, &state);
    let nodes = state.active.len();
    let value = theta.evaluate(&Request::tight(&report.solution))?.into_evaluation().value;
    Ok(format!(
        "Θ = {value:.6e}; of {nodes} nodes {pressing} are pressed by the dome and {touching} just touch it \
         (gap below {MAX_TOUCHING_GAP:e} of the largest height)\n{report}"
    ))
}

/// Largest gap, relative to the largest height, that counts as none.
const MAX_TOUCHING_GAP: f64 = 1e-6;

/// Numbers of nodes on which the obstacle presses, and of others that touch it: those are at the kink.
fn contact(theta: &MembraneObjective, state: &MembraneState) -> (usize, usize) {
    let largest = state.displacement.iter().fold(0.0_f64, |largest, u| largest.max(u.abs()));
    let gaps = state.displacement.iter().zip(theta.solver().obstacle()).map(|(u, psi)| u - psi);
    let touching =
        gaps.zip(&state.active).filter(|(gap, active)| !**active && *gap <= MAX_TOUCHING_GAP * largest).count();
    (state.active.iter().filter(|&&active| active).count(), touching)
}

fn solve(theta: &MembraneObjective, loads: &Vector) -> Result<MembraneState, Failure> {
    Ok(theta.solver().solve(loads, None, Accuracy::TIGHTEST)?)
}

/// One value per inner node.
type Field = fn(&MembraneState) -> &[f64];

/// Displacements and reactions before and after, each pair on one scale.
fn pictures(folder: &Folder, theta: &MembraneObjective, states: &[MembraneState; 2]) -> Result<(), Failure> {
    let grid = theta.solver().grid();
    let fields: [(&str, &str, Field); 2] = [
        ("displacement", "length", |state| &state.displacement),
        ("reaction", "load per area", |state| &state.reaction),
    ];
    // Inner nodes only: the first lies one cell inside the boundary.
    let inner = grid.cells - 1;
    if inner < 2 {
        // A single node makes no map.
        return Ok(());
    }
    let cell = grid.length / grid.cells as f64;
    for (name, unit, field) in fields {
        let panel = |(state, caption): (&MembraneState, &str)| MapPanel {
            caption: caption.to_owned(),
            points: (0..inner * inner)
                .map(|node| [node / inner + 1, node % inner + 1])
                .map(|node| [0, 1].map(|axis| grid.origin[axis] + cell * node[axis] as f64))
                .collect(),
            faces: grid_faces([inner; 2]),
            values: field(state).to_vec(),
        };
        let map = Map {
            name: name.to_owned(),
            title: format!("Membrane over a dome: {name}"),
            quantity: name.to_owned(),
            unit: unit.to_owned(),
            axes: ["x".into(), "y".into()],
            scales: ColourScales::Common,
            contours: false,
            panels: states.iter().zip(["start", "optimum"]).map(panel).collect(),
        };
        folder.draw(&map.figure().map_err(Failure::computation)?)?;
    }
    Ok(())
}
