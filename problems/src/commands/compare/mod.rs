//! `compare`: what friction is worth in the optimization (Example 5.3 of the paper). One optimization with friction and
//! one without start from the same controls; both shapes found are solved with friction and without it.

pub mod comparison;

use crate::commands::compare::comparison::Comparison;
use crate::commands::facts::line;
use crate::commands::failure::Failure;
use crate::commands::folder::{COMPARED, Folder, REPORT, continuation, json, printed_with_files};
use crate::commands::interrupt::{STATUS, interrupted};
use crate::commands::loaded_scene::{LoadedScene, Session};
use crate::commands::long_run::RunFolder;
use crate::commands::optimize::run::{OptimizationRun, begin, optimize};
use crate::commands::optimize::{outcome, report};
use crate::commands::register::REGISTER;
use crate::commands::report::files;
use crate::commands::run_kind::RunKind;
use crate::commands::solved_shape::SolvedShape;
use contact::error::SceneError;
use std::path::Path;

pub fn run(loaded: &LoadedScene, session: &Session<'_>) -> Result<String, Failure> {
    let friction = loaded.case.scene.friction();
    if friction == 0.0 {
        let allowed = "a coefficient > 0 to compare with no friction at all";
        return Err(session.arguments.changes().blame(SceneError::out_of_range("friction", 0, allowed)).into());
    }
    let claimed = COMPARED.map(|part| format!("{part}/{REGISTER}"));
    let (folder, initial_controls) = begin(
        &loaded.case.prepared(loaded.case.wanted(), &session.processes)?,
        loaded,
        None,
        (RunKind::Comparison, &claimed),
        session,
    )?;
    let folder = folder.as_ref();
    let continued = folder.map(|folder| continuation(folder.folder.path(), session.arguments));
    let (as_json, parts) = (session.arguments.json, parts(loaded, folder)?);
    if let Some(folder) = folder.filter(|folder| folder.resumed) {
        check(&parts, session)?;
        folder.proceed(loaded)?;
    }
    let (mut printed, mut runs) = (String::new(), Vec::new());
    for part in parts {
        let run = optimize(&part, Some(&initial_controls), session).map_err(|failure| {
            if let (Some(folder), 2, true) = (folder, failure.status(), runs.is_empty()) {
                folder.abandon();
            }
            failure.after(&printed)
        })?;
        let (text, shapes) = report(&run, &part, session, None)
            .map_err(|failure| if as_json { failure } else { failure.after(&printed) })?;
        // One JSON object at most stands on stdout.
        printed = if as_json { text } else { printed + &text };
        if run.was_cut_short() {
            return Err(cut_short(printed, continued.as_deref(), as_json));
        }
        runs.push((run, shapes));
    }
    let comparison = cross(&runs).map_err(|failure| failure.after(&printed))?;
    let facts = comparison.facts(session.processes.usage(comparison.own[0][1].state().solver)?.as_ref())?;
    let can_continue = runs.iter().any(|(run, _)| run.runs.can_continue());
    let command = continued.as_ref().filter(|_| can_continue);
    let text = facts.text(true) + &command.map_or_else(String::new, |command| line("to continue", command));
    let object = json(&facts)?;
    let write = |folder: &Folder| {
        files::write_comparison(folder, loaded, &comparison, &facts)?;
        folder.write("report.txt", &text)?;
        folder.write(REPORT, &object)
    };
    let printed = session.arguments.printed(format!("{text}\n{printed}"), object.clone());
    let text = printed_with_files(printed, as_json, folder.map(|folder| &folder.folder), write)?;
    outcome(text, continued.as_deref(), runs.iter().find_map(|(run, _)| run.failure()))
}

/// The two scenes, with friction and without it, each with a folder of its own inside that of the comparison.
fn parts(loaded: &LoadedScene, folder: Option<&RunFolder>) -> Result<[LoadedScene; 2], SceneError> {
    let part = |name: &str, is_frictionless: bool| {
        loaded.changed(|scene| {
            if is_frictionless {
                scene.friction = 0.0;
                for contact in &mut scene.contact {
                    contact.friction = None;
                    contact.regions.clear();
                }
                scene.case.iter_mut().for_each(|case| case.friction = None);
            }
            scene.output.folder = folder.map(|folder| folder.folder.path().join(name).display().to_string());
        })
    };
    Ok([part(COMPARED[0], false)?, part(COMPARED[1], true)?])
}

/// Refuses runs that cannot be continued, before anything is changed.
fn check(parts: &[LoadedScene], session: &Session<'_>) -> Result<(), Failure> {
    for part in parts {
        let folder = part.case.output.folder.as_deref().map(Path::new);
        if let Some(folder) = folder.filter(|folder| RunFolder::is_one(folder)) {
            RunFolder::reopen(Folder::reopen(folder, 1)?, part, session.arguments.course.new_version)?;
        }
    }
    Ok(())
}

/// The comparison of two runs: their shapes, each solved in the model of the other run as well.
fn cross(runs: &[(OptimizationRun, [SolvedShape; 2])]) -> Result<Comparison<'_>, Failure> {
    let missing = || Failure::computation("a run of the comparison is missing");
    let [(with, with_shapes), (without, without_shapes)] = runs else { return Err(missing()) };
    let (Some(with), Some(without)) = (with.runs.chosen(), without.runs.chosen()) else { return Err(missing()) };
    Ok(Comparison {
        runs: [with, without],
        own: [with_shapes, without_shapes],
        crossed: [
            SolvedShape::at(&with.stage.objective, &without_shapes[1].controls)?,
            SolvedShape::at(&without.stage.objective, &with_shapes[1].controls)?,
        ],
    })
}

/// The failure of a comparison of which one run was cut short, so that there is nothing to compare yet.
fn cut_short(mut text: String, continued: Option<&str>, as_json: bool) -> Failure {
    if !as_json {
        text += "the comparison is not complete\n";
    }
    let (reason, status) = if interrupted() { ("interrupted", STATUS) } else { ("time limit reached", 1) };
    let continued = continued.map_or_else(String::new, |command| format!("; continue with `{command}`"));
    Failure::Incomplete { text, reason: reason.to_owned() + &continued, status }
}
