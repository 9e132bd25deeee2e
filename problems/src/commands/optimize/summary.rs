//! The report of an optimization as text and as JSON.

use crate::commands::arguments::Arguments;
use crate::commands::contact_objective::{SolvedShape, solver_in_words};
use crate::commands::optimize::mesh_run::MeshRun;
use crate::commands::optimize::stages::Part;
use crate::commands::output::pressure;
use crate::commands::processes::Usage;
use contact::contact_shape::SolverKind;
use contact::cost::ContactAreas;
use contact::equilibrium::{Kink, Residuals};
use contact::plausibility::Warning;
use nonsmooth::{IterationRecord, Origin, Report, StepKind, Termination, Vector};
use serde::Serialize;

/// The keys of the JSON of `optimize`.
#[derive(Debug, Serialize)]
struct OptimizationJson<'a> {
    objective_start: f64,
    objective: f64,
    /// p where all values of the objective are the p-th root of a pressure norm, since the norm may be no double; else 1.
    objective_root: f64,
    controls: &'a [f64],
    evaluations: usize,
    /// Contact problems solved at trial points, failed ones included.
    states: usize,
    /// Jacobians of all pressures.
    jacobians: usize,
    serious_steps: usize,
    null_steps: usize,
    termination: Ending<'a>,
    certificate: Option<CertificateJson>,
    largest_constraint_violation: f64,
    /// One entry per evaluation.
    course: Vec<CourseJson<'a>>,
    seconds: f64,
    /// Number of evaluations of an earlier part of the run, which were answered from its journal.
    resumed_evaluations: usize,
    peak_pressure: [f64; 2],
    /// Contact areas at the start and at the end, where the open area is the objective.
    #[serde(skip_serializing_if = "Option::is_none")]
    contact_areas: Option<[ContactAreas; 2]>,
    /// Certificates of the contact states at the start and at the end.
    residuals: [Residuals; 2],
    /// Distances of these states to the nearest kink.
    kinks: [Kink; 2],
    /// Number of different values of Θ at confirmed ends, of an optimization from several starts.
    #[serde(skip_serializing_if = "Option::is_none")]
    optima: Option<usize>,
    /// One entry per mesh of a coarse-to-fine optimization, or per start.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    stages: Vec<MeshRunJson<'a>>,
    /// The solver of the final state.
    solver: SolverKind,
    /// Why that solver, where another would have been the first choice.
    solver_reason: Option<&'a str>,
    /// Those of the optimizer have the code `optimizer`, the others look at the final state.
    warnings: Vec<Warning>,
    left_out: Vec<&'static str>,
    #[serde(skip_serializing_if = "Option::is_none")]
    processes: Option<Usage>,
}

/// One evaluation.
#[derive(Debug, Serialize)]
struct CourseJson<'a> {
    evaluation: usize,
    /// None if the evaluation failed.
    objective: Option<f64>,
    kind: StepKind,
    /// Who proposed the point.
    origin: Origin,
    /// Whether the Jacobian of all pressures was computed.
    jacobian: bool,
    /// Products with the dual operator.
    products: usize,
    /// Seconds since the start.
    seconds: f64,
    #[serde(skip_serializing_if = "Option::is_none")]
    note: Option<&'a str>,
}

fn course(record: &IterationRecord) -> CourseJson<'_> {
    CourseJson {
        evaluation: record.evaluation,
        objective: record.value,
        kind: record.kind,
        origin: record.origin,
        jacobian: record.jacobian,
        products: record.work,
        seconds: record.seconds,
        note: record.note.as_deref().or(record.failure.as_deref()),
    }
}

/// How a run ended.
#[derive(Debug, Serialize)]
pub struct Ending<'a> {
    reason: &'a Termination,
    text: String,
    confirmed: bool,
}

/// The certificate without its cuts, which go to a file.
#[derive(Debug, Serialize)]
struct CertificateJson {
    aggregate_norm: f64,
    aggregate_error: f64,
    predicted_decrease: f64,
    active_cuts: usize,
    active_radius: f64,
    active_rows: usize,
    active_bounds: usize,
    noise: f64,
}

/// One of several runs: a mesh of a coarse-to-fine optimization, or a start.
#[derive(Debug, Serialize)]
struct MeshRunJson<'a> {
    mesh: [usize; 3],
    objective_start: f64,
    objective: f64,
    evaluations: usize,
    seconds: f64,
    termination: Ending<'a>,
}

fn stages(runs: &[MeshRun]) -> Vec<MeshRunJson<'_>> {
    runs.iter()
        .filter(|run| run.part != Part::Whole)
        .map(|run| MeshRunJson {
            mesh: run.objective.solver().problem().scene.mesh,
            objective_start: run.report.start_value,
            objective: run.report.value,
            evaluations: run.report.counts.evaluations,
            seconds: run.report.seconds,
            termination: ending(&run.report),
        })
        .collect()
}

/// How a run ended.
pub fn ending(report: &Report) -> Ending<'_> {
    let termination = &report.termination;
    Ending { reason: termination, text: termination.to_string(), confirmed: termination.is_confirmed() }
}

/// Difference of Θ beyond which two ends are two optima, relative to Θ where it lies between the next constant and 1 times the largest
/// decrease of a run, else to this bound. A Θ that falls to zero, or that carries a constant, has the decrease alone as its scale.
const SAME_OPTIMUM: f64 = 1e-5;
/// Least scale of Θ in largest decreases.
const LEAST_SCALE: f64 = 1e-3;
/// Relative rounding of Θ.
const ROUNDING: f64 = 1e-12;

/// Number of different values of Θ at confirmed ends.
fn optima(runs: &[MeshRun]) -> usize {
    let decrease = runs.iter().map(|run| run.report.start_value - run.report.value).fold(0.0, f64::max);
    let confirmed = runs.iter().filter(|run| run.report.termination.is_confirmed());
    different(confirmed.map(|run| run.report.value).collect(), decrease)
}

/// Number of values that differ by more than runs with this largest decrease resolve.
fn different(mut values: Vec<f64>, decrease: f64) -> usize {
    values.sort_by(f64::total_cmp);
    values.dedup_by(|b, a| {
        let scale = a.abs().clamp(LEAST_SCALE * decrease, decrease);
        (*b - *a).abs() <= SAME_OPTIMUM * scale + ROUNDING * a.abs()
    });
    values.len()
}

/// One line per mesh or start; nothing for a single run.
pub fn stages_page(runs: &[MeshRun], meshes: usize) -> String {
    let mut text = String::new();
    for run in runs.iter().filter(|run| run.part != Part::Whole) {
        let [n1, n2, n3] = run.objective.solver().problem().scene.mesh;
        let report = &run.report;
        text += &format!(
            "{} on {n1}x{n2}x{n3}: {:.6e} -> {:.6e} in {} evaluations, {:.1} s; {}\n",
            run.part.folder().unwrap_or_default().replace('_', " "),
            report.start_value,
            report.value,
            report.counts.evaluations,
            report.seconds,
            report.termination
        );
    }
    if runs.iter().any(|run| matches!(run.part, Part::Start(_))) {
        text += &format!("optima:      {} different values at confirmed ends\n", optima(runs));
    }
    if runs.len() < meshes {
        text += &format!("stages:      {} of {meshes} begun\n", runs.len());
    }
    text
}

/// The JSON of an optimization: the run `last` that it is reported by, and an entry for every run if there are several.
pub fn summary<'a>(
    last: &'a MeshRun,
    runs: &'a [MeshRun],
    shapes: &'a [SolvedShape; 2],
    checks: &[Warning],
    arguments: &Arguments,
    processes: Option<Usage>,
) -> impl Serialize + use<'a> {
    let MeshRun { report, objective, replayed, .. } = last;
    let active = |multipliers: &Vector| multipliers.iter().filter(|multiplier| **multiplier != 0.0).count();
    OptimizationJson {
        objective_start: shapes[0].value,
        objective: report.value,
        objective_root: objective.root(),
        controls: report.solution.as_slice(),
        evaluations: report.counts.evaluations,
        states: report.counts.evaluations,
        jacobians: report.counts.jacobians,
        serious_steps: report.counts.serious,
        null_steps: report.counts.null,
        termination: ending(report),
        certificate: report.certificate.as_ref().map(|certificate| CertificateJson {
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
        course: report.history.iter().map(course).collect(),
        seconds: report.seconds,
        resumed_evaluations: *replayed,
        peak_pressure: shapes.each_ref().map(|shape| shape.peak_pressure),
        contact_areas: contact_areas(last, shapes),
        residuals: shapes.each_ref().map(|shape| shape.state.forces.residuals),
        kinks: shapes.each_ref().map(|shape| shape.state.forces.kink),
        optima: (runs.iter().filter(|run| run.part != Part::Whole).count() > 1).then(|| optima(runs)),
        stages: stages(runs),
        solver: shapes[1].state.solver,
        solver_reason: shapes[1].state.reason.as_deref(),
        warnings: all_warnings(report, checks),
        left_out: arguments.left_out(objective.solver()),
        processes,
    }
}

/// The contact areas of both shapes, where the open area is the objective.
fn contact_areas(last: &MeshRun, shapes: &[SolvedShape; 2]) -> Option<[ContactAreas; 2]> {
    let [first, second] = shapes.each_ref().map(|shape| last.objective.contact_areas(&shape.state));
    first.zip(second).map(|(first, second)| [first, second])
}

/// The warnings of the optimizer and those about the final state.
pub fn all_warnings(report: &Report, checks: &[Warning]) -> Vec<Warning> {
    let own = report.warnings.iter().map(|text| Warning { code: "optimizer", text: text.clone() });
    own.chain(checks.iter().cloned()).collect()
}

/// Reduction of Θ from which on what is left of it is rounding.
const MEANINGLESS_REDUCTION: f64 = 1e12;

/// Θ at the start over Θ at the end; none where that says nothing: a compliance may change its sign, and a deviation may vanish up to
/// rounding.
pub fn reduction(start: f64, end: f64) -> Option<f64> {
    Some(start / end).filter(|ratio| *ratio > 0.0 && *ratio < MEANINGLESS_REDUCTION)
}

/// The one-page report.
pub fn page(last: &MeshRun, shapes: &[SolvedShape; 2], checks: &[Warning], arguments: &Arguments) -> String {
    let MeshRun { report, objective, .. } = last;
    let at_solution = &shapes[1].state.forces;
    let scene = &objective.solver().problem().scene;
    let bodies = if scene.upper.is_some() { "2 bodies" } else { "1 body" };
    let ratio = reduction(shapes[0].value, report.value);
    let reduction = ratio.map_or_else(|| "no ratio".into(), |ratio| format!("{ratio:.4} times"));
    let areas = contact_areas(last, shapes).map_or_else(String::new, |[start, end]| {
        format!("contact:     at the start {start}\n             at the end   {end}\n")
    });
    format!(
        "{}: {} of {}x{}x{} bricks, {}x{}x{} subdomains each, friction {}; objective in {}\n\
         reduction:   {reduction}, peak pressure {} -> {} MPa\n{areas}{report}\
         state:       relative residuals at the solution: {}\n\
         \x20            nearest kink: relative margin {:.1e}, {} nodes weakly active\n\
         solver:      {}\n\
         active:      {}\n\
         {}left out:    {}\n",
        scene.name,
        bodies,
        scene.mesh[0],
        scene.mesh[1],
        scene.mesh[2],
        scene.subdomains[0],
        scene.subdomains[1],
        scene.subdomains[2],
        scene.friction,
        objective.unit().replace(['{', '}'], ""),
        pressure(shapes[0].peak_pressure),
        pressure(shapes[1].peak_pressure),
        at_solution.residuals,
        at_solution.kink.smallest_margin,
        at_solution.kink.weakly_active,
        solver_in_words(shapes[1].state.solver, shapes[1].state.reason.as_deref()),
        last.active_constraints(),
        checks.iter().map(|warning| format!("warning:     {warning}\n")).collect::<String>(),
        arguments.left_out(objective.solver()).join("; "),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn optima_are_told_apart_on_the_scale_of_their_decrease() {
        for (values, decrease, expected) in [
            (vec![1.0, 1.0 + 1e-7, 1.1], 10.0, 2),
            // Deviations that vanish up to rounding.
            (vec![1e-14, 3e-12, 0.0], 1.0, 1),
            (vec![0.0, 1e-4], 1.0, 2),
            // Two ends that a large constant would hide.
            (vec![1e6, 1e6 + 0.5], 1.0, 2),
            (vec![-1e-9, 1e-9], 5.0, 1),
            // Nothing can be gained, and values are equal up to rounding.
            (vec![7.0, 7.0 * (1.0 + 1e-15)], 0.0, 1),
            (vec![], 0.0, 0),
        ] {
            for unit in [1e-20, 1.0, 1e20] {
                let scaled = values.iter().map(|value| unit * value).collect();
                assert_eq!(different(scaled, unit * decrease), expected, "{values:?} in units of {unit:e}");
            }
        }
    }
}
