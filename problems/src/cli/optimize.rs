//! `optimize`: the shape of least contact pressure measure, on one mesh or on growing ones, kept on disk if asked for.

use crate::cli::long_run::{Entry, Journal, Journaled, Progress, RunFolder, STATUS, interrupted, watch_interrupts};
use crate::cli::optimized::{Finished, history_table, page, peak_pressures, stages_page, summary};
use crate::cli::stages::{Stage, stages};
use crate::cli::{Arguments, ContactObjective, Failure, Source, controls, evaluate, objective, output};
use crate::scene_file::{AccuracyName, Case};
use nonsmooth::{
    Accuracy, AccuracyPolicy, BundleTrust, BundleTrustConfig, Matrix, NonsmoothObjective, Reparametrized, Report,
    StateSolver, Termination, Vector,
};
use std::path::{Path, PathBuf};
use std::time::Instant;

/// First step on every mesh but the first, in first steps of the first mesh. The gap at a coarse optimum says nothing about the
/// changes that the finer mesh asks for, since the bodies have followed the surface; steps from a fourteenth to a third of the
/// first were measured to do about equally well (docs/long_runs.md).
const LATER_STEP: f64 = 0.2;

pub fn run(source: &Source, case: &Case, arguments: &Arguments) -> Result<String, Failure> {
    let clock = Instant::now();
    let stages = stages(case);
    let resumed = arguments.resume.is_some();
    let folder = case.output.folder.as_deref();
    let folder = folder.map(|path| RunFolder::open(path, room(&stages), resumed)).transpose()?;
    let first = objective(&stages[0].case)?;
    // A resumed run has its start in its folder.
    let mut start = match &arguments.resume {
        Some(_) => first.solver().start(),
        None => controls::load(first.solver(), case, arguments.start_controls.as_deref())?,
    };
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
        let left =
            case.optimizer.time_limit.map(|limit| (limit - clock.elapsed().as_secs_f64()).max(f64::MIN_POSITIVE));
        let kept = folder.as_ref().map(|folder| folder.journal(stage.name.as_deref())).transpose()?;
        let result = run_stage(&objective, stage, (&start, step), left, kept)?;
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
    deliver(&finished, stages.len(), folder.as_ref(), case, arguments)
}

/// Bytes that the files of a run may need: restart data of two evaluations and of one being written, and the rest.
fn room(stages: &[Stage]) -> u64 {
    let dofs = stages.iter().map(|stage| {
        let scene = &stage.case.scene;
        let torn = scene.mesh.iter().zip(&scene.subdomains).map(|(cells, count)| (cells + count) as u64);
        torn.product::<u64>() * 3 * if scene.upper.is_some() { 2 } else { 1 }
    });
    3 * 8 * dofs.max().unwrap_or(0) + (4 << 20)
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
    let progress = Progress::new(&label, config.max_evaluations, time_limit, replayed);
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
pub(crate) fn first_step(objective: &ContactObjective, start: &Vector) -> f64 {
    let problem = objective.solver().problem();
    let gaps = problem.lower_block(start.as_slice()).map(|block| problem.gaps(&block)).unwrap_or_default();
    let length = gaps.iter().map(|gap| gap.abs()).sum::<f64>() / (2 * gaps.len().max(1)) as f64;
    if length > 0.0 { length } else { 0.01 * start.amax() }
}

/// Coordinates in which a change of the mean height by the height itself is as long as a change of shape by the first step:
/// bodies that contact holds follow the surface as a whole, so that Θ hardly depends on its mean height.
///
/// M = I + (κ − 1)/n · 1 1ᵀ stretches the mean by κ and leaves differences alone.
pub(crate) fn mean_height_coordinates(start: &Vector, first_step: f64) -> Matrix {
    let count = start.len();
    let stretch = (start.mean().abs() / first_step).max(1.0);
    Matrix::from_fn(count, count, |i, j| (stretch - 1.0) / count as f64 + f64::from(u8::from(i == j)))
}

/// The report on stdout and, if asked for, in files; what cannot be written does not take the report along.
fn deliver(
    finished: &[Finished],
    asked: usize,
    folder: Option<&RunFolder>,
    case: &Case,
    arguments: &Arguments,
) -> Result<String, Failure> {
    let Some(last) = finished.last() else { return Err(Failure::Computation("no stage was run".into())) };
    let shape = last.objective.solver();
    let initial = shape.solve(&last.start, None, Accuracy::TIGHTEST)?;
    let optimal = shape.solve(&last.report.solution, None, Accuracy::TIGHTEST)?;
    let peaks = peak_pressures(&last.objective, [&initial, &optimal]);
    let json = output::json(&summary(finished, [&initial, &optimal]))?;
    let mut text = page(last, [&initial, &optimal]);
    text += &stages_page(finished, asked);
    if let Some(folder) = folder.filter(|_| can_continue(&last.report, finished.len() < asked)) {
        text += &format!("to continue: --resume {}\n", folder.folder().path().display());
    }
    let printed = if arguments.json { json.clone() } else { text.clone() };
    if let Some(folder) = folder {
        let folder = folder.folder();
        let write = || -> Result<(), Failure> {
            folder.write("controls.json", &output::json(last.report.solution.as_slice())?)?;
            folder.write("certificate.json", &output::json(&last.report.certificate)?)?;
            folder.write("history.csv", &history_table(&last.report))?;
            folder.write("pressure_initial.csv", &evaluate::pressure_table(&last.objective, &initial))?;
            folder.write("pressure_optimal.csv", &evaluate::pressure_table(&last.objective, &optimal))?;
            for (name, state) in
                [("initial", &initial), ("optimal", &optimal)].into_iter().filter(|_| case.output.pictures)
            {
                let title = format!("{}: contact pressure, {name} shape", case.scene.name);
                let picture = evaluate::pressure_picture(&last.objective, state, &title, peaks[0].max(peaks[1]));
                folder.write(&format!("pressure_{name}.svg"), &picture)?;
            }
            folder.write("report.txt", &text)?;
            folder.replace("report.json", &json)
        };
        if let Err(failure) = write() {
            let reason = format!("{failure}; the report above is complete");
            return Err(Failure::Incomplete { text: printed, reason, status: 1 });
        }
    }
    if interrupted() {
        let hint = match folder {
            Some(folder) => format!("continue with --resume {}", folder.folder().path().display()),
            None => "nothing was kept; with --out DIR a run can be continued".to_owned(),
        };
        return Err(Failure::Incomplete { text: printed, reason: format!("interrupted; {hint}"), status: STATUS });
    }
    Ok(printed)
}

/// Whether a run ended for want of evaluations, time or patience.
fn can_continue(report: &Report, stages_left: bool) -> bool {
    let limits = [Termination::EvaluationLimit, Termination::TimeLimit, Termination::StoppedByObserver];
    stages_left || limits.contains(&report.termination)
}
