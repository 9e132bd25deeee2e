//! `compare`: what friction is worth in the optimization (Example 5.3 of the paper). One optimization with friction and one
//! without start from the same controls; both shapes found are solved with friction and without it.

pub mod comparison;

use crate::commands::compare::comparison::Comparison;
use crate::commands::contact_objective::{SolvedShape, objective};
use crate::commands::failure::Failure;
use crate::commands::folder::{Folder, json};
use crate::commands::loaded_scene::{LoadedScene, Session};
use crate::commands::long_run::{COMPARED, RunFolder, STATUS};
use crate::commands::optimize::run::{OptimizationRun, check_limit, initial_controls, open_folder, optimize};
use crate::commands::optimize::stages::stages;
use crate::commands::optimize::{interruption, report};
use crate::commands::report::files;
use contact::error::SceneError;
use nonsmooth::Vector;
use std::path::Path;

/// The command.
pub fn run(loaded: &LoadedScene, session: &Session<'_>) -> Result<String, Failure> {
    let friction = loaded.case.scene.friction;
    if friction == 0.0 {
        let allowed = "a coefficient > 0 to compare with no friction at all";
        return Err(SceneError::out_of_range("friction", 0, allowed).into());
    }
    let (folder, initial_controls) = begin(loaded, session)?;
    let (folder, as_json) = (folder.as_ref(), session.arguments.json);
    let (mut printed, mut runs) = (String::new(), Vec::new());
    for (friction, name) in [friction, 0.0].into_iter().zip(COMPARED) {
        let part = loaded.changed(|scene| {
            scene.friction = friction;
            scene.output.folder = folder.map(|folder| folder.folder().path().join(name).display().to_string());
        })?;
        let run = optimize(&part, Some(&initial_controls), session).map_err(|failure| failure.after(&printed))?;
        let (text, shapes) = report(&run, &part, session, None)
            .map_err(|failure| if as_json { failure } else { failure.after(&printed) })?;
        // One JSON object at most stands on stdout.
        printed = if as_json { text } else { printed + &text };
        if run.was_cut_short() {
            return Err(cut_short(printed, folder, as_json));
        }
        runs.push((run, shapes));
    }
    let comparison = cross(&runs).map_err(|failure| failure.after(&printed))?;
    let mut text = comparison.to_string();
    if let Some(folder) = folder.filter(|_| runs.iter().any(|(run, _)| run.can_continue())) {
        text += &format!("to continue: compare --resume {}\n", folder.folder().path().display());
    }
    let object = json(&comparison.summary())?;
    let write = |folder: &Folder| {
        files::write_comparison(folder, loaded, &comparison)?;
        folder.write("report.txt", &text)?;
        folder.replace("report.json", &object)
    };
    let written = folder.map_or(Ok(()), |folder| write(folder.folder()));
    let printed = session.arguments.printed(format!("{printed}\n{text}"), object);
    let text = Failure::printed_with_files(printed, written)?;
    match interruption(folder) {
        Some(reason) => Err(Failure::Incomplete { text, reason, status: STATUS }),
        None => Ok(text),
    }
}

/// The folder of the comparison, if one is asked for, and the controls that both optimizations start from.
fn begin(loaded: &LoadedScene, session: &Session<'_>) -> Result<(Option<RunFolder>, Vector), Failure> {
    let folder = open_folder(loaded, 2, session)?;
    if let Some(folder) = folder.as_ref().filter(|folder| folder.is_resumed()) {
        let parts = COMPARED.map(|part| folder.folder().path().join(part).display().to_string());
        for part in parts.iter().filter(|part| RunFolder::is_one(Path::new(part))) {
            check_limit(&RunFolder::open(part, 1, true)?, &stages(&loaded.case))?;
        }
    }
    let controls = initial_controls(&objective(&loaded.case)?, loaded, None, folder.as_ref(), session)?;
    Ok((folder, controls))
}

/// The comparison of two runs: their shapes, each solved in the model of the other run as well.
fn cross(runs: &[(OptimizationRun, [SolvedShape; 2])]) -> Result<Comparison<'_>, Failure> {
    let missing = || Failure::computation("a run of the comparison is missing");
    let [(with, with_shapes), (without, without_shapes)] = runs else { return Err(missing()) };
    let (Some(with), Some(without)) = (with.mesh_runs.last(), without.mesh_runs.last()) else { return Err(missing()) };
    Ok(Comparison {
        runs: [with, without],
        own: [with_shapes, without_shapes],
        crossed: [
            SolvedShape::at(&with.objective, &without_shapes[1].controls)?,
            SolvedShape::at(&without.objective, &with_shapes[1].controls)?,
        ],
    })
}

/// The failure of a comparison of which one run was cut short, so that there is nothing to compare yet.
fn cut_short(mut text: String, folder: Option<&RunFolder>, as_json: bool) -> Failure {
    if !as_json {
        text += "the comparison is not complete\n";
    }
    let (reason, status) =
        if interruption(folder).is_some() { ("interrupted", STATUS) } else { ("time limit reached", 1) };
    let continued =
        folder.map(|folder| format!("; continue with compare --resume {}", folder.folder().path().display()));
    Failure::Incomplete { text, reason: reason.to_owned() + &continued.unwrap_or_default(), status }
}
