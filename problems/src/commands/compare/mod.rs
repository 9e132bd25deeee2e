//! `compare`: what friction is worth in the optimization (Example 5.3 of the paper). Two optimizations, with and without
//! friction, and both shapes seen with and without friction.

pub mod comparison;

use crate::commands::compare::comparison::Comparison;
use crate::commands::long_run::{COMPARED, RunFolder, STATUS};
use crate::commands::optimize::run::{Begin, Optimization, Session, check_limit, optimize, room};
use crate::commands::optimize::stages::stages;
use crate::commands::optimize::{deliver, interruption};
use crate::commands::report::files;
use crate::commands::solved_shape::SolvedShape;
use crate::commands::{Failure, Source, controls, json, objective};
use contact::error::SceneError;
use nonsmooth::Vector;
use scene_file::Case;
use std::path::Path;

pub fn run(source: &Source, case: &Case, session: &Session<'_>) -> Result<String, Failure> {
    if case.scene.friction == 0.0 {
        let allowed = "a coefficient > 0 to compare with no friction at all";
        return Err(SceneError::out_of_range("friction", 0, allowed).into());
    }
    let resumed = session.arguments.resume.is_some();
    let folder = case.output.folder.as_deref();
    let folder = folder.map(|path| RunFolder::open(path, 2 * room(&stages(case)), resumed)).transpose()?;
    for part in
        folder.iter().filter(|_| resumed).flat_map(|folder| COMPARED.map(|part| folder.folder().path().join(part)))
    {
        if RunFolder::is_one(&part) {
            check_limit(&RunFolder::open(&part.display().to_string(), 1, true)?, &stages(case))?;
        }
    }
    let start = start(source, case, folder.as_ref(), session)?;
    let frictions = [case.scene.friction, 0.0];
    let (mut printed, mut runs) = (String::new(), Vec::new());
    for (friction, name) in frictions.into_iter().zip(COMPARED) {
        let (source, case) = part(source, folder.as_ref(), friction, name)?;
        let begun = case.output.folder.as_deref().is_some_and(|path| RunFolder::is_one(Path::new(path)));
        let begin = if resumed && begun { Begin::Resumed } else { Begin::At(&start) };
        let optimization = optimize(&source, &case, begin, session).map_err(|failure| failure.after(&printed))?;
        session.status.begin("reporting: ".into());
        let (text, shapes) = deliver(&optimization, &source, &case, session, None)
            .map_err(|failure| if session.arguments.json { failure } else { failure.after(&printed) })?;
        // One JSON object at most stands on stdout.
        printed = if session.arguments.json { text } else { printed + &text };
        if optimization.was_cut_short() {
            return cut_short(printed, folder.as_ref(), session.arguments.json);
        }
        runs.push((optimization, shapes));
    }
    let compared = cross(&runs).map_err(|failure| failure.after(&printed))?;
    let mut text = compared.to_string();
    if let Some(folder) = folder.as_ref().filter(|_| runs.iter().any(|(run, _)| run.can_continue())) {
        text += &format!("to continue: compare --resume {}\n", folder.folder().path().display());
    }
    let json = json(&compared.summary())?;
    let printed = if session.arguments.json { json.clone() } else { format!("{printed}\n{text}") };
    if let Some(folder) = &folder {
        let folder = folder.folder();
        let write = || -> Result<(), Failure> {
            files::write_comparison(folder, source, case, &compared)?;
            folder.write("report.txt", &text)?;
            folder.replace("report.json", &json)
        };
        if let Err(failure) = write() {
            let reason = format!("{failure}; the report above is complete");
            return Err(Failure::Incomplete { text: printed, reason, status: 1 });
        }
    }
    match interruption(folder.as_ref()) {
        Some(reason) => Err(Failure::Incomplete { text: printed, reason, status: STATUS }),
        None => Ok(printed),
    }
}

/// The controls that both runs start from, kept in the folder.
fn start(source: &Source, case: &Case, folder: Option<&RunFolder>, session: &Session<'_>) -> Result<Vector, Failure> {
    let objective = objective(case)?;
    let shape = objective.solver();
    let mut start = match session.arguments.resume {
        Some(_) => shape.start(),
        None => controls::load(shape, case, session.arguments.start_controls.as_deref())?,
    };
    if let Some(folder) = folder {
        start = Vector::from_vec(folder.begin(source, start.as_slice())?);
        shape.problem().admissible.check(&start)?;
    }
    Ok(start)
}

/// The same scene with another friction coefficient, kept in a folder of its own.
fn part(source: &Source, folder: Option<&RunFolder>, friction: f64, name: &str) -> Result<(Source, Case), Failure> {
    let part = source.clone().map(|mut scene| {
        scene.friction = friction;
        scene.output.folder = folder.map(|folder| folder.folder().path().join(name).display().to_string());
        scene
    });
    let case = part.case()?;
    Ok((part, case))
}

/// Both optimal shapes, and the start, seen with and without friction.
fn cross(runs: &[(Optimization, [SolvedShape; 2])]) -> Result<Comparison<'_>, Failure> {
    let missing = || Failure::Computation("a run of the comparison is missing".into());
    let [(with, with_shapes), (without, without_shapes)] = runs else { return Err(missing()) };
    let (Some(with), Some(without)) = (with.finished.last(), without.finished.last()) else { return Err(missing()) };
    Ok(Comparison {
        runs: [with, without],
        own: [with_shapes, without_shapes],
        crossed: [
            SolvedShape::at(&with.objective, &without_shapes[1].controls)?,
            SolvedShape::at(&without.objective, &with_shapes[1].controls)?,
        ],
    })
}

/// What is said when a run ended before its time: nothing can be compared yet.
fn cut_short(mut text: String, folder: Option<&RunFolder>, json: bool) -> Result<String, Failure> {
    let continued =
        folder.map(|folder| format!("; continue with compare --resume {}", folder.folder().path().display()));
    let continued = continued.unwrap_or_default();
    if !json {
        text += "the comparison is not complete\n";
    }
    match interruption(folder) {
        Some(_) => {
            let reason = format!("interrupted{continued}");
            Err(Failure::Incomplete { text, reason, status: STATUS })
        }
        None => Err(Failure::Incomplete { text, reason: format!("time limit reached{continued}"), status: 1 }),
    }
}
