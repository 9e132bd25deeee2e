//! What an optimization reports: page, JSON, tables.

use crate::commands::ContactObjective;
use crate::commands::solved_shape::SolvedShape;
use contact::equilibrium::{Kink, Residuals};
use nonsmooth::{Report, Termination, Vector};
use serde::Serialize;

/// An optimization on one mesh that has ended.
pub struct Finished {
    /// Θ on its mesh.
    pub objective: ContactObjective,
    /// How it went.
    pub report: Report,
    /// Evaluations that were answered from the journal.
    pub replayed: usize,
    /// Name of the stage, if there are several.
    pub name: Option<String>,
    /// Where it started.
    pub start: Vector,
}

/// What `optimize` reports; the keys of its JSON.
#[derive(Debug, Serialize)]
struct Optimized<'a> {
    objective_start: f64,
    objective: f64,
    controls: &'a [f64],
    evaluations: usize,
    serious_steps: usize,
    null_steps: usize,
    termination: Ending<'a>,
    certificate: Option<Summary>,
    largest_constraint_violation: f64,
    history: Vec<Option<f64>>,
    seconds: f64,
    /// Evaluations of an earlier part of the run, answered from its journal.
    resumed_evaluations: usize,
    peak_pressure: [f64; 2],
    /// Certificates of the contact states at the start and at the end.
    residuals: [Residuals; 2],
    /// Their distances to the nearest kink.
    kinks: [Kink; 2],
    /// One entry per mesh of a coarse-to-fine optimization.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    stages: Vec<StageSummary<'a>>,
    warnings: &'a [String],
    left_out: Vec<&'static str>,
}

#[derive(Debug, Serialize)]
pub struct Ending<'a> {
    reason: &'a Termination,
    text: String,
    confirmed: bool,
}

/// The certificate without its cuts, which go to a file.
#[derive(Debug, Serialize)]
struct Summary {
    aggregate_norm: f64,
    aggregate_error: f64,
    predicted_decrease: f64,
    active_cuts: usize,
    active_radius: f64,
    active_rows: usize,
    active_bounds: usize,
    noise: f64,
}

/// One stage of a coarse-to-fine optimization.
#[derive(Debug, Serialize)]
struct StageSummary<'a> {
    mesh: [usize; 3],
    objective_start: f64,
    objective: f64,
    evaluations: usize,
    seconds: f64,
    termination: Ending<'a>,
}

fn stage_summaries(finished: &[Finished]) -> Vec<StageSummary<'_>> {
    let staged = finished.iter().filter(|stage| stage.name.is_some());
    staged
        .map(|stage| StageSummary {
            mesh: stage.objective.solver().problem().scene.mesh,
            objective_start: stage.report.start_value,
            objective: stage.report.value,
            evaluations: stage.report.counts.evaluations,
            seconds: stage.report.seconds,
            termination: ending(&stage.report),
        })
        .collect()
}

pub fn ending(report: &Report) -> Ending<'_> {
    let termination = &report.termination;
    Ending { reason: termination, text: termination.to_string(), confirmed: termination.is_confirmed() }
}

/// One line per stage; nothing for a run on a single mesh.
pub fn stages_page(finished: &[Finished], asked: usize) -> String {
    let mut text = String::new();
    for stage in finished.iter().filter(|stage| stage.name.is_some()) {
        let [n1, n2, n3] = stage.objective.solver().problem().scene.mesh;
        let report = &stage.report;
        text += &format!(
            "stage {n1}x{n2}x{n3}: {:.6e} -> {:.6e} in {} evaluations, {:.1} s; {}\n",
            report.start_value, report.value, report.counts.evaluations, report.seconds, report.termination
        );
    }
    if finished.len() < asked {
        text += &format!("stages:      {} of {asked} begun\n", finished.len());
    }
    text
}

/// The JSON of a run: its last stage, and a line for every stage.
pub fn summary<'a>(finished: &'a [Finished], shapes: &[SolvedShape; 2]) -> Option<impl Serialize + use<'a>> {
    let Finished { report, objective, replayed, .. } = finished.last()?;
    let active = |multipliers: &Vector| multipliers.iter().filter(|multiplier| **multiplier != 0.0).count();
    Some(Optimized {
        objective_start: shapes[0].value,
        objective: report.value,
        controls: report.solution.as_slice(),
        evaluations: report.counts.evaluations,
        serious_steps: report.counts.serious,
        null_steps: report.counts.null,
        termination: ending(report),
        certificate: report.certificate.as_ref().map(|certificate| Summary {
            aggregate_norm: certificate.aggregate_norm,
            aggregate_error: certificate.aggregate_error,
            predicted_decrease: certificate.predicted_decrease,
            active_cuts: certificate.active_cuts().count(),
            active_radius: certificate.active_radius,
            active_rows: active(&certificate.row_multipliers),
            active_bounds: active(&certificate.bound_multipliers),
            noise: certificate.noise,
        }),
        largest_constraint_violation: report.largest_violation,
        history: report.history.iter().map(|record| record.value).collect(),
        seconds: report.seconds,
        resumed_evaluations: *replayed,
        peak_pressure: shapes.each_ref().map(|shape| shape.peak_pressure),
        residuals: shapes.each_ref().map(|shape| shape.state.forces.residuals),
        kinks: shapes.each_ref().map(|shape| shape.state.forces.kink),
        stages: stage_summaries(finished),
        warnings: &report.warnings,
        left_out: objective.solver().left_out(),
    })
}

/// The one-page report.
pub fn page(finished: &Finished, shapes: &[SolvedShape; 2]) -> String {
    let Finished { report, objective, .. } = finished;
    let at_solution = &shapes[1].state.forces;
    let scene = &objective.solver().problem().scene;
    let bodies = if scene.upper.is_some() { "2 bodies" } else { "1 body" };
    format!(
        "{}: {} of {}x{}x{} bricks, {}x{}x{} subdomains each, friction {}\n\
         reduction:   {:.4} times, peak pressure {:.1} -> {:.1} MPa\n{report}\
         state:       relative residuals at the solution: {}\n\
         \x20            nearest kink: relative margin {:.1e}, {} nodes weakly active\n\
         active:      {}\n\
         left out:    {}\n",
        scene.name,
        bodies,
        scene.mesh[0],
        scene.mesh[1],
        scene.mesh[2],
        scene.subdomains[0],
        scene.subdomains[1],
        scene.subdomains[2],
        scene.friction,
        shapes[0].value / report.value,
        shapes[0].peak_pressure,
        shapes[1].peak_pressure,
        at_solution.residuals,
        at_solution.kink.smallest_margin,
        at_solution.kink.weakly_active,
        active_constraints(objective, &report.solution),
        objective.solver().left_out().join("; "),
    )
}

/// Constraints of the shape that are attained, in words.
pub fn active_constraints(objective: &ContactObjective, controls: &Vector) -> String {
    /// As many as a line holds.
    const MOST: usize = 3;
    let active = objective.solver().problem().admissible.active(controls);
    match active.len() {
        0 => "no constraint of the shape".into(),
        count if count > MOST => format!("{}; {} more", active[..MOST].join("; "), count - MOST),
        _ => active.join("; "),
    }
}

/// The evaluations as a table.
pub fn history_table(report: &Report) -> String {
    let mut table =
        String::from("evaluation,kind,value,center_value,predicted_decrease,aggregate_norm,aggregate_error,seconds\n");
    for record in &report.history {
        let value = record.value.map_or_else(String::new, |value| value.to_string());
        table += &format!(
            "{},{},{value},{},{},{},{},{}\n",
            record.evaluation,
            record.kind,
            record.center_value,
            record.predicted_decrease,
            record.aggregate_norm,
            record.aggregate_error,
            record.seconds
        );
    }
    table
}
