//! `study`: a table over values of parameters. A row is the scene with some options, evaluated or optimized.
//!
//! ```text
//! DIR/scene.toml, start.json, study.json   the study as stated
//! DIR/rows.json                            the rows so far; a study that is continued computes the others
//! DIR/row_001, row_002, …                  with --optimize: the optimization of each row
//! ```

mod plan;
pub mod row;
pub mod table;
pub mod varied;

use crate::commands::controls;
use crate::commands::failure::Failure;
use crate::commands::folder::{Folder, REPORT, STUDY, continuation, file_error, json, printed_with_files};
use crate::commands::interrupt::{STATUS, interrupted, watch_interrupts};
use crate::commands::loaded_scene::{LoadedScene, Session};
use crate::commands::long_run::RunFolder;
use crate::commands::optimize::run::begin;
use crate::commands::output::notice;
use crate::commands::register::REGISTER;
use crate::commands::report::study::write_study;
use crate::commands::run_kind::RunKind;
use crate::commands::solved_shape;
use contact::error::SceneError;
use nonsmooth::Vector;
use plan::Plan;
use row::Row;
use scene_file::read_text;
use serde::Deserialize;
use std::path::Path;
use table::{StudyJson, row_folder};

/// The rows of a study.
const ROWS: &str = "rows.json";
/// Largest file of rows, bytes.
const LARGEST_FILE: u64 = 1 << 30;

pub fn run(loaded: &LoadedScene, session: &Session<'_>) -> Result<String, Failure> {
    let path = loaded.case.output.folder.as_deref().map(Path::new);
    let plan = match path.filter(|_| session.arguments.course.resume.is_some()) {
        Some(folder) => read::<Plan>(&folder.join(STUDY))?.checked()?,
        None => Plan::stated(session.arguments)?,
    };
    let combinations = varied::combinations(&plan.vary);
    let (folder, controls) = started(loaded, session, &plan, combinations.len())?;
    let folder = folder.as_ref();
    watch_interrupts(session.processes.is_alone());
    let mut rows: Vec<Row> = kept(folder, &combinations)?;
    for (index, options) in combinations.iter().enumerate().skip(rows.len()) {
        // What is known now is said now, not after hours of other rows.
        let failure = row::refusal(loaded, (options, &plan.fixed), (plan.optimize, plan.same_start), session);
        failure.iter().for_each(|failure| notice(&format!("row {} will fail: {failure}", index + 1)));
    }
    let new_limit = session.arguments.changes().has("max-evaluations");
    let mut cut = None;
    for (index, options) in combinations.iter().enumerate() {
        if rows.get(index).is_some_and(|row| !row.is_to_be_continued(new_limit)) {
            continue;
        }
        session.status.begin(format!("row {} of {}: ", index + 1, combinations.len()));
        let out = folder.filter(|_| plan.optimize).map(|folder| folder.folder.path().join(row_folder(index + 1)));
        let start = plan.same_start.then_some(&controls);
        let row = match cut_short(session, loaded) {
            None => row::computed(loaded, (options, &plan.fixed), (plan.optimize, start, out.as_deref()), session)?,
            Some(reason) => Err(reason),
        };
        match row {
            Err(reason) => {
                cut = Some(reason);
                break;
            }
            Ok(row) if index < rows.len() => rows[index] = row,
            Ok(row) => rows.push(row),
        }
        if let Some(folder) = folder {
            folder.folder.write(ROWS, json(&rows)?)?;
        }
    }
    let study = StudyJson::new(&plan, rows, combinations.len());
    finished(loaded, session, folder, &study, cut)
}

/// The folder of the study, if one is asked for, and the controls that it names.
fn started(
    loaded: &LoadedScene,
    session: &Session<'_>,
    plan: &Plan,
    count: usize,
) -> Result<(Option<RunFolder>, Vector), Failure> {
    let rows = (1..=if plan.optimize { count } else { 0 }).map(|number| format!("{}/{REGISTER}", row_folder(number)));
    let claimed: Vec<String> = std::iter::once(STUDY.to_owned()).chain(rows).collect();
    let objective = solved_shape::objective(&loaded.case, &session.processes)?;
    let load = |file| controls::load(objective.solver().problem(), &loaded.case, ("--controls", Some(file)));
    let given = session.arguments.shape.controls.as_deref().map(load).transpose()?;
    let (folder, controls) = begin(&objective, loaded, given.as_ref(), (RunKind::Study, &claimed), session)?;
    let optimizer = &loaded.case.optimizer;
    if plan.optimize
        && !optimizer.continuation.is_empty()
        && plan.vary.iter().any(|varied| varied.field() == "body[0].block.bricks")
    {
        folder.iter().for_each(RunFolder::abandon);
        return Err(Failure::Input("--vary mesh is allowed without --continuation, which names the meshes".into()));
    }
    if let Some(folder) = folder.as_ref().filter(|folder| folder.resumed) {
        let most = rows_of(folder)?.iter().filter_map(Row::evaluations).max().unwrap_or(0);
        if optimizer.max_evaluations < most {
            let allowed = format!("at least the {most} evaluations that a row has");
            return Err(SceneError::out_of_range("--max-evaluations", optimizer.max_evaluations, allowed).into());
        }
    }
    if let Some(folder) = &folder {
        folder.proceed(loaded)?;
        folder.folder.write(STUDY, json(plan)?)?;
    }
    Ok((folder, controls))
}

/// The rows that a study which is continued has.
fn kept(folder: Option<&RunFolder>, combinations: &[Vec<String>]) -> Result<Vec<Row>, Failure> {
    let Some(folder) = folder.filter(|folder| folder.resumed) else { return Ok(Vec::new()) };
    let rows = rows_of(folder)?;
    match rows.iter().zip(combinations).all(|(row, options)| row.options == *options) {
        true if rows.len() <= combinations.len() => Ok(rows),
        _ => Err(file_error(&folder.folder.path().join(ROWS), format!("the rows are not those of {STUDY}")).into()),
    }
}

/// The rows in the folder of a study.
fn rows_of(folder: &RunFolder) -> Result<Vec<Row>, Failure> {
    let path = folder.folder.path().join(ROWS);
    if path.exists() { read(&path) } else { Ok(Vec::new()) }
}

/// Why no further row may be begun, if so.
fn cut_short(session: &Session<'_>, loaded: &LoadedScene) -> Option<String> {
    let late = |limit: f64| session.clock.elapsed().as_secs_f64() >= limit;
    let time = loaded.case.optimizer.time_limit.is_some_and(late).then(|| "time limit reached".to_owned());
    interrupted().then(|| "interrupted".to_owned()).or(time)
}

/// Prints and writes the table; `cut`: why it has not all rows.
fn finished(
    loaded: &LoadedScene,
    session: &Session<'_>,
    folder: Option<&RunFolder>,
    study: &StudyJson,
    cut: Option<String>,
) -> Result<String, Failure> {
    let text = study.to_string();
    let object = json(study)?;
    let write = |folder: &Folder| {
        write_study(folder, loaded, study)?;
        folder.write("report.txt", &text)?;
        if cut.is_none() { folder.write(REPORT, &object) } else { Ok(()) }
    };
    let printed = session.arguments.printed(text.clone(), object.clone());
    let text = printed_with_files(printed, session.arguments.json, folder.map(|folder| &folder.folder), write)?;
    if let Some(reason) = cut {
        let continued = folder.map(|folder| continuation(folder.folder.path(), session.arguments));
        let continued = continued.map_or_else(String::new, |command| format!("; continue with `{command}`"));
        let status = if interrupted() { STATUS } else { 1 };
        return Err(Failure::Incomplete { text, reason: reason + &continued, status });
    }
    if study.all_failed() {
        return Err(Failure::Incomplete { text, reason: "every row has failed".into(), status: 1 });
    }
    Ok(text)
}

/// A JSON file of the study.
fn read<T: for<'a> Deserialize<'a>>(path: &Path) -> Result<T, Failure> {
    let text = read_text(path, LARGEST_FILE)?;
    serde_json::from_str(&text).map_err(|error| file_error(path, error).into())
}
