//! One optimization on one mesh, kept in a journal if asked for.

use crate::commands::failure::Failure;
use crate::commands::long_run::{Progress, RunFolder, StatusLine};
use crate::commands::optimize::coarse_net::{Beginning, coarse_net};
use crate::commands::optimize::stages::{Attempt, MeshStage, Part};
use crate::commands::optimize::subspace::Subspace;
use crate::commands::output::notice;
use crate::commands::solved_shape::{ContactObjective, SolvedShape};
use contact::plausibility::Warning;
use contact::standstill::standstill;
use nonsmooth::{
    AccuracyPolicy, BundleTrust, BundleTrustConfig, IterationRecord, Journaled, Matrix, NonsmoothObjective, Observer,
    Polyhedron, Report, VariableScaling, Vector,
};
use scene_file::{AccuracyName, MethodName};
use std::ops::ControlFlow;
use std::sync::Arc;

/// Predicted decrease, relative to Θ, and number of evaluations at which an attempt ends: enough to tell which one is
/// worth to go on from. What a coarse net has found is refined almost to its end, since that is where the whole run
/// then begins; a first run that is cut off there would have to learn its model again.
fn ends(attempt: Attempt) -> (f64, usize) {
    match attempt {
        Attempt::Direct | Attempt::Start(_) => (1e-2, 10),
        Attempt::Coarse => (1e-2, 25),
        Attempt::Refined => (1e-3, 25),
    }
}

/// An optimization on one mesh that has ended.
pub struct MeshRun {
    /// Θ on its mesh.
    pub objective: Arc<ContactObjective>,
    /// What the optimizer reports.
    pub report: Report,
    /// Number of evaluations that were answered from the journal.
    pub replayed: usize,
    /// What it is within its optimization.
    pub part: Part,
    /// The controls that it started from.
    pub initial_controls: Vector,
    /// The bending of the shape that a fairer one has replaced at the start.
    pub bending_before: Option<f64>,
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

/// Optimizes on one mesh, from where the run begins, with a journal if there is one.
pub fn run_on_mesh(
    objective: Arc<ContactObjective>,
    stage: &MeshStage,
    Beginning { controls: initial_controls, first_step, bending_before }: Beginning,
    time_limit: Option<f64>,
    folder: Option<&RunFolder>,
    status: &StatusLine,
) -> Result<MeshRun, Failure> {
    let net = match stage.part {
        Part::Try(Attempt::Coarse) => Some(coarse_net(&objective.solver().problem().scene)?),
        _ => None,
    };
    let scaling = VariableScaling::Linear(match &net {
        Some(net) => objective.net_coordinates(&initial_controls, &net.counts, first_step),
        None => objective.coordinates(&initial_controls, first_step),
    });
    let config = BundleTrustConfig { first_step: Some(first_step), scaling, ..settings(stage, time_limit) };
    let name = stage.part.folder();
    let label = name.as_ref().map_or_else(String::new, |name| format!("{name}: "));
    let journaled = folder.map(|folder| folder.journaled(&*objective, name.as_deref())).transpose()?;
    let replayed = journaled.as_ref().map_or(0, Journaled::held);
    let progress = Progress::new(&label, config.max_evaluations, time_limit, replayed, status.clone());
    let set = objective.solver().problem().admissible.polyhedron();
    let method = BundleTrust::new(config)?.observer(progress);
    let within = (set, net.as_ref().map(|net| &net.directions));
    let report = match &journaled {
        None => minimized(method, &*objective, &initial_controls, within)?,
        Some(journaled) => {
            let method = method.observer(warner(journaled));
            let mut report = minimized(method, journaled, &initial_controls, within)?;
            journaled.complete(&mut report);
            report
        }
    };
    let is_kept = journaled.as_ref().is_none_or(Journaled::is_complete);
    drop(journaled);
    Ok(MeshRun { objective, report, replayed, part: stage.part, initial_controls, bending_before, is_kept })
}

/// The settings of the optimizer for a run, but for its first step and its coordinates.
fn settings(stage: &MeshStage, time_limit: Option<f64>) -> BundleTrustConfig {
    let optimizer = &stage.case.optimizer;
    let accuracy = match optimizer.accuracy {
        AccuracyName::Tightest => AccuracyPolicy::Tightest,
        AccuracyName::OnDemand => AccuracyPolicy::ON_DEMAND,
    };
    let (tolerance, evaluations) = match stage.part {
        Part::Try(attempt) => ends(attempt),
        _ => (0.0, usize::MAX),
    };
    BundleTrustConfig {
        max_evaluations: optimizer.max_evaluations.min(evaluations),
        tolerance: stage.case.tolerance.max(tolerance),
        confirm: !stage.part.is_attempt(),
        max_seconds: time_limit,
        bundle_size: optimizer.bundle_size,
        accuracy,
        composite_model: stage.case.method == MethodName::Composite,
        ..BundleTrustConfig::default()
    }
}

/// The run of a method within a set, along some directions if they are given.
fn minimized<O: NonsmoothObjective>(
    method: BundleTrust<'_>,
    objective: &O,
    start: &Vector,
    (set, directions): (&Polyhedron, Option<&Matrix>),
) -> Result<Report, Failure> {
    let Some(directions) = directions else {
        return Ok(method.constraints(set.clone()).minimize(objective, start.clone())?);
    };
    let subspace = Subspace::new(objective, start.clone(), directions.clone());
    let mut method = method.constraints(subspace.set(set)?);
    Ok(subspace.reported(method.minimize(&subspace, Vector::zeros(directions.ncols()))?))
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
