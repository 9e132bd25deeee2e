//! The command line shared by the contact binaries: parse, compute, print.
//!
//! Contract (kept stable): `NAME [optimize|evaluate|verify] [options]`, for `contact3d` with a scene file before it; exit
//! status 0 success, 1 the computation failed, 2 bad input; `--json` prints one JSON object on stdout and nothing else there.

mod arguments;
mod controls;
mod evaluate;
mod failure;
mod optimize;
mod output;
mod picture;
mod source;
mod verify;

pub use arguments::{Arguments, Command};
pub use controls::parse as parse_controls;
pub use failure::Failure;
pub use source::Source;

use crate::contact_shape::ContactShape;
use crate::cost::PressureCost;
use crate::scene_file::{Case, schema};
use clap::Parser;
use nonsmooth::ReducedObjective;
use std::io::Write;
use std::path::PathBuf;
use std::process::ExitCode;

/// Θ of a scene.
pub type ContactObjective = ReducedObjective<ContactShape, PressureCost>;

/// Arguments of the binary that takes any scene.
#[derive(Debug, Parser)]
#[command(version, about, allow_negative_numbers = true)]
struct AnyScene {
    /// Scene file (docs/scenes.md; examples in problems/scenes).
    #[arg(value_name = "SCENE.toml")]
    scene: Option<PathBuf>,
    #[command(flatten)]
    arguments: Arguments,
}

/// Runs a binary on its own scene, the text of a scene file.
pub fn run(name: &str, text: &str) -> ExitCode {
    let arguments = Arguments::parse();
    finish(Source::embedded(name, text).map_err(Failure::from).and_then(|source| execute(source, &arguments)))
}

/// Runs the binary that takes any scene.
pub fn run_any() -> ExitCode {
    let AnyScene { scene, arguments } = AnyScene::parse();
    finish(match scene {
        Some(file) => Source::file(&file).map_err(Failure::from).and_then(|source| execute(source, &arguments)),
        None if arguments.print_schema => output::json(schema()),
        None => Err(Failure::Input("SCENE.toml is missing; examples are in problems/scenes".into())),
    })
}

fn finish(result: Result<String, Failure>) -> ExitCode {
    match result {
        Ok(text) => {
            // A reader that closes the pipe early has seen what it wanted.
            let _ = std::io::stdout().write_all(text.as_bytes());
            ExitCode::SUCCESS
        }
        Err(failure) => {
            eprintln!("error: {failure}");
            failure.exit_code()
        }
    }
}

/// Computes what the arguments ask for; the text belongs on stdout.
///
/// # Errors
/// [`Failure`] with its exit status.
pub fn execute(source: Source, arguments: &Arguments) -> Result<String, Failure> {
    if arguments.print_schema {
        return output::json(schema());
    }
    arguments.check()?;
    let source = source.map(|file| arguments.apply(file));
    let case = source.case()?;
    if arguments.print_scene {
        return Ok(source.scene.print()?);
    }
    if let Some(threads) = arguments.threads {
        // A second call in one process keeps the first pool; results do not depend on it.
        let _ = rayon::ThreadPoolBuilder::new().num_threads(threads).build_global();
    }
    let objective = objective(&case)?;
    match arguments.command {
        Command::Optimize => optimize::run(&objective, &case, arguments),
        Command::Evaluate => evaluate::run(&objective, &case, arguments),
        Command::Verify => verify::run(&objective, &case, arguments),
    }
}

/// Θ of a case.
///
/// # Errors
/// [`Failure::Input`] naming the field.
pub fn objective(case: &Case) -> Result<ContactObjective, Failure> {
    let shape = ContactShape::with_preconditioner(case.scene.clone(), case.solver, case.preconditioner)?;
    let cost = PressureCost::new(case.measure, &shape.problem().boundary)?;
    Ok(ReducedObjective::new(shape, cost))
}
