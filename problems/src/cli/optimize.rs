//! `optimize`: the shape of least contact pressure measure.

use crate::cli::output::{self, Folder};
use crate::cli::{Arguments, ContactObjective, Failure, controls, evaluate};
use nonsmooth::{
    Accuracy, BundleTrust, BundleTrustConfig, Matrix, Reparametrized, Report, StateSolver, TablePrinter, Termination,
    Vector,
};
use serde::Serialize;
use std::time::Instant;

/// Evaluations allowed unless the user says otherwise.
const DEFAULT_EVALUATIONS: usize = 150;

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
    peak_pressure: [f64; 2],
    left_out: Vec<&'static str>,
}

#[derive(Debug, Serialize)]
struct Ending<'a> {
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

pub fn run(objective: &ContactObjective, arguments: &Arguments) -> Result<String, Failure> {
    let folder = Folder::prepare(arguments.out.as_deref())?;
    let shape = objective.solver();
    let start = controls::load(shape, arguments.start_controls.as_deref())?;
    let clock = Instant::now();
    let first_step = first_step(objective, &start);
    let config = BundleTrustConfig {
        max_evaluations: arguments.max_evaluations.unwrap_or(DEFAULT_EVALUATIONS),
        first_step: Some(first_step),
        ..BundleTrustConfig::default()
    };
    let scaled = Reparametrized::new(objective, mean_height_coordinates(&start, first_step))?;
    let mut report = BundleTrust::new(config)?
        .constraints(scaled.transformed_set(shape.problem().admissible.polyhedron())?)
        .observer(TablePrinter::new(std::io::stderr()))
        .minimize(&scaled, scaled.transformed(&start))?;
    report.solution = scaled.original(&report.solution);
    let seconds = clock.elapsed().as_secs_f64();
    let initial = shape.solve(&start, None, Accuracy::TIGHTEST)?;
    let optimal = shape.solve(&report.solution, None, Accuracy::TIGHTEST)?;
    let peaks = [&initial, &optimal].map(|state| output::peak_pressure(objective, state));
    let json = output::json(&summary(&report, objective, peaks, seconds))?;
    if let Some(folder) = folder {
        folder.write("report.json", &json)?;
        folder.write("report.txt", &page(&report, objective, peaks))?;
        folder.write("controls.json", &output::json(&report.solution.as_slice())?)?;
        folder.write("certificate.json", &output::json(&report.certificate)?)?;
        folder.write("history.csv", &history_table(&report))?;
        folder.write("pressure_initial.csv", &evaluate::pressure_table(objective, &initial))?;
        folder.write("pressure_optimal.csv", &evaluate::pressure_table(objective, &optimal))?;
        for (name, state) in [("initial", &initial), ("optimal", &optimal)] {
            let title = format!("{}: contact pressure, {name} shape", shape.problem().scene.name);
            let picture = evaluate::pressure_picture(objective, state, &title, peaks[0].max(peaks[1]));
            folder.write(&format!("pressure_{name}.svg"), &picture)?;
        }
    }
    Ok(if arguments.json { json } else { page(&report, objective, peaks) })
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

fn summary<'a>(report: &'a Report, objective: &ContactObjective, peaks: [f64; 2], seconds: f64) -> Optimized<'a> {
    let active = |multipliers: &Vector| multipliers.iter().filter(|multiplier| **multiplier != 0.0).count();
    Optimized {
        objective_start: report.start_value,
        objective: report.value,
        controls: report.solution.as_slice(),
        evaluations: report.counts.evaluations,
        serious_steps: report.counts.serious,
        null_steps: report.counts.null,
        termination: Ending {
            reason: &report.termination,
            text: report.termination.to_string(),
            confirmed: report.termination.is_confirmed(),
        },
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
        seconds,
        peak_pressure: peaks,
        left_out: objective.solver().left_out(),
    }
}

/// The one-page report.
fn page(report: &Report, objective: &ContactObjective, peaks: [f64; 2]) -> String {
    let scene = &objective.solver().problem().scene;
    let bodies = if scene.upper.is_some() { 2 } else { 1 };
    format!(
        "{}: {} bodies of {}x{}x{} bricks, {}x{}x{} subdomains each, friction {}\n\
         reduction:   {:.4} times, peak pressure {:.1} -> {:.1} MPa\n{report}left out:    {}\n",
        scene.name,
        bodies,
        scene.mesh[0],
        scene.mesh[1],
        scene.mesh[2],
        scene.subdomains[0],
        scene.subdomains[1],
        scene.subdomains[2],
        scene.friction,
        report.start_value / report.value,
        peaks[0],
        peaks[1],
        objective.solver().left_out().join("; "),
    )
}

fn history_table(report: &Report) -> String {
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
