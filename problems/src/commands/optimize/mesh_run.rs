//! One optimization on one mesh, kept in a journal if asked for.

use crate::commands::failure::Failure;
use crate::commands::long_run::{Progress, RunFolder, StatusLine};
use crate::commands::optimize::stages::{MeshStage, Part};
use crate::commands::output::notice;
use crate::commands::solved_shape::{ContactObjective, SolvedShape};
use contact::plausibility::Warning;
use contact::standstill::standstill;
use nonsmooth::{
    AccuracyPolicy, BundleTrust, BundleTrustConfig, IterationRecord, Journaled, Observer, Report, VariableScaling,
    Vector,
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
    /// As [`standstill`], for all runs of an optimization and the shape at which this one, the last, ended.
    pub fn standstill(&self, runs: &[Self], shape: &SolvedShape) -> Result<Option<Warning>, Failure> {
        let reports = runs.iter().map(|run| &run.report);
        Ok(standstill(reports, &self.objective, &self.initial_controls, (&shape.controls, &shape.states))?)
    }

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
        tolerance: stage.case.tolerance,
        max_seconds: time_limit,
        first_step: Some(first_step),
        bundle_size: optimizer.bundle_size,
        accuracy,
        composite_model: stage.case.method == MethodName::Composite,
        scaling: VariableScaling::Linear(objective.coordinates(&initial_controls, first_step)),
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
