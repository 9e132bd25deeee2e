//! The command line of the contact binaries: parse, compute, print.

use crate::commands::arguments::{Arguments, Command};
use crate::commands::failure::Failure;
use crate::commands::file_limit::let_large_writes_fail;
use crate::commands::folder::json;
use crate::commands::loaded_scene::{LoadedScene, Session};
use crate::commands::long_run::{RunFolder, StageLayer, StatusLine};
use crate::commands::output::{finish, leave, left, notice};
use crate::commands::shell_files::{asked, examples};
use crate::commands::{compare, evaluate, export, optimize, recheck, study, verify};
use clap::{CommandFactory, FromArgMatches, Parser, ValueEnum};
use contact::equilibrium::STAGE_TARGET;
use contact::solvers::Processes;
use scene_file::{SceneFile, schema};
use std::path::PathBuf;
use std::process::ExitCode;
use std::time::Instant;
use tracing_subscriber::filter::{LevelFilter, Targets};
use tracing_subscriber::fmt::layer as log;
use tracing_subscriber::layer::{Layer, SubscriberExt};
use tracing_subscriber::util::SubscriberInitExt;

/// What the binary does.
const ABOUT: &str = "3D contact shape optimization with Coulomb friction (units: N, mm, MPa)";

/// Arguments of the binary that takes any scene.
#[derive(Debug, Parser)]
#[command(name = "contact3d", version, about = ABOUT, allow_negative_numbers = true)]
struct AnyScene {
    /// Scene file (docs/scenes.md; examples in problems/scenes).
    #[arg(value_name = "SCENE.toml")]
    scene: Option<PathBuf>,
    #[command(flatten)]
    arguments: Arguments,
}

/// Runs the binary of this name on its own scene, the text of a scene file.
pub fn run(binary: &'static str, scene: &str) -> ExitCode {
    let_large_writes_fail();
    let scene = SceneFile::parse(scene, binary);
    let command = Arguments::command().name(binary).after_help(examples(binary, ""));
    let command = Arguments::help_with_defaults(command, scene.as_ref().ok());
    if let Some(file) = asked(&command, &words()) {
        return finish(file, None);
    }
    let arguments = command.try_get_matches().and_then(|found| Arguments::from_arg_matches(&found));
    let arguments = arguments.unwrap_or_else(|error| leave(&error));
    finish(execute(|| Ok((scene?, None)), &arguments), arguments.kept())
}

/// Runs a binary of this name that takes any scene, in the first of its processes.
pub fn run_any_among(binary: &'static str, processes: &Processes) -> ExitCode {
    let_large_writes_fail();
    let command = AnyScene::command().name(binary).after_help(examples(binary, "SCENE.toml "));
    let command = Arguments::help_with_defaults(command, None);
    if let Some(file) = asked(&command, &words()) {
        return finish(file, None);
    }
    let parsed = command.try_get_matches().and_then(|found| AnyScene::from_arg_matches(&found));
    let AnyScene { mut scene, mut arguments } = match parsed {
        Ok(parsed) => parsed,
        Err(error) => return left(&error),
    };
    let missing = || Failure::Input("SCENE.toml is missing; examples are in problems/scenes".into());
    // A command in the place of the scene.
    let is_file = scene.as_ref().is_some_and(|scene| scene.is_file());
    let word = scene.as_ref().filter(|_| !is_file || arguments.resume.is_some()).and_then(|scene| scene.to_str());
    let first = word.and_then(|word| Command::from_str(word, true).ok());
    if arguments.resume.is_some() {
        if let Some(command) = first.filter(|_| arguments.command == Command::default()) {
            (scene, arguments.command) = (None, command);
        }
        if scene.is_some() {
            let words = "SCENE.toml and --resume together: a resumed run has its scene in its folder";
            return finish(Err(Failure::Input(words.into())), None);
        }
    }
    let open = || {
        let scene = scene.filter(|_| first.is_none()).ok_or_else(missing)?;
        Ok((SceneFile::read(&scene)?, Some(scene)))
    };
    finish(execute_among(open, &arguments, processes), arguments.kept())
}

/// The arguments of the program that are Unicode.
fn words() -> Vec<String> {
    std::env::args_os().skip(1).filter_map(|word| word.into_string().ok()).collect()
}

/// Computes what the arguments ask for, on the scene that `open` reads unless a run is resumed. The text belongs on stdout.
///
/// # Errors
/// [`Failure`] with its exit status.
pub fn execute(
    open: impl FnOnce() -> Result<(SceneFile, Option<PathBuf>), Failure>,
    arguments: &Arguments,
) -> Result<String, Failure> {
    execute_among(open, arguments, &Processes::alone())
}

/// As [`execute`], in the first of several processes.
///
/// # Errors
/// [`Failure`] with its exit status.
pub fn execute_among(
    open: impl FnOnce() -> Result<(SceneFile, Option<PathBuf>), Failure>,
    arguments: &Arguments,
    processes: &Processes,
) -> Result<String, Failure> {
    if arguments.print_schema {
        return json(schema());
    }
    arguments.check()?;
    let status = listen()?;
    let (file, path) = match &arguments.resume {
        Some(folder) => RunFolder::scene(folder, arguments.command.kind())?,
        None => open()?,
    };
    let loaded = LoadedScene::new(arguments.apply(file)?, path).map_err(|error| arguments.blame(error))?;
    if arguments.print_scene {
        return Ok(loaded.file.print()?);
    }
    if let (Some(folder), None, Some(limit)) =
        (&arguments.resume, arguments.time_limit, loaded.file.optimizer.time_limit)
    {
        let words = "the time limit that the run was begun with; --time-limit SECONDS sets another one";
        notice(&format!("{}: {limit} s, {words}", folder.display()));
    }
    if let Some(threads) = arguments.threads {
        processes.use_threads(threads.into())?;
    }
    if arguments.vtk_history && loaded.case.output.folder.is_none() {
        return Err(Failure::Input("--vtk-history is allowed with --out or --resume only: it writes files".into()));
    }
    let session = Session { arguments, clock: Instant::now(), status, processes: processes.clone() };
    let result = match arguments.command {
        Command::Optimize => optimize::run(&loaded, &session),
        Command::Compare => compare::run(&loaded, &session),
        Command::Study => study::run(&loaded, &session),
        Command::Evaluate => evaluate::run(&loaded, &session),
        Command::Verify => verify::run(&loaded.case, &session),
        Command::Recheck => recheck::run(&loaded, arguments),
        Command::Export => export::run(&loaded, &session),
    };
    session.status.clear();
    result
}

/// Listens to the events of the solvers: for a log on stderr if the environment variable RUST_LOG asks for it, else for a status
/// line if stderr is a terminal.
fn listen() -> Result<StatusLine, Failure> {
    // A program that has its own subscriber keeps it.
    let Ok(filter) = std::env::var("RUST_LOG") else {
        let status = StatusLine::of_stderr();
        if status.is_visible() {
            let line = status.clone();
            let layer = StageLayer(move |stage| line.stage(stage));
            let stages = Targets::new().with_target(STAGE_TARGET, LevelFilter::TRACE);
            let _ = tracing_subscriber::registry().with(layer.with_filter(stages)).try_init();
        }
        return Ok(status);
    };
    let allowed = "allowed are error, warn, info, debug, trace, off, each alone or for a part as in contact=debug, joined by commas";
    let targets: Targets =
        filter.parse().map_err(|error| Failure::Input(format!("RUST_LOG = {filter}: {error}; {allowed}")))?;
    let _ = tracing_subscriber::registry().with(log().with_writer(std::io::stderr).with_filter(targets)).try_init();
    Ok(StatusLine::hidden())
}
