//! An optimization from start to end: on one mesh or on growing ones, kept on disk if asked for.

use crate::commands::long_run::{Progress, RunFolder, StatusLine, interrupted, watch_interrupts};
use crate::commands::optimized::Finished;
use crate::commands::stages::{Stage, stages};
use crate::commands::{Arguments, ContactObjective, Failure, Source, controls, objective};
use contact::error::SceneError;
use nonsmooth::{
    AccuracyPolicy, BundleTrust, BundleTrustConfig, IterationRecord, Journaled, Matrix, Observer, Report, Termination,
    VariableScaling, Vector,
};
use scene_file::{AccuracyName, Case};
use std::ops::ControlFlow;
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
        let result = run_stage(&objective, stage, (&start, step), left, folder.as_ref(), &session.status)?;
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
pub fn check_limit(folder: &RunFolder, stages: &[Stage]) -> Result<(), Failure> {
    for stage in stages {
        let (held, limit) = (folder.evaluations(stage.name.as_deref())?, stage.case.optimizer.max_evaluations);
        if held > limit {
            let allowed = format!("at least the {held} evaluations that the folder holds");
            return Err(SceneError::out_of_range("--max-evaluations", limit, allowed).into());
        }
    }
    Ok(())
}

/// Bytes of a number in the restart data.
const NUMBER_BYTES: u64 = 24;

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
    (3 * 3 * NUMBER_BYTES + 2 * FIELD_BYTES) * nodes.max().unwrap_or(0) + (4 << 20)
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
    folder: Option<&RunFolder>,
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
        scaling: VariableScaling::Linear(mean_height_coordinates(start, first_step)),
        ..BundleTrustConfig::default()
    };
    let label = stage.name.as_ref().map_or_else(String::new, |name| format!("{name}: "));
    let journaled = folder.map(|folder| folder.journaled(objective, stage.name.as_deref())).transpose()?;
    let replayed = journaled.as_ref().map_or(0, Journaled::held);
    let progress = Progress::new(&label, config.max_evaluations, time_limit, replayed, status.clone());
    let set = objective.solver().problem().admissible.polyhedron().clone();
    let mut method = BundleTrust::new(config)?.constraints(set).observer(progress);
    let report = match &journaled {
        None => method.minimize(objective, start.clone())?,
        Some(journaled) => {
            let mut report = method.observer(warner(journaled)).minimize(journaled, start.clone())?;
            journaled.complete(&mut report);
            report
        }
    };
    Ok(Optimized { report, replayed, name: stage.name.clone(), start: start.clone() })
}

/// Says what the journal warns of as soon as it does.
fn warner<O>(journaled: &Journaled<O>) -> impl Observer {
    let mut said = 0;
    move |_: &IterationRecord| {
        let warnings = journaled.warnings();
        for words in &warnings[said..] {
            eprintln!("warning: {words}");
        }
        said = warnings.len();
        ControlFlow::Continue(())
    }
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
