//! One optimization on one mesh, kept in a journal if asked for.

use crate::commands::contact_objective::ContactObjective;
use crate::commands::failure::Failure;
use crate::commands::long_run::{Progress, RunFolder, StatusLine};
use crate::commands::optimize::stages::{MeshStage, Part};
use crate::commands::output::notice;
use nonsmooth::{
    AccuracyPolicy, BundleTrust, BundleTrustConfig, IterationRecord, Journaled, Matrix, Observer, Report,
    VariableScaling, Vector,
};
use scene_file::{AccuracyName, MethodName};
use std::ops::ControlFlow;

/// An optimization on one mesh that has ended.
pub struct MeshRun {
    /// Θ on its mesh.
    pub objective: ContactObjective,
    /// What the optimizer reports.
    pub report: Report,
    /// Number of evaluations that were answered from the journal.
    pub replayed: usize,
    /// What it is within its optimization.
    pub part: Part,
    /// The controls that it started from.
    pub initial_controls: Vector,
    /// Whether its journal, if it has one, holds all evaluations.
    pub is_kept: bool,
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
    folder: Option<&RunFolder>,
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
        composite_model: stage.case.method == MethodName::Composite,
        scaling: VariableScaling::Linear(mean_height_coordinates(&initial_controls, first_step)),
        ..BundleTrustConfig::default()
    };
    let name = stage.part.folder();
    let label = name.as_ref().map_or_else(String::new, |name| format!("{name}: "));
    let journaled = folder.map(|folder| folder.journaled(&objective, name.as_deref())).transpose()?;
    let replayed = journaled.as_ref().map_or(0, Journaled::held);
    let progress = Progress::new(&label, config.max_evaluations, time_limit, replayed, status.clone());
    let set = objective.solver().problem().admissible.polyhedron().clone();
    let mut method = BundleTrust::new(config)?.constraints(set).observer(progress);
    let report = match &journaled {
        None => method.minimize(&objective, initial_controls.clone())?,
        Some(journaled) => {
            let mut report = method.observer(warner(journaled)).minimize(journaled, initial_controls.clone())?;
            journaled.complete(&mut report);
            report
        }
    };
    let is_kept = journaled.as_ref().is_none_or(Journaled::is_complete);
    drop(journaled);
    Ok(MeshRun { objective, report, replayed, part: stage.part, initial_controls, is_kept })
}

/// Says what the journal warns of as soon as it does.
fn warner<O>(journaled: &Journaled<O>) -> impl Observer {
    let mut said = 0;
    move |_: &IterationRecord| {
        let warnings = journaled.warnings();
        for words in &warnings[said..] {
            notice(&format!("warning: {words}"));
        }
        said = warnings.len();
        ControlFlow::Continue(())
    }
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
/// M = I + (κ − 1)/n · 1 1ᵀ, κ = max(1, mean height / first step), stretches the mean by κ and leaves differences alone.
pub fn mean_height_coordinates(initial_controls: &Vector, first_step: f64) -> Matrix {
    let count = initial_controls.len();
    let stretch = (initial_controls.mean().abs() / first_step).max(1.0);
    Matrix::from_fn(count, count, |i, j| (stretch - 1.0) / count as f64 + f64::from(u8::from(i == j)))
}
