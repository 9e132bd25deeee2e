//! An optimization from its beginning to its end: on one mesh or on growing ones, kept on disk if asked for.

use crate::commands::case_facts;
use crate::commands::controls;
use crate::commands::failure::{Failure, failed};
use crate::commands::folder::Folder;
use crate::commands::interrupt::{interrupted, watch_interrupts};
use crate::commands::loaded_scene::{LoadedScene, Session};
use crate::commands::long_run::RunFolder;
use crate::commands::mesh_words::mesh;
use crate::commands::optimize::mesh_run::{MeshRun, run_on_mesh};
use crate::commands::optimize::stages::{MeshStage, Part, stages};
use crate::commands::run_kind::RunKind;
use crate::commands::solved_shape::{ContactObjective, check_ahead, optimized_objective, wanted};
use contact::error::SceneError;
use contact::scene::SceneSize;
use nonsmooth::qp::project;
use nonsmooth::verify::seeded_direction;
use nonsmooth::{Termination, Vector};
use scene_file::MethodName;
use std::path::Path;

/// First step on every mesh but the first, in first steps of the first mesh. The gap at a coarse optimum says nothing
/// about the changes that the finer mesh asks for, since the bodies have followed the surface; steps from a fourteenth
/// to a third of the first were measured to do about equally well (docs/long_runs.md).
const LATER_FIRST_STEP: f64 = 0.2;

/// An optimization that has ended.
pub struct OptimizationRun {
    /// The runs, one per mesh or one per start, in order; at least one.
    pub mesh_runs: Vec<MeshRun>,
    /// Number of runs asked for: meshes, or starts.
    pub meshes: usize,
    /// The folder in which it is kept.
    pub folder: Option<RunFolder>,
}

impl OptimizationRun {
    /// The run that the optimization is reported by: the last one, or the best one of several starts.
    pub fn chosen(&self) -> Option<&MeshRun> {
        let is_start = |run: &&MeshRun| matches!(run.part, Part::Start(_));
        let best = self
            .mesh_runs
            .iter()
            .filter(is_start)
            .min_by(|a, b| violation(a).total_cmp(&violation(b)).then(a.report.value.total_cmp(&b.report.value)));
        best.or(self.mesh_runs.last())
    }

    /// The runs that lead to the one that it is reported by, this one included: all meshes in turn, or one start alone.
    pub fn reported(&self) -> Vec<&MeshRun> {
        if self.mesh_runs.iter().all(|run| matches!(run.part, Part::Mesh(_))) {
            return self.mesh_runs.iter().collect();
        }
        self.chosen().into_iter().collect()
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

/// The relative violation of the limits at the end of a run; 0 where all are kept.
fn violation(run: &MeshRun) -> f64 {
    let violated = run.report.constraints.iter().filter(|limit| !limit.satisfied);
    violated.map(|limit| limit.violation).fold(0.0, f64::max)
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
    let (folder, mut controls) = begin(&first, loaded, given, (RunKind::Optimization, &[]), session)?;
    if let Some(folder) = &folder {
        folder.proceed(loaded)?;
    }
    case_facts::announce(&first, session.arguments);
    // What starts several processes asks the others to end when one has failed, and must not make them talk.
    watch_interrupts(session.processes.is_alone());
    let optimizer = &loaded.case.optimizer;
    let mut step = optimizer.first_step.unwrap_or_else(|| first.first_step(&controls));
    let start = controls.clone();
    let (mut mesh_runs, mut first) = (Vec::new(), Some(first));
    for stage in &stages {
        let objective = first.take().map_or_else(|| optimized_objective(&stage.case, &session.processes), Ok)?;
        let left = |limit: f64| (limit - session.clock.elapsed().as_secs_f64()).max(f64::MIN_POSITIVE);
        if let Some(seed) = stage.part.random_start() {
            controls = random_start(&objective, &start, step, seed)?;
        }
        let beginning = (controls, step);
        let limit = optimizer.time_limit.map(left);
        let run = run_on_mesh(objective, stage, beginning, limit, folder.as_ref(), &session.status);
        let run = run.inspect_err(|failure| {
            if let (Some(folder), 2, true) = (&folder, failure.status(), mesh_runs.is_empty()) {
                folder.abandon();
            }
        })?;
        if mesh_runs.is_empty() && !optimizer.continuation.is_empty() {
            step *= LATER_FIRST_STEP;
        }
        controls = run.report.solution.clone();
        let ended = ran_out_of_time(&run);
        mesh_runs.push(run);
        if ended {
            break;
        }
    }
    Ok(OptimizationRun { mesh_runs, meshes: stages.len(), folder })
}

/// "the mesh of 12×12×4 bricks"
fn on(stage: &MeshStage) -> String {
    format!("the mesh of {}", mesh(&stage.case.scene))
}

/// Largest change of a control at a random start, in first steps: several times the length on which contact changes.
const RANDOM_CHANGE: f64 = 4.0;

/// The start with random changes, moved into the admissible set; the same for the same seed.
fn random_start(objective: &ContactObjective, start: &Vector, step: f64, seed: u64) -> Result<Vector, Failure> {
    let set = objective.solver().problem().admissible.polyhedron();
    let direction = seeded_direction(start.len(), seed);
    let moved = start + &direction * (RANDOM_CHANGE * step / direction.amax());
    project(set, &moved).map_err(|error| Failure::Computation(format!("start {seed}: {error}")))
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
        let nodes = (size.bodies * size.pieces * size.piece_nodes) as u64;
        let contact = size.contact_nodes as u64;
        let controls = stage.case.scene.control_count() as u64;
        let restart_data = 3 * NUMBER_BYTES * nodes;
        let jacobian = 2 * 8 * contact * controls;
        let kept = match stage.case.method {
            MethodName::Composite => JACOBIANS * (restart_data + jacobian),
            MethodName::Bundle => 0,
        };
        let shapes = 2 + if series { SERIES.min(stage.case.optimizer.max_evaluations as u64) } else { 0 };
        3 * restart_data + shapes * FIELD_BYTES * nodes + REPORT_BYTES * contact + kept
    });
    let runs = if kind == RunKind::Comparison { 2 } else { 1 };
    runs * (bytes.max().unwrap_or(0) + (4 << 20))
}
