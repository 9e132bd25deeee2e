//! `study`: a table over values of parameters. Every row is the scene with some options, evaluated at one shape or optimized.
//!
//! ```text
//! DIR/scene.toml, start.json, study.json   the study as stated
//! DIR/rows.json                            the rows so far; a study that is continued computes the others
//! DIR/row_001, row_002, …                  with --optimize: the optimization of each row
//! ```

mod row;
mod table;
mod varied;

pub use row::{Outcome, Picture, Row, Solved};
pub use varied::Varied;
use varied::{HEIGHT_ERROR, SEED};

use crate::commands::contact_objective::objective_among;
use crate::commands::controls;
use crate::commands::failure::Failure;
use crate::commands::folder::{Folder, REPORT, RunKind, STUDY, json, printed_with_files, resume_command};
use crate::commands::loaded_scene::{LoadedScene, Session};
use crate::commands::long_run::{RunFolder, STATUS, interrupted, watch_interrupts};
use crate::commands::optimize::run::begin;
use crate::commands::report::study::write_study;
use contact::error::SceneError;
use nonsmooth::Vector;
use serde::{Deserialize, Serialize};
use std::path::Path;
pub use table::{StudyJson, values};

/// The rows of a study.
const ROWS: &str = "rows.json";
/// Most rows.
const MAX_ROWS: usize = 1000;

/// The folder of a row, by its number from 1.
pub fn row_folder(number: usize) -> String {
    format!("row_{number:03}")
}

/// What a study varies.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Plan {
    /// The options with their values.
    vary: Vec<Varied>,
    /// Whether every row is optimized.
    optimize: bool,
    /// Whether all rows begin at the controls of the study, or each at the start of its scene.
    same_start: bool,
}

/// The command.
pub fn run(loaded: &LoadedScene, session: &Session<'_>) -> Result<String, Failure> {
    let path = loaded.case.output.folder.as_deref().map(Path::new);
    let plan = match path.filter(|_| session.arguments.resume.is_some()) {
        Some(folder) => read(&folder.join(STUDY))?,
        None => stated(session)?,
    };
    let combinations = varied::combinations(&plan.vary);
    let parts: Vec<String> = (1..=combinations.len()).map(row_folder).collect();
    let (folder, controls) = started(loaded, session, &plan, &parts)?;
    let folder = folder.as_ref();
    watch_interrupts(session.processes.is_alone());
    let mut rows: Vec<Row> = kept(folder, &combinations, session)?;
    let begin_rows = rows.len();
    let mut cut = None;
    for (options, part) in combinations.iter().zip(&parts).skip(begin_rows) {
        session.status.begin(format!("row {} of {}: ", rows.len() + 1, combinations.len()));
        let out = folder.filter(|_| plan.optimize).map(|folder| folder.folder().path().join(part));
        let start = plan.same_start.then_some(&controls);
        let row = match cut_short(session, loaded) {
            None => row::computed(loaded, options, (plan.optimize, start, out.as_deref()), session)?,
            Some(reason) => Err(reason),
        };
        match row {
            Ok(row) => rows.push(row),
            Err(reason) => {
                cut = Some(reason);
                break;
            }
        }
        if let Some(folder) = folder {
            folder.folder().write(ROWS, json(&rows)?)?;
        }
    }
    let study = StudyJson::new(&plan, rows, combinations.len());
    finished(loaded, session, folder, &study, cut)
}

/// The study that the command line states.
fn stated(session: &Session<'_>) -> Result<Plan, Failure> {
    let arguments = session.arguments;
    let mut names: Vec<&str> = arguments.vary.iter().map(Varied::name).collect();
    names.sort_unstable();
    if let Some(pair) = names.windows(2).find(|pair| pair[0] == pair[1]) {
        return Err(Failure::Input(format!("--vary {} is allowed once", pair[0])));
    }
    let varies = |name: &str| names.contains(&name);
    if varies(HEIGHT_ERROR) && arguments.optimize {
        return Err(Failure::Input(format!("--vary {HEIGHT_ERROR} is allowed without --optimize")));
    }
    if varies(SEED) && !varies(HEIGHT_ERROR) {
        return Err(Failure::Input(format!("--vary {SEED} is allowed with --vary {HEIGHT_ERROR}=VALUES")));
    }
    let count = arguments.vary.iter().fold(1_usize, |count, varied| count.saturating_mul(varied.values().len()));
    if count > MAX_ROWS {
        return Err(SceneError::out_of_range("--vary", format!("{count} rows"), format!("at most {MAX_ROWS}")).into());
    }
    let same_start = arguments.controls.is_some() || arguments.start_controls.is_some();
    Ok(Plan { vary: arguments.vary.clone(), optimize: arguments.optimize, same_start })
}

/// The folder of the study, if one is asked for, and the controls that it names.
fn started(
    loaded: &LoadedScene,
    session: &Session<'_>,
    plan: &Plan,
    parts: &[String],
) -> Result<(Option<RunFolder>, Vector), Failure> {
    let parts: Vec<&str> = if plan.optimize { parts.iter().map(String::as_str).collect() } else { vec![] };
    let objective = objective_among(&loaded.case, &session.processes)?;
    let load = |file| controls::load(objective.solver().problem(), &loaded.case, ("--controls", Some(file)));
    let given = session.arguments.controls.as_deref().map(load).transpose()?;
    let (folder, controls) = begin(&objective, loaded, given.as_ref(), &parts, session)?;
    if let Some(folder) = &folder {
        folder.proceed(loaded)?;
        folder.folder().write(STUDY, json(plan)?)?;
    }
    Ok((folder, controls))
}

/// The rows that a study which is continued has. A larger limit of evaluations takes up the optimizations that a limit has ended.
fn kept(folder: Option<&RunFolder>, combinations: &[Vec<String>], session: &Session<'_>) -> Result<Vec<Row>, Failure> {
    let Some(folder) = folder.filter(|folder| folder.is_resumed()) else { return Ok(Vec::new()) };
    let path = folder.folder().path().join(ROWS);
    let mut rows: Vec<Row> = if path.exists() { read(&path)? } else { Vec::new() };
    if session.arguments.max_evaluations.is_some() {
        let whole = rows.iter().position(Row::ended_at_a_limit).unwrap_or(rows.len());
        rows.truncate(whole);
    }
    match rows.iter().zip(combinations).all(|(row, options)| row.options == *options) {
        true if rows.len() <= combinations.len() => Ok(rows),
        _ => Err(Failure::Input(format!("{}: the rows are not those of {STUDY}", path.display()))),
    }
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
    let text = printed_with_files(printed, session.arguments.json, folder.map(RunFolder::folder), write)?;
    if let Some(reason) = cut {
        let continued = folder.map(|folder| resume_command(folder.folder().path(), RunKind::Study));
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
    let failed = |reason: String| Failure::Input(format!("{}: {reason}", path.display()));
    let text = std::fs::read_to_string(path).map_err(|error| failed(error.to_string()))?;
    serde_json::from_str(&text).map_err(|error| failed(error.to_string()))
}
