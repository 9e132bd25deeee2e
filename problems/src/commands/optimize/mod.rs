//! `optimize`: the shape of least contact pressure measure, on one mesh or on growing ones, kept on disk if asked for.

pub mod run;
pub mod stages;
pub mod summary;

use crate::commands::long_run::{RunFolder, STATUS, interrupted};
use crate::commands::optimize::run::{Begin, Optimization, Session, optimize};
use crate::commands::optimize::summary::{page, stages_page, summary};
use crate::commands::report::files;
use crate::commands::solved_shape::SolvedShape;
use crate::commands::{Failure, Source, json};
use scene_file::Case;

pub fn run(source: &Source, case: &Case, session: &Session<'_>) -> Result<String, Failure> {
    let begin = if session.arguments.resume.is_some() { Begin::Resumed } else { Begin::Anew };
    let optimization = optimize(source, case, begin, session)?;
    session.status.begin("reporting: ".into());
    let continued = optimization.folder.as_ref().map(|folder| format!("--resume {}", folder.folder().path().display()));
    let (printed, _shapes) = deliver(&optimization, source, case, session, continued.as_deref())?;
    match interruption(optimization.folder.as_ref()) {
        Some(reason) => Err(Failure::Incomplete { text: printed, reason, status: STATUS }),
        None => Ok(printed),
    }
}

/// The report for stdout and, if asked for, in files, with the shapes at both ends; `continued`: the options that continue the
/// run, to be named if it can be. What cannot be written does not take the report along.
pub fn deliver(
    optimization: &Optimization,
    source: &Source,
    case: &Case,
    session: &Session<'_>,
    continued: Option<&str>,
) -> Result<(String, [SolvedShape; 2]), Failure> {
    let finished = &optimization.finished;
    let (Some(first), Some(last)) = (finished.first(), finished.last()) else {
        return Err(Failure::Computation("no mesh was begun".into()));
    };
    let solved = |controls| {
        SolvedShape::at(&last.objective, controls).map_err(|failure| failure.after(&last.report.to_string()))
    };
    let shapes = [solved(&first.start)?, solved(&last.report.solution)?];
    let json = json(&summary(finished, &shapes))?;
    let mut text = page(last, &shapes);
    text += &stages_page(finished, optimization.asked);
    if let Some(options) = continued.filter(|_| optimization.can_continue()) {
        text += &format!("to continue: {options}\n");
    }
    let printed = if session.arguments.json { json.clone() } else { text.clone() };
    if let Some(folder) = &optimization.folder {
        let folder = folder.folder();
        let write = || -> Result<(), Failure> {
            folder.write("report.txt", &text)?;
            folder.replace("report.json", &json)?;
            files::write_optimization(folder, source, case, finished, &shapes)
        };
        if let Err(failure) = write() {
            let reason = format!("{failure}; the report above is complete");
            return Err(Failure::Incomplete { text: printed, reason, status: 1 });
        }
    }
    Ok((printed, shapes))
}

/// What is to be said of an interrupted run; none if it was not interrupted.
pub fn interruption(folder: Option<&RunFolder>) -> Option<String> {
    let hint = match folder {
        Some(folder) => format!("continue with --resume {}", folder.folder().path().display()),
        None => "nothing was kept; with --out DIR a run can be continued".to_owned(),
    };
    interrupted().then(|| format!("interrupted; {hint}"))
}
