//! Minimises the 2D toy with the bundle-trust engine and compares with the known minimiser.

use clap::Parser;
use problems::toy::{self, landscape::Landscape};
use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::path::PathBuf;
use std::process::ExitCode;

/// Minimises the 2D toy (two nodes on a shaped support with Coulomb friction) and compares with the exact minimiser.
/// Exit status: 0 every run found it, 1 the computation failed, 2 bad input.
#[derive(Debug, Parser)]
#[command(version)]
struct Arguments {
    /// One start A,B in [-4, 6]² instead of random ones
    #[arg(long, value_name = "A,B", value_parser = parse_start, allow_hyphen_values = true)]
    start: Option<[f64; 2]>,
    /// Number of random starts
    #[arg(long, value_name = "N", default_value_t = 20, value_parser = clap::value_parser!(u32).range(1..=100_000))]
    starts: u32,
    /// Seed of the random starts
    #[arg(long, value_name = "S", default_value_t = 1)]
    seed: u64,
    /// Print one JSON object instead of the page
    #[arg(long)]
    json: bool,
    /// Also write the landscape of the objective as comma-separated values
    #[arg(long, value_name = "FILE.csv")]
    landscape: Option<PathBuf>,
    /// Grid cells per edge of the landscape
    #[arg(long, value_name = "N", default_value_t = 200, value_parser = clap::value_parser!(u32).range(1..=4096))]
    cells: u32,
}

/// Bad input and failed computations, with their exit status.
enum Failure {
    Input(String),
    Computation(String),
}

fn main() -> ExitCode {
    match run(&Arguments::parse()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(Failure::Computation(message)) => report(&message, 1),
        Err(Failure::Input(message)) => report(&message, 2),
    }
}

fn report(message: &str, status: u8) -> ExitCode {
    // A closed stderr leaves the exit status as the message.
    let _ = writeln!(io::stderr(), "error: {message}");
    ExitCode::from(status)
}

fn run(arguments: &Arguments) -> Result<(), Failure> {
    if let Some(file) = &arguments.landscape {
        write_landscape(file, arguments.cells as usize)?;
    }
    let starts = match arguments.start {
        Some(start) => vec![start],
        None => toy::random_starts(arguments.seed, arguments.starts as usize),
    };
    let study = toy::run_study(&starts).map_err(computation)?.ok_or_else(|| computation("no start"))?;
    let text = if arguments.json { serde_json::to_string(&study).map_err(computation)? } else { study.to_string() };
    writeln!(io::stdout(), "{}", text.trim_end()).map_err(computation)?;
    if study.all_found() {
        return Ok(());
    }
    let missed = study.runs.len() - study.successes();
    Err(computation(format!(
        "{missed} of {} runs missed the minimiser by more than {:e}",
        study.runs.len(),
        toy::SUCCESS
    )))
}

fn write_landscape(file: &PathBuf, cells: usize) -> Result<(), Failure> {
    let refused = |error: io::Error| Failure::Input(format!("--landscape {}: {error}", file.display()));
    let landscape = Landscape::new(&toy::toy_objective(), cells).map_err(computation)?;
    let mut writer = BufWriter::new(File::create(file).map_err(refused)?);
    landscape.write_csv(&mut writer).and_then(|()| writer.flush()).map_err(refused)
}

fn computation(error: impl std::fmt::Display) -> Failure {
    Failure::Computation(error.to_string())
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
