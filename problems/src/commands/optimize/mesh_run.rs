//! One optimization on one mesh, kept in a journal if asked for.

use crate::commands::contact_objective::ContactObjective;
use crate::commands::failure::Failure;
use crate::commands::long_run::{Entry, Journal, Journaled, Progress, StatusLine};
use crate::commands::optimize::stages::MeshStage;
use nonsmooth::{
    AccuracyPolicy, BundleTrust, BundleTrustConfig, Matrix, NonsmoothObjective, Reparametrized, Report, Vector,
};
use scene_file::AccuracyName;
use std::path::{Path, PathBuf};

/// An optimization on one mesh that has ended.
pub struct MeshRun {
    /// Θ on its mesh.
    pub objective: ContactObjective,
    /// What the optimizer reports.
    pub report: Report,
    /// Number of evaluations that were answered from the journal.
    pub replayed: usize,
    /// Name of the mesh's folder; none for a run on a single mesh.
    pub name: Option<String>,
    /// The controls that it started from.
    pub initial_controls: Vector,
}

impl MeshRun {
    /// The constraints of the shape that the solution attains, in words.
    pub fn active_constraints(&self) -> String {
        /// As many constraints as a line holds.
        const MAX_NAMED_CONSTRAINTS: usize = 3;
        let active = self.objective.solver().problem().admissible.active(&self.report.solution);
        match active.len() {
            0 => "no constraint of the shape".into(),
            count if count > MAX_NAMED_CONSTRAINTS => {
                let named = active[..MAX_NAMED_CONSTRAINTS].join("; ");
                format!("{named}; {} more", count - MAX_NAMED_CONSTRAINTS)
            }
            _ => active.join("; "),
        }
    }
}

/// Optimizes on one mesh, from initial controls with a first step, with a journal if there is one.
pub fn run_on_mesh(
    objective: ContactObjective,
    stage: &MeshStage,
    (initial_controls, first_step): (Vector, f64),
    time_limit: Option<f64>,
    kept: Option<(PathBuf, Journal, Vec<Entry>)>,
    status: &StatusLine,
) -> Result<MeshRun, Failure> {
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
    let matrix = mean_height_coordinates(&initial_controls, first_step);
    let set = objective.solver().problem().admissible.polyhedron();
    let set = Reparametrized::new(&objective, matrix.clone())?.transformed_set(set)?;
    let replayed = kept.as_ref().map_or(0, |(_, _, entries)| entries.len());
    let progress = Progress::new(&label, config.max_evaluations, time_limit, replayed, status.clone());
    let method = BundleTrust::new(config)?.constraints(set).observer(progress);
    let report = match kept {
        None => minimize(method, &Reparametrized::new(&objective, matrix)?, &initial_controls, None)?,
        Some((folder, mut journal, entries)) => {
            let seconds: Vec<f64> = entries.iter().map(|entry| entry.seconds).collect();
            let journaled = Journaled::new(&objective, &mut journal, entries);
            let scaled = Reparametrized::new(&journaled, matrix)?;
            let mut report = minimize(method, &scaled, &initial_controls, Some(&folder.join("snapshot.json")))?;
            report.warnings.extend(journaled.into_warnings());
            report.warnings.dedup();
            add_earlier_seconds(&mut report, &seconds);
            report
        }
    };
    Ok(MeshRun { objective, report, replayed, name: stage.name.clone(), initial_controls })
}

/// Runs the optimizer; the solution is in the original coordinates.
fn minimize<O: NonsmoothObjective>(
    mut method: BundleTrust<'_>,
    scaled: &Reparametrized<O>,
    initial_controls: &Vector,
    snapshot: Option<&Path>,
) -> Result<Report, Failure> {
    if let Some(file) = snapshot {
        method = method.checkpoint(file);
    }
    let mut run = method.start(scaled, scaled.transformed(initial_controls))?;
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
pub fn first_step(objective: &ContactObjective, initial_controls: &Vector) -> f64 {
    let problem = objective.solver().problem();
    let gaps = problem.lower_block(initial_controls.as_slice()).map(|block| problem.gaps(&block)).unwrap_or_default();
    let length = gaps.iter().map(|gap| gap.abs()).sum::<f64>() / (2 * gaps.len().max(1)) as f64;
    if length > 0.0 { length } else { 0.01 * initial_controls.amax() }
}

/// Coordinates in which a change of the mean height by the height itself is as long as a change of shape by the first step:
/// bodies that contact holds follow the surface as a whole, so that Θ hardly depends on its mean height.
///
/// M = I + (κ − 1)/n · 1 1ᵀ stretches the mean by κ and leaves differences alone.
pub fn mean_height_coordinates(initial_controls: &Vector, first_step: f64) -> Matrix {
    let count = initial_controls.len();
    let stretch = (initial_controls.mean().abs() / first_step).max(1.0);
    Matrix::from_fn(count, count, |i, j| (stretch - 1.0) / count as f64 + f64::from(u8::from(i == j)))
}
