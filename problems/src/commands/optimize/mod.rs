//! `optimize`: the shape of least contact pressure measure, on one mesh or on growing ones, kept on disk if asked for.

pub mod run;
pub mod summary;
mod vtk_history;

use crate::commands::facts::line;
use crate::commands::failure::Failure;
use crate::commands::folder::{Folder, REPORT, continuation, json, printed_with_files};
use crate::commands::interrupt::{STATUS, interrupted};
use crate::commands::loaded_scene::{LoadedScene, Session};
use crate::commands::optimize::run::{OptimizationRun, optimize};
use crate::commands::optimize::summary::Ended;
use crate::commands::report::{export_command, files};
use crate::commands::solved_shape::{SolvedShape, checks};

pub fn run(loaded: &LoadedScene, session: &Session<'_>) -> Result<String, Failure> {
    let optimization = optimize(loaded, None, session)?;
    let folder = optimization.folder.as_ref();
    let continued = folder.map(|folder| continuation(folder.folder.path(), session.arguments));
    let (text, _shapes) = report(&optimization, loaded, session, continued.as_deref())?;
    outcome(text, continued.as_deref(), optimization.failure())
}

/// The text for stdout, with what is to be said about an interruption or a failure of the run behind it.
pub fn outcome(text: String, continued: Option<&str>, failure: Option<String>) -> Result<String, Failure> {
    if interrupted() {
        let kept = continued.map(|command| format!("interrupted; continue with `{command}`"));
        let lost = || "interrupted; nothing was kept; with --out DIR a run can be continued".to_owned();
        return Err(Failure::Incomplete { text, reason: kept.unwrap_or_else(lost), status: STATUS });
    }
    match failure {
        Some(reason) => Err(Failure::Incomplete { text, reason, status: 1 }),
        None => Ok(text),
    }
}

/// The text for stdout, with the shapes at both ends of the optimization; the same as files if a folder is asked for.
/// `continued` is the command that continues the run; the text names it if the run can be continued.
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
    let runs = &optimization.runs;
    let leading = runs.leading();
    let (Some(first), Some(last)) = (leading.first(), runs.chosen()) else {
        return Err(Failure::computation("no mesh was begun"));
    };
    let solved = |controls| {
        SolvedShape::at(&last.stage.objective, controls).map_err(|failure| failure.after(&last.report.to_string()))
    };
    let shapes = [solved(&first.stage.start)?, solved(&last.report.solution)?];
    let mut checks = checks(&last.stage.objective, &shapes[1], session.arguments)?;
    checks.extend(runs.standstill((&shapes[1].controls, &shapes[1].states))?);
    let ended = Ended {
        last,
        runs,
        shapes: &shapes,
        cases: &loaded.case.cases,
        checks: &checks,
        left_out: session.arguments.left_out(last.stage.objective.solver()),
        processes: session.processes.usage(shapes[1].state().solver)?,
    };
    let facts = ended.facts()?;
    let object = json(&facts)?;
    let continued = continued.filter(|_| runs.can_continue());
    let kept = optimization.folder.as_ref().map(|folder| export_command(folder.folder.path()));
    let more = [("to continue", continued), ("to export", kept.as_deref())];
    let more: String = more.iter().filter_map(|(name, command)| Some(line(name, (*command)?))).collect();
    let write = |folder: &Folder| {
        files::write_optimization(folder, loaded, &ended, &facts)?;
        if session.arguments.series.vtk_history {
            vtk_history::write(folder, &leading)?;
        }
        folder.write("report.txt", facts.text(true) + &more)?;
        if let Some(run) = runs.ended.iter().find(|run| !run.is_kept) {
            let evaluations = run.report.counts.evaluations;
            let words = format!("the journal does not hold all {evaluations} evaluations, see the warnings");
            return Err(Failure::Computation(format!("{}: {words}", folder.path().display())));
        }
        // From here on the run has ended.
        folder.write(REPORT, &object)
    };
    let folder = optimization.folder.as_ref().map(|folder| &folder.folder);
    let json = session.arguments.json;
    let printed = session.arguments.printed(facts.text(session.arguments.verbose) + &more, object.clone());
    Ok((printed_with_files(printed, json, folder, write)?, shapes))
}
