//! An optimization from start to end: on one mesh or on growing ones, kept on disk if asked for.

use crate::commands::long_run::{
    Entry, Journal, Journaled, Progress, RunFolder, StatusLine, interrupted, watch_interrupts,
};
use crate::commands::optimize::stages::{Stage, stages};
use crate::commands::optimize::summary::Finished;
use crate::commands::{Arguments, ContactObjective, Failure, Source, controls, objective};
use contact::error::SceneError;
use nonsmooth::{
    AccuracyPolicy, BundleTrust, BundleTrustConfig, Matrix, NonsmoothObjective, Reparametrized, Report, Termination,
    Vector,
};
use scene_file::{AccuracyName, Case};
use std::path::{Path, PathBuf};
use std::time::Instant;

/// First step on every mesh but the first, in first steps of the first mesh. The gap at a coarse optimum says nothing about the
/// changes that the finer mesh asks for, since the bodies have followed the surface; steps from a fourteenth to a third of the
/// first were measured to do about equally well (docs/long_runs.md).
const LATER_STEP: f64 = 0.2;

/// What one invocation has in common for all its optimizations.
#[derive(Debug, Clone)]
pub struct Session<'a> {
    /// The command line.
    pub arguments: &'a Arguments,
    /// Since when the time limit counts.
    pub clock: Instant,
    /// Where progress is shown.
    pub status: StatusLine,
}

/// An optimization that has ended.
pub struct Optimization {
    /// Its meshes, in order; at least one.
    pub finished: Vec<Finished>,
    /// Number of meshes asked for.
    pub asked: usize,
    /// Where it is kept.
    pub folder: Option<RunFolder>,
}

impl Optimization {
    /// Whether it ended before its time: by the time limit or by an interruption.
    pub fn was_cut_short(&self) -> bool {
        let ended = |stage: &Finished| matches!(stage.report.termination, Termination::TimeLimit);
        self.finished.last().is_some_and(ended) || interrupted()
    }

    /// Whether it ended for want of evaluations, time or patience.
    pub fn can_continue(&self) -> bool {
        let limits = [Termination::EvaluationLimit, Termination::TimeLimit, Termination::StoppedByObserver];
        let limited = |stage: &Finished| limits.contains(&stage.report.termination);
        self.finished.len() < self.asked || self.finished.last().is_some_and(limited)
    }
}

/// Where an optimization begins.
#[derive(Debug, Clone, Copy)]
pub enum Begin<'a> {
    /// At the controls that the command line or the scene names.
    Anew,
    /// At these controls.
    At(&'a Vector),
    /// Where the run that its folder holds began; that run is continued.
    Resumed,
}

/// Optimizes a case.
///
/// # Errors
/// [`Failure`] with its exit status.
pub fn optimize(
    source: &Source,
    case: &Case,
    begin: Begin<'_>,
    session: &Session<'_>,
) -> Result<Optimization, Failure> {
    let stages = stages(case);
    let folder = case.output.folder.as_deref();
    let folder =
        folder.map(|path| RunFolder::open(path, room(&stages), matches!(begin, Begin::Resumed))).transpose()?;
    let first = objective(&stages[0].case)?;
    let mut start = match begin {
        Begin::Anew => controls::load(first.solver(), case, session.arguments.start_controls.as_deref())?,
        Begin::At(start) => start.clone(),
        // Replaced by what the folder holds.
        Begin::Resumed => first.solver().start(),
    };
    if let Some(folder) = folder.as_ref().filter(|_| matches!(begin, Begin::Resumed)) {
        check_limit(folder, &stages)?;
    }
    if let Some(folder) = &folder {
        start = Vector::from_vec(folder.begin(source, start.as_slice())?);
        first.solver().problem().admissible.check(&start)?;
    }
    watch_interrupts();
    let mut finished: Vec<Finished> = Vec::new();
    let optimizer = &case.optimizer;
    let mut step = optimizer.first_step.unwrap_or_else(|| first_step(&first, &start));
    let mut first = Some(first);
    for stage in &stages {
        let objective = match first.take() {
            Some(objective) => objective,
            None => objective(&stage.case)?,
        };
        let left = case
            .optimizer
            .time_limit
            .map(|limit| (limit - session.clock.elapsed().as_secs_f64()).max(f64::MIN_POSITIVE));
        let kept = folder.as_ref().map(|folder| folder.journal(stage.name.as_deref())).transpose()?;
        let result = run_stage(&objective, stage, (&start, step), left, kept, &session.status)?;
        if finished.is_empty() {
            step *= LATER_STEP;
        }
        start = result.report.solution.clone();
        let ended = matches!(result.report.termination, Termination::TimeLimit) || interrupted();
        finished.push(result.finished(objective));
        if ended {
            break;
        }
    }
    Ok(Optimization { finished, asked: stages.len(), folder })
}

/// Refuses fewer evaluations than a run that is continued has made already: its report would become worse.
pub fn check_limit(folder: &RunFolder, stages: &[Stage]) -> Result<(), SceneError> {
    for stage in stages {
        let (held, limit) = (folder.evaluations(stage.name.as_deref())?, stage.case.optimizer.max_evaluations);
        if held > limit {
            let allowed = format!("at least the {held} evaluations that the folder holds");
            return Err(SceneError::out_of_range("--max-evaluations", limit, allowed));
        }
    }
    Ok(())
}

/// Bytes per torn node of the fields of one state (some 260 bytes per brick were written at 35³).
const FIELD_BYTES: u64 = 300;

/// Bytes that the files of a run may need: restart data of two evaluations and of one being written, fields of two states, and
/// the rest.
pub fn room(stages: &[Stage]) -> u64 {
    let nodes = stages.iter().map(|stage| {
        let scene = &stage.case.scene;
        let torn = scene.mesh.iter().zip(&scene.subdomains).map(|(cells, count)| (cells + count) as u64);
        torn.product::<u64>() * if scene.upper.is_some() { 2 } else { 1 }
    });
    (3 * 3 * 8 + 2 * FIELD_BYTES) * nodes.max().unwrap_or(0) + (4 << 20)
}

struct Optimized {
    report: Report,
    replayed: usize,
    name: Option<String>,
    start: Vector,
}

impl Optimized {
    fn finished(self, objective: ContactObjective) -> Finished {
        let Self { report, replayed, name, start } = self;
        Finished { objective, report, replayed, name, start }
    }
}

/// Optimizes on one mesh, from a start with a first step, with a journal if there is one.
fn run_stage(
    objective: &ContactObjective,
    stage: &Stage,
    (start, first_step): (&Vector, f64),
    time_limit: Option<f64>,
    kept: Option<(PathBuf, Journal, Vec<Entry>)>,
    status: &StatusLine,
) -> Result<Optimized, Failure> {
    let optimizer = &stage.case.optimizer;
    let accuracy = match optimizer.accuracy {
        AccuracyName::Tightest => AccuracyPolicy::Tightest,
        AccuracyName::OnDemand => AccuracyPolicy::ON_DEMAND,
    };
    let config = BundleTrustConfig {
        max_evaluations: optimizer.max_evaluations,
        tolerance: optimizer.tolerance,
        max_seconds: time_limit,
        first_step: Some(first_step),
        bundle_size: optimizer.bundle_size,
        accuracy,
        ..BundleTrustConfig::default()
    };
    let label = stage.name.as_ref().map_or_else(String::new, |name| format!("{name}: "));
    let matrix = mean_height_coordinates(start, first_step);
    let set = objective.solver().problem().admissible.polyhedron();
    let set = Reparametrized::new(objective, matrix.clone())?.transformed_set(set)?;
    let replayed = kept.as_ref().map_or(0, |(_, _, entries)| entries.len());
    let progress = Progress::new(&label, config.max_evaluations, time_limit, replayed, status.clone());
    let method = BundleTrust::new(config)?.constraints(set).observer(progress);
    let report = match kept {
        None => minimize(method, &Reparametrized::new(objective, matrix)?, start, None)?,
        Some((folder, mut journal, entries)) => {
            let seconds: Vec<f64> = entries.iter().map(|entry| entry.seconds).collect();
            let journaled = Journaled::new(objective, &mut journal, entries);
            let scaled = Reparametrized::new(&journaled, matrix)?;
            let mut report = minimize(method, &scaled, start, Some(&folder.join("snapshot.json")))?;
            report.warnings.extend(journaled.into_warnings());
            report.warnings.dedup();
            add_earlier_seconds(&mut report, &seconds);
            report
        }
    };
    Ok(Optimized { report, replayed, name: stage.name.clone(), start: start.clone() })
}

/// Runs the optimizer; the solution is in the original coordinates.
fn minimize<O: NonsmoothObjective>(
    mut method: BundleTrust<'_>,
    scaled: &Reparametrized<O>,
    start: &Vector,
    snapshot: Option<&Path>,
) -> Result<Report, Failure> {
    if let Some(file) = snapshot {
        method = method.checkpoint(file);
    }
    let mut run = method.start(scaled, scaled.transformed(start))?;
    while run.step().is_continue() {}
    let written = snapshot.map(|file| run.snapshot().write(file));
    let mut report = run.finish();
    if let Some(Err(error)) = written {
        report.warnings.push(format!("snapshot not written: {error}"));
    }
    report.solution = scaled.original(&report.solution);
    Ok(report)
}

/// The time of a resumed run includes that of its earlier parts.
fn add_earlier_seconds(report: &mut Report, earlier: &[f64]) {
    let before = earlier.last().copied().unwrap_or(0.0);
    for (index, record) in report.history.iter_mut().enumerate() {
        record.seconds = earlier.get(index).copied().unwrap_or(before + record.seconds);
    }
    report.seconds += before;
}

/// Half of the mean distance between the starting surface and its counterpart: the length on which contact changes, mm. A
/// hundredth of the height where they coincide.
pub fn first_step(objective: &ContactObjective, start: &Vector) -> f64 {
    let problem = objective.solver().problem();
    let gaps = problem.lower_block(start.as_slice()).map(|block| problem.gaps(&block)).unwrap_or_default();
    let length = gaps.iter().map(|gap| gap.abs()).sum::<f64>() / (2 * gaps.len().max(1)) as f64;
    if length > 0.0 { length } else { 0.01 * start.amax() }
}

/// Coordinates in which a change of the mean height by the height itself is as long as a change of shape by the first step:
/// bodies that contact holds follow the surface as a whole, so that Θ hardly depends on its mean height.
///
/// M = I + (κ − 1)/n · 1 1ᵀ stretches the mean by κ and leaves differences alone.
pub fn mean_height_coordinates(start: &Vector, first_step: f64) -> Matrix {
    let count = start.len();
    let stretch = (start.mean().abs() / first_step).max(1.0);
    Matrix::from_fn(count, count, |i, j| (stretch - 1.0) / count as f64 + f64::from(u8::from(i == j)))
}
