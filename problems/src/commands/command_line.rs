//! The command line of the contact binaries: parse, compute, print.

use crate::commands::arguments::{Arguments, Command, SCENE};
use crate::commands::failure::Failure;
use crate::commands::file_limit::let_large_writes_fail;
use crate::commands::folder::json;
use crate::commands::loaded_scene::{LoadedScene, Session};
use crate::commands::long_run::{RunFolder, StageLayer, StatusLine};
use crate::commands::output::{finish, left, notice};
use crate::commands::scene_options::help_with_defaults;
use crate::commands::{
    compare, evaluate, export, field_list, look, new_scene, optimize, recheck, study, tolerance, verify,
};
use clap::{Arg, value_parser};
use contact::equilibrium::STAGE_TARGET;
use contact::memory;
use contact::solvers::{Processes, Wanted};
use scene_file::{SceneFile, schema};
use std::path::PathBuf;
use std::process::ExitCode;
use std::time::Instant;
use tracing_subscriber::filter::{LevelFilter, Targets};
use tracing_subscriber::fmt::layer as log;
use tracing_subscriber::layer::{Layer, SubscriberExt};
use tracing_subscriber::util::SubscriberInitExt;

/// Runs the binary of this name on its own scene, the text of a scene file.
pub fn run(binary: &'static str, scene: &str) -> ExitCode {
    // The scenes of the paper are optimized as there.
    let single = |mut scene: SceneFile| {
        scene.optimizer.single = true;
        scene
    };
    let scene = SceneFile::parse(scene, binary).map(single);
    let parser = help_with_defaults(Arguments::parser(), scene.as_ref().ok())
        .override_usage(format!("{binary} [COMMAND] [OPTIONS]"))
        .after_help(examples(binary, ""));
    run_parsed(binary, parser, |_| Ok((scene?, None)), &Processes::alone())
}

/// Runs a binary of this name that takes any scene, in the first of its processes.
pub fn run_any_among(binary: &'static str, processes: &Processes) -> ExitCode {
    let scene = Arg::new(SCENE).value_name("SCENE.toml").value_parser(value_parser!(PathBuf));
    let parser = help_with_defaults(Arguments::parser(), None)
        .arg(scene.help("Scene file (docs/scenes.md; examples in problems/scenes)"))
        .override_usage(format!(
            "{binary} SCENE.toml [COMMAND] [OPTIONS]\n       {binary} new MESH.msh\n       {binary} fields [TYPE]"
        ))
        .after_help(examples(binary, "SCENE.toml "));
    let missing = || {
        Failure::Input(
            "SCENE.toml is missing; `new MESH.msh` writes one for a mesh, examples are in problems/scenes".into(),
        )
    };
    let open = |scene: Option<PathBuf>| {
        let scene = scene.ok_or_else(missing)?;
        Ok((SceneFile::read(&scene)?, Some(scene)))
    };
    match new_scene::asked(binary, &words()).or_else(|| field_list::asked(binary, &words())) {
        Some(result) => finish(result, None),
        None => run_parsed(binary, parser, open, processes),
    }
}

/// Examples at the end of the help. `scene`: what names the scene, with a blank, for a binary that takes any.
fn examples(binary: &str, scene: &str) -> String {
    let new = match scene {
        "" => String::new(),
        _ => format!("{binary} new part.msh\n      a first scene for a mesh, part.toml\n  "),
    };
    format!(
        "Examples:\n  {new}\
         {binary} {scene}--out results/run\n      \
         optimize; report, pictures and data go to results/run\n  \
         {binary} --resume results/run --max-evaluations 300\n      \
         go on where that run stopped\n  \
         {binary} {scene}evaluate --mesh 24 --controls results/run/controls.json\n      \
         the shape found, on a finer mesh\n  \
         {binary} {scene}--friction 0 --objective peak-pressure\n      \
         another problem"
    )
}

/// The words of the command line that are Unicode.
fn words() -> Vec<String> {
    std::env::args_os().skip(1).filter_map(|word| word.into_string().ok()).collect()
}

/// Runs what the words of the command line ask for; `open` reads the scene that they name.
fn run_parsed(
    binary: &'static str,
    parser: clap::Command,
    open: impl FnOnce(Option<PathBuf>) -> Result<(SceneFile, Option<PathBuf>), Failure>,
    processes: &Processes,
) -> ExitCode {
    let_large_writes_fail();
    let parser = parser.name(binary);
    let (arguments, scene) = match Arguments::parse_by(parser, std::env::args_os()) {
        Ok(parsed) => parsed,
        Err(error) => return left(&error),
    };
    if scene.is_some() && arguments.course.resume.is_some() {
        let words = "SCENE.toml and --resume together: a resumed run has its scene in its folder";
        return finish(Err(Failure::Input(words.into())), None);
    }
    finish(execute_among(|| open(scene), &arguments, processes), arguments.kept())
}

/// Computes what the arguments ask for, on the scene that `open` reads unless a run is resumed. The text belongs on
/// stdout.
pub fn execute(
    open: impl FnOnce() -> Result<(SceneFile, Option<PathBuf>), Failure>,
    arguments: &Arguments,
) -> Result<String, Failure> {
    execute_among(open, arguments, &Processes::alone())
}

/// As [`execute`], in the first of several processes.
pub fn execute_among(
    open: impl FnOnce() -> Result<(SceneFile, Option<PathBuf>), Failure>,
    arguments: &Arguments,
    processes: &Processes,
) -> Result<String, Failure> {
    if arguments.common.print_schema {
        return json(schema());
    }
    arguments.check()?;
    let status = listen()?;
    let (file, path) = match &arguments.course.resume {
        Some(folder) => RunFolder::scene(folder, arguments.command.kind())?,
        None => open()?,
    };
    let loaded = LoadedScene::new(arguments.apply(file)?, path).map_err(|error| arguments.changes().blame(error))?;
    if arguments.common.print_scene {
        return Ok(loaded.file.print()?);
    }
    let limit = loaded.file.optimizer.time_limit.filter(|_| !arguments.changes().has("time-limit"));
    if let (Some(folder), Some(limit)) = (&arguments.course.resume, limit) {
        let words = "the time limit that the run was begun with; --time-limit SECONDS sets another one";
        notice(&format!("{}: {limit} s, {words}", folder.display()));
    }
    if let Some(threads) = arguments.common.threads {
        processes.use_threads(threads.into())?;
    }
    if arguments.series.vtk_history && loaded.case.output.folder.is_none() {
        return Err(Failure::Input("--vtk-history is allowed with --out or --resume only: it writes files".into()));
    }
    tell_of_files(&loaded);
    let session = Session { arguments, clock: Instant::now(), status, processes: processes.clone() };
    let result = match arguments.command {
        Command::Optimize => optimize::run(&loaded, &session),
        Command::Compare => compare::run(&loaded, &session),
        Command::Study => study::run(&loaded, &session),
        Command::Look => look::run(&loaded, &session),
        Command::Evaluate => evaluate::run(&loaded, &session),
        Command::Verify => verify::run(&loaded.case, &session),
        Command::Tolerance => tolerance::run(&loaded, &session),
        Command::Recheck => recheck::run(&loaded, arguments),
        Command::Export => export::run(&loaded, &session),
    };
    session.status.clear();
    result
}

/// Says on stderr what was found in the files of a scene, and what memory it takes, before any work.
fn tell_of_files(loaded: &LoadedScene) {
    loaded.open.iter().for_each(|open| notice(open));
    let notes = &loaded.case.notes;
    notes.iter().for_each(|note| notice(note));
    if !notes.is_empty() {
        let needed = loaded.case.plans(Wanted::States).map(|plan| memory::needed(&plan)).fold(0.0, f64::max);
        notice(&format!("an evaluation takes about {:.0} MB of memory", needed / 1e6));
    }
}

/// Listens to the events of the solvers: for a log on stderr if the environment variable RUST_LOG asks for it, else for
/// a status line if stderr is a terminal.
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
