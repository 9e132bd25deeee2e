//! An optimization from its beginning to its end: on one mesh or on growing ones, kept on disk if asked for.

use crate::commands::case_facts;
use crate::commands::controls;
use crate::commands::failure::{Failure, failed};
use crate::commands::folder::Folder;
use crate::commands::interrupt::{interrupted, watch_interrupts};
use crate::commands::loaded_scene::{LoadedScene, Session};
use crate::commands::long_run::RunFolder;
use crate::commands::optimize::mesh_run::{MeshRun, run_on_mesh};
use crate::commands::optimize::stages::{Attempt, MeshStage, Part, stages};
use crate::commands::optimize::ways::{beginning, best, chosen};
use crate::commands::run_kind::RunKind;
use crate::commands::scene_words::mesh;
use crate::commands::solved_shape::{ContactObjective, check_ahead, optimized_objective, wanted};
use contact::error::SceneError;
use contact::scene::SceneSize;
use nonsmooth::{Termination, Vector};
use scene_file::MethodName;
use std::path::Path;
use std::sync::Arc;

/// An optimization that has ended.
pub struct OptimizationRun {
    /// The runs, one per mesh, start or attempt, in order; at least one.
    pub mesh_runs: Vec<MeshRun>,
    /// Number of runs asked for.
    pub meshes: usize,
    /// The folder in which it is kept.
    pub folder: Option<RunFolder>,
}

impl OptimizationRun {
    /// The run that the optimization is reported by.
    pub fn chosen(&self) -> Option<&MeshRun> {
        chosen(&self.mesh_runs)
    }

    /// The runs that lead to the one that it is reported by, this one included: all meshes in turn, one start alone, or
    /// the best attempt and the runs from there.
    pub fn reported(&self) -> Vec<&MeshRun> {
        let Some(chosen) = self.chosen() else { return vec![] };
        let runs = self.mesh_runs.iter();
        match chosen.part {
            Part::Mesh(_) => runs.collect(),
            Part::Start(_) | Part::Try(_) => vec![chosen],
            Part::Whole | Part::Fair => {
                let attempt = best(runs.clone().filter(|run| run.part.is_attempt()));
                let later = runs.clone().skip_while(|run| run.part.is_attempt());
                let until = later.take_while(|run| run.part == Part::Whole || chosen.part == Part::Fair);
                let is_refined = attempt.is_some_and(|run| run.part == Part::Try(Attempt::Refined));
                let coarse = runs.clone().filter(|run| is_refined && run.part == Part::Try(Attempt::Coarse));
                coarse.chain(attempt).chain(until).collect()
            }
        }
    }

    /// Whether the time limit or an interruption ended it.
    pub fn was_cut_short(&self) -> bool {
        self.mesh_runs.last().is_some_and(ran_out_of_time)
    }

    /// Why it failed, if failures of the oracle or of the subproblem ended the run that it is reported by.
    pub fn failure(&self) -> Option<String> {
        self.chosen().and_then(|run| failed(&run.report.termination))
    }

    /// Whether it ended at a limit or by an interruption, so that more evaluations may improve it.
    pub fn can_continue(&self) -> bool {
        let limits = [Termination::EvaluationLimit, Termination::TimeLimit, Termination::StoppedByObserver];
        let limited = |run: &MeshRun| limits.contains(&run.report.termination);
        self.mesh_runs.len() < self.meshes || self.mesh_runs.last().is_some_and(limited)
    }
}

/// Whether no other mesh may be begun after this run.
fn ran_out_of_time(run: &MeshRun) -> bool {
    matches!(run.report.termination, Termination::TimeLimit) || interrupted()
}

/// Optimizes a scene, on its meshes in turn, from controls that are given, or else named by the command line or the
/// scene. A run that its folder holds is continued if the command line asks for that.
pub fn optimize(
    loaded: &LoadedScene,
    given: Option<&Vector>,
    session: &Session<'_>,
) -> Result<OptimizationRun, Failure> {
    let stages = stages(&loaded.case);
    let first = optimized_objective(&stages[0].case, &session.processes)?;
    // What is wrong on a later mesh is said before hours of work on the first.
    for later in stages.iter().skip(1).filter(|stage| matches!(stage.part, Part::Mesh(_))) {
        let within = |source| SceneError::InFile { file: on(later), source: Box::new(source) };
        check_ahead(&later.case, wanted(&later.case), &session.processes).map_err(within)?;
    }
    let (folder, start) = begin(&first, loaded, given, (RunKind::Optimization, &[]), session)?;
    if let Some(folder) = &folder {
        folder.proceed(loaded)?;
    }
    case_facts::announce(&first, session.arguments);
    // What starts several processes asks the others to end when one has failed, and must not make them talk.
    watch_interrupts(session.processes.is_alone());
    let optimizer = &loaded.case.optimizer;
    let step = optimizer.first_step.unwrap_or_else(|| first.first_step(&start));
    let (mut mesh_runs, mut first, mut skipped) = (Vec::<MeshRun>::new(), Some(Arc::new(first)), 0);
    for stage in &stages {
        let shared = mesh_runs.last().filter(|_| !matches!(stage.part, Part::Mesh(_))).map(|run| &run.objective);
        let objective = match first.take().or_else(|| shared.map(Arc::clone)) {
            Some(objective) => objective,
            None => Arc::new(optimized_objective(&stage.case, &session.processes)?),
        };
        let left = |limit: f64| (limit - session.clock.elapsed().as_secs_f64()).max(f64::MIN_POSITIVE);
        let Some(beginning) = beginning(stage.part, &objective, &mesh_runs, (&start, step))? else {
            skipped += 1;
            continue;
        };
        let limit = optimizer.time_limit.map(left);
        let run = run_on_mesh(objective, stage, beginning, limit, folder.as_ref(), &session.status);
        let run = run.inspect_err(|failure| {
            if let (Some(folder), 2, true) = (&folder, failure.status(), mesh_runs.is_empty()) {
                folder.abandon();
            }
        })?;
        let ended = ran_out_of_time(&run);
        mesh_runs.push(run);
        if ended {
            break;
        }
    }
    Ok(OptimizationRun { mesh_runs, meshes: stages.len() - skipped, folder })
}

/// "the mesh of 12×12×4 bricks"
fn on(stage: &MeshStage) -> String {
    format!("the mesh of {}", mesh(&stage.case.scene))
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
fn room(stages: &[MeshStage], kind: RunKind, series: bool) -> u64 {
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
