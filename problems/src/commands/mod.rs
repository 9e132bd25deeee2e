//! The command line shared by the contact binaries: parse, compute, print.
//!
//! Contract (kept stable): `NAME [optimize|evaluate|verify] [options]`, for `contact3d` with a scene file before it; exit
//! status 0 success, 1 the computation failed (or its files could not be written), 2 bad input, 130 interrupted, with a report;
//! `--json` prints one JSON object on stdout and nothing else there.

mod arguments;
mod compare;
mod controls;
mod evaluate;
mod failure;
mod folder;
mod loaded_scene;
pub mod long_run;
mod optimize;
mod report;
mod solved_shape;
mod verify;

pub use arguments::{Arguments, Command};
pub use controls::parse as parse_controls;
pub use failure::Failure;
pub use folder::{Folder, json};
pub use loaded_scene::Source;
pub use optimize::run::{first_step, mean_height_coordinates};
pub use verify::smooth_step;

use crate::commands::long_run::{StageLayer, StatusLine};
use crate::commands::optimize::run::Session;
use clap::{Parser, ValueEnum};
use contact::contact_shape::ContactShape;
use contact::cost::PressureCost;
use contact::equilibrium::STAGE_TARGET;
use nonsmooth::ReducedObjective;
use scene_file::{Case, schema};
use std::io::Write;
use std::path::PathBuf;
use std::process::ExitCode;
use std::time::Instant;
use tracing_subscriber::EnvFilter;
use tracing_subscriber::filter::{LevelFilter, Targets};
use tracing_subscriber::layer::{Layer, SubscriberExt};
use tracing_subscriber::util::SubscriberInitExt;

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
    finish(execute(|| Ok(Source::embedded(name, text)?), &arguments))
}

/// Runs the binary that takes any scene.
pub fn run_any() -> ExitCode {
    let AnyScene { scene, arguments } = AnyScene::parse();
    let missing = || Failure::Input("SCENE.toml is missing; examples are in problems/scenes".into());
    if arguments.resume.is_some() && scene.is_some() {
        let failure =
            Failure::Input("SCENE.toml and --resume together: a resumed run has its scene in its folder".into());
        return finish(Err(failure));
    }
    let open = || {
        let scene = scene.as_ref().ok_or_else(missing)?;
        // A command in the place of the scene: the scene was forgotten.
        let command = scene.to_str().is_some_and(|word| Command::from_str(word, true).is_ok());
        if command && !scene.exists() { Err(missing()) } else { Ok(Source::file(scene)?) }
    };
    finish(execute(open, &arguments))
}

fn finish(result: Result<String, Failure>) -> ExitCode {
    // A reader that closes the pipe early has seen what it wanted.
    let print = |text: &str| drop(std::io::stdout().write_all(text.as_bytes()));
    match result {
        Ok(text) => {
            print(&text);
            ExitCode::SUCCESS
        }
        Err(failure) => {
            if let Failure::Incomplete { text, .. } = &failure {
                print(text);
            }
            eprintln!("error: {failure}");
            failure.exit_code()
        }
    }
}

/// Computes what the arguments ask for, on the scene that `open` finds unless they name another; the text belongs on stdout.
///
/// # Errors
/// [`Failure`] with its exit status.
pub fn execute(open: impl FnOnce() -> Result<Source, Failure>, arguments: &Arguments) -> Result<String, Failure> {
    if arguments.print_schema {
        return folder::json(schema());
    }
    arguments.check()?;
    let status = listen()?;
    let source = match &arguments.resume {
        Some(folder) => long_run::RunFolder::scene(folder, arguments.command == Command::Compare)?,
        None => open()?,
    };
    let source = source.map(|file| arguments.apply(file));
    let case = source.case()?;
    if arguments.print_scene {
        return Ok(source.scene.print()?);
    }
    if let Some(threads) = arguments.threads {
        // A second call in one process keeps the first pool; results do not depend on it.
        let _ = rayon::ThreadPoolBuilder::new().num_threads(threads).build_global();
    }
    let session = Session { arguments, clock: Instant::now(), status };
    let result = match arguments.command {
        Command::Optimize => optimize::run(&source, &case, &session),
        Command::Compare => compare::run(&source, &case, &session),
        Command::Evaluate => evaluate::run(&objective(&case)?, &source, &case, arguments),
        Command::Verify => verify::run(&objective(&case)?, &case, arguments),
    };
    session.status.clear();
    result
}

/// Listens to the events of the solvers: for a log on stderr if the environment variable RUST_LOG asks for it, else for a status
/// line if stderr is a terminal.
fn listen() -> Result<StatusLine, Failure> {
    // A program that has its own subscriber keeps it.
    let Ok(filter) = std::env::var(EnvFilter::DEFAULT_ENV) else {
        let status = StatusLine::of_stderr();
        if status.is_visible() {
            let line = status.clone();
            let layer = StageLayer(move |stage| line.stage(stage));
            let stages = Targets::new().with_target(STAGE_TARGET, LevelFilter::TRACE);
            let _ = tracing_subscriber::registry().with(layer.with_filter(stages)).try_init();
        }
        return Ok(status);
    };
    let filter =
        EnvFilter::try_new(&filter).map_err(|error| Failure::Input(format!("RUST_LOG = {filter}: {error}")))?;
    let _ = tracing_subscriber::fmt().with_env_filter(filter).with_writer(std::io::stderr).try_init();
    Ok(StatusLine::hidden())
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
