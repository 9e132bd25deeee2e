//! An optimization from its beginning to its end: on one mesh or on growing ones, kept on disk if asked for.

use crate::commands::case_facts;
use crate::commands::controls;
use crate::commands::failure::{Failure, failed};
use crate::commands::folder::Folder;
use crate::commands::interrupt::{interrupted, watch_interrupts};
use crate::commands::loaded_scene::{LoadedScene, Session};
use crate::commands::long_run::{Progress, RunFolder, StatusLine};
use crate::commands::output::notice;
use crate::commands::run_kind::RunKind;
use crate::commands::solved_shape::ContactObjective;
use contact::scene::SceneSize;
use nonsmooth::{IterationRecord, Journaled, Observer, Termination, Vector};
use scene_file::MethodName;
use scene_file::optimization::{ContactRun, ContactStage, Driver, PlannedRun, Runs, settings, stages};
use std::path::Path;

/// An optimization that has ended.
pub struct OptimizationRun {
    /// The runs; at least one has ended.
    pub runs: Runs,
    /// The folder in which it is kept.
    pub folder: Option<RunFolder>,
}

impl OptimizationRun {
    /// Whether the time limit or an interruption ended it.
    pub fn was_cut_short(&self) -> bool {
        self.runs.ended.last().is_some_and(|run| run.is_last) || interrupted()
    }

    /// Why it failed, if failures of the oracle or of the subproblem ended the run that it is reported by.
    pub fn failure(&self) -> Option<String> {
        self.runs.chosen().and_then(|run| failed(&run.report.termination))
    }
}

/// Optimizes a scene, on its meshes in turn, from controls that are given, or else named by the command line or the
/// scene. A run that its folder holds is continued if the command line asks for that.
pub fn optimize(
    loaded: &LoadedScene,
    given: Option<&Vector>,
    session: &Session<'_>,
) -> Result<OptimizationRun, Failure> {
    let driver = Driver::new(&loaded.case, &session.processes)?;
    let (folder, start) = begin(driver.objective(), loaded, given, (RunKind::Optimization, &[]), session)?;
    if let Some(folder) = &folder {
        folder.proceed(loaded)?;
    }
    case_facts::announce(driver.objective(), session.arguments);
    // What starts several processes asks the others to end when one has failed, and must not make them talk.
    watch_interrupts(session.processes.is_alone());
    let mut runs = Runs::default();
    let perform = |stage| performed(stage, folder.as_ref(), &session.status);
    let driven = driver.run((&start, &settings(&loaded.case), session.clock), &mut runs, perform);
    driven.inspect_err(|failure| {
        if let (Some(folder), 2, true) = (&folder, failure.status(), runs.ended.is_empty()) {
            folder.abandon();
        }
    })?;
    Ok(OptimizationRun { runs, folder })
}

/// Performs a run, with a journal if there is a folder, and shows its progress.
fn performed(stage: ContactStage, folder: Option<&RunFolder>, status: &StatusLine) -> Result<ContactRun, Failure> {
    let name = stage.label.part.folder();
    let label = name.as_ref().map_or_else(String::new, |name| format!("{name}: "));
    let journaled = folder.map(|folder| folder.journaled(&*stage.objective, name.as_deref())).transpose()?;
    let replayed = journaled.as_ref().map_or(0, Journaled::held);
    let (most, limit) = (stage.config.max_evaluations, stage.config.max_seconds);
    let mut progress = Progress::new(&label, most, limit, replayed, status.clone());
    let mut show = |new: &[IterationRecord]| new.iter().try_for_each(|record| progress.observe(record));
    let report = match &journaled {
        None => stage.run(&*stage.objective, &mut |_, new| show(new))?,
        Some(journaled) => {
            let mut said = 0;
            let mut report = stage.run(journaled, &mut |_, new| {
                let shown = show(new);
                // What the journal warns of is said as soon as it does.
                let warnings = journaled.warnings();
                warnings[said..].iter().for_each(|words| notice(&format!("warning: {words}")));
                said = warnings.len();
                shown
            })?;
            journaled.complete(&mut report);
            report
        }
    };
    let is_kept = journaled.as_ref().is_none_or(Journaled::is_complete);
    drop(journaled);
    let is_last = interrupted() || report.termination == Termination::TimeLimit;
    Ok(ContactRun { stage, report, replayed, is_kept, is_last })
}

/// The folder of a run if one is asked for, and the controls that it starts from: those in the folder of a run that is
/// continued, else those given, else those that the command line or the scene names. Everything is checked before the
/// folder is touched. `claimed` are further files that will be written there.
///
/// # Errors
/// [`Failure::Input`] for controls outside the admissible set; any [`Failure`] of the folder.
pub fn begin(
    objective: &ContactObjective,
    loaded: &LoadedScene,
    given: Option<&Vector>,
    (kind, claimed): (RunKind, &[String]),
    session: &Session<'_>,
) -> Result<(Option<RunFolder>, Vector), Failure> {
    let (shape, arguments) = (objective.solver(), session.arguments);
    let path = loaded.case.output.folder.as_deref().map(Path::new);
    let bytes = room(&stages(&loaded.case), kind, arguments.series.vtk_history);
    if let Some(path) = path.filter(|path| arguments.course.resume.is_some() && RunFolder::is_one(path)) {
        let folder = RunFolder::reopen(Folder::reopen(path, bytes)?, loaded, arguments.course.new_version)?;
        shape.problem().admissible.check(&folder.initial_controls)?;
        let controls = folder.initial_controls.clone();
        return Ok((Some(folder), controls));
    }
    let load = || {
        let file = (controls::START_OPTION, arguments.course.start_controls.as_deref());
        controls::load(shape.problem(), &loaded.case, file)
    };
    let controls = given.cloned().map_or_else(load, Ok)?;
    let begin = |path| {
        RunFolder::begin(Folder::create(path, bytes, arguments.files.overwrite)?, loaded, &controls, (kind, claimed))
    };
    Ok((path.map(begin).transpose()?, controls))
}

/// Bytes of a number in the restart data.
const NUMBER_BYTES: u64 = 24;

/// Bytes per torn node of the fields of one state (some 260 bytes per cell were written at 35³).
const FIELD_BYTES: u64 = 300;

/// Bytes per contact node of the figures, as files and in the page (some 2500 were written at 35³).
const REPORT_BYTES: u64 = 3000;

/// Jacobians that a run may keep, with the restart data behind each: twice what the paper's examples need.
const JACOBIANS: u64 = 40;

/// Most shapes of a series for ParaView that room is looked for: more than twice as many serious steps as runs of the
/// paper's examples have.
const SERIES: u64 = 40;

/// Bytes that the files of a run may need: restart data of two evaluations and of one being written, fields of two
/// states, or of a series if it is asked for, figures, Jacobians of pressures and gaps, and the rest. A comparison
/// writes two runs at once; the rows of a study prove their own room.
fn room(stages: &[PlannedRun], kind: RunKind, series: bool) -> u64 {
    let bytes = stages.iter().map(|stage| {
        let size = SceneSize::of(&stage.case.scene);
        let nodes = size.sum(|body| body.pieces * body.piece_nodes) as u64;
        let contact = size.contact_nodes as u64;
        let controls = stage.case.scene.control_count() as u64;
        let restart_data = 3 * NUMBER_BYTES * nodes;
        let jacobian = 2 * 8 * contact * controls;
        let kept = match stage.case.method {
            MethodName::Composite => JACOBIANS * (restart_data + jacobian),
            MethodName::Bundle => 0,
        };
        let shapes = 2 + if series { SERIES.min(stage.case.optimizer.max_evaluations as u64) } else { 0 };
        let cases = stage.case.cases.len() as u64;
        cases * (3 * restart_data + shapes * FIELD_BYTES * nodes + REPORT_BYTES * contact + kept)
    });
    let runs = if kind == RunKind::Comparison { 2 } else { 1 };
    runs * (bytes.max().unwrap_or(0) + (4 << 20))
}
