//! Minimises the 2D toy with the bundle-trust engine and compares with the known minimiser.

use clap::Parser;
use figures::{ColourScales, Map, MapPanel, grid_faces};
use problems::commands::{Failure, Folder, arguments, finish, printed_with_files};
use problems::toy;
use std::path::PathBuf;
use std::process::ExitCode;

/// Minimises the 2D toy (two nodes on a shaped support with Coulomb friction) and compares with the exact minimiser.
/// Exit status: 0 every run found it, 1 the computation failed, 2 bad input.
#[derive(Debug, Parser)]
#[command(name = "toy2d", version)]
struct Arguments {
    /// One start A,B in [-4, 6]² instead of random ones
    #[arg(long, value_name = "A,B", value_parser = parse_start, allow_hyphen_values = true)]
    start: Option<[f64; 2]>,
    /// Number of random starts
    #[arg(long, value_name = "N", default_value_t = 20, value_parser = clap::value_parser!(u32).range(1..=100_000))]
    starts: u32,
    /// Seed of the random starts
    #[arg(long, value_name = "S", default_value_t = 1, value_parser = clap::value_parser!(u32).range(0..))]
    seed: u32,
    /// Print one JSON object instead of the page
    #[arg(long)]
    json: bool,
    /// Folder for a picture of the landscape
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// With --out: rename a DIR that holds results to the first free DIR.1, DIR.2, ...
    #[arg(long, requires = "out")]
    overwrite: bool,
    /// Grid cells per edge of the landscape
    #[arg(long, value_name = "N", default_value_t = 200, value_parser = clap::value_parser!(u32).range(1..=4096))]
    cells: u32,
}

fn main() -> ExitCode {
    finish(run(&arguments()), None)
}

fn run(arguments: &Arguments) -> Result<String, Failure> {
    let folder = arguments.out.as_deref().map(|path| Folder::create(path, 1, arguments.overwrite)).transpose()?;
    let starts = match arguments.start {
        Some(start) => vec![start],
        None => toy::random_starts(arguments.seed.into(), arguments.starts as usize),
    };
    let study = toy::run_study(&starts)?.ok_or_else(|| Failure::computation("no start"))?;
    let text =
        if arguments.json { serde_json::to_string(&study).map_err(Failure::computation)? } else { study.to_string() };
    let text = text.trim_end().to_owned() + "\n";
    let draw = |folder: &Folder| picture(folder, arguments.cells as usize);
    let text = printed_with_files(text, arguments.json, folder.as_ref(), draw)?;
    if study.all_found() {
        return Ok(text);
    }
    let (missed, runs) = (study.runs.len() - study.successes(), study.runs.len());
    let reason = format!("{missed} of {runs} runs missed the minimiser by more than {:e}", toy::SUCCESS);
    Err(Failure::Incomplete { text, reason, status: 1 })
}

/// Θ over the controls.
fn picture(folder: &Folder, cells: usize) -> Result<(), Failure> {
    let (points, values) = toy::landscape(cells)?.into_iter().unzip();
    let map = Map {
        name: "landscape".into(),
        title: "Two nodes on a shaped support with friction: Θ over its two controls".into(),
        quantity: "Θ".into(),
        unit: String::new(),
        axes: ["control 1".into(), "control 2".into()],
        scales: ColourScales::Common,
        contours: true,
        panels: vec![MapPanel { caption: "Θ".into(), points, faces: grid_faces([cells + 1; 2]), values }],
    };
    folder.draw(&map.figure().map_err(Failure::computation)?)
}

fn parse_start(text: &str) -> Result<[f64; 2], String> {
    let allowed = format!("expected two numbers A,B between {} and {}", toy::LOWER, toy::UPPER);
    let numbers = text.split(',').map(|part| part.trim().parse::<f64>()).collect::<Result<Vec<_>, _>>();
    match numbers.as_deref() {
        Ok(&[first, second]) if [first, second].iter().all(|x| (toy::LOWER..=toy::UPPER).contains(x)) => {
            Ok([first, second])
        }
        _ => Err(allowed),
    }
}
