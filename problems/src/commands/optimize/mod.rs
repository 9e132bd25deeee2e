//! `optimize`: the shape of least contact pressure measure, on one mesh or on growing ones, kept on disk if asked for.

pub mod mesh_run;
pub mod run;
pub mod stages;
pub mod summary;

use crate::commands::contact_objective::{SolvedShape, checks};
use crate::commands::failure::Failure;
use crate::commands::folder::{Folder, json};
use crate::commands::loaded_scene::{LoadedScene, Session};
use crate::commands::long_run::{RunFolder, STATUS, interrupted};
use crate::commands::optimize::run::{OptimizationRun, optimize};
use crate::commands::optimize::summary::{page, stages_page, summary};
use crate::commands::report::files;

/// The command.
pub fn run(loaded: &LoadedScene, session: &Session<'_>) -> Result<String, Failure> {
    let optimization = optimize(loaded, None, session)?;
    let folder = optimization.folder.as_ref();
    let continued = folder.map(|folder| format!("--resume {}", folder.folder().path().display()));
    let (printed, _shapes) = report(&optimization, loaded, session, continued.as_deref())?;
    match interruption(folder) {
        Some(reason) => Err(Failure::Incomplete { text: printed, reason, status: STATUS }),
        None => Ok(printed),
    }
}

/// The text for stdout, with the shapes at both ends of the optimization; the same as files if a folder is asked for.
/// `continued` holds the options that continue the run; the text names them if the run can be continued.
///
/// # Errors
/// [`Failure::Incomplete`] with the text if a file cannot be written; any [`Failure`] of the contact solver.
pub fn report(
    optimization: &OptimizationRun,
    loaded: &LoadedScene,
    session: &Session<'_>,
    continued: Option<&str>,
) -> Result<(String, [SolvedShape; 2]), Failure> {
    session.status.begin("reporting: ".into());
    let runs = &optimization.mesh_runs;
    let (Some(first), Some(last)) = (runs.first(), runs.last()) else {
        return Err(Failure::computation("no mesh was begun"));
    };
    let solved = |controls| {
        SolvedShape::at(&last.objective, controls).map_err(|failure| failure.after(&last.report.to_string()))
    };
    let shapes = [solved(&first.initial_controls)?, solved(&last.report.solution)?];
    let checks = checks(&last.objective, &shapes[1], session.arguments)?;
    let object = json(&summary(last, runs, &shapes, &checks, session.arguments))?;
    let mut text = page(last, &shapes, &checks, session.arguments) + &stages_page(runs, optimization.meshes);
    if let Some(options) = continued.filter(|_| optimization.can_continue()) {
        text += &format!("to continue: {options}\n");
    }
    let write = |folder: &Folder| {
        folder.write("report.txt", &text)?;
        folder.replace("report.json", &object)?;
        files::write_optimization(folder, loaded, runs, last, &shapes, &checks)
    };
    let written = optimization.folder.as_ref().map_or(Ok(()), |folder| write(folder.folder()));
    let printed = session.arguments.printed(text, object);
    Ok((Failure::printed_with_files(printed, written)?, shapes))
}

/// The sentence about an interruption; none if the run was not interrupted.
pub fn interruption(folder: Option<&RunFolder>) -> Option<String> {
    let hint = match folder {
        Some(folder) => format!("continue with --resume {}", folder.folder().path().display()),
        None => "nothing was kept; with --out DIR a run can be continued".to_owned(),
    };
    interrupted().then(|| format!("interrupted; {hint}"))
}
