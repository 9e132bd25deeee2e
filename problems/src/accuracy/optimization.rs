//! Θ(best) − Θ* against evaluations and seconds: always tight, accuracy on demand, coarse to fine; pressure norms against the
//! true peak pressure.

use crate::accuracy::extent::Extent;
use crate::accuracy::objective::{Method, Objective, norm};
use crate::cli::{Failure, first_step, mean_height_coordinates};
use crate::cost::PressureMeasure;
use crate::scaling::SceneName;
use nonsmooth::{Accuracy, AccuracyPolicy, BundleTrust, BundleTrustConfig, Cost, Reparametrized, StateSolver, Vector};
use serde::Serialize;
use std::time::Instant;

/// The course of one strategy on the finest mesh.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Course {
    /// The strategy.
    pub strategy: &'static str,
    /// Per evaluation on the finest mesh: evaluations on all meshes so far, seconds since the start, best Θ so far.
    pub points: Vec<(usize, f64, f64)>,
    /// Evaluations on the finest mesh.
    pub evaluations: usize,
    /// Evaluations on coarser meshes.
    pub coarse_evaluations: usize,
    /// Seconds, coarser meshes included.
    pub seconds: f64,
    /// Θ at the end, to the tightest accuracy.
    pub value: f64,
    /// First evaluation (all meshes) and second at which (Θ(best) − Θ*)/Θ* is at most [`TARGETS`].
    pub reached: [Option<(usize, f64)>; TARGETS.len()],
}

/// One measure of pressure as the objective.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PeakRow {
    /// The measure.
    pub measure: String,
    /// Evaluations.
    pub evaluations: usize,
    /// Seconds.
    pub seconds: f64,
    /// Peak pressure at the end, MPa.
    pub peak: f64,
    /// Σσ⁴ at the end.
    pub norm: f64,
}

/// All courses on one scene.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct OptimizationStudy {
    /// The scene.
    pub scene: SceneName,
    /// The meshes, coarse to fine.
    pub levels: Vec<usize>,
    /// Σσ⁴ at the start.
    pub start: f64,
    /// Lowest Σσ⁴ of all strategies, Θ*.
    pub lowest: f64,
    /// The strategies.
    pub courses: Vec<Course>,
    /// Mesh of the measures of pressure.
    pub peak_mesh: usize,
    /// Measures of pressure; the first row is the start.
    pub peaks: Vec<PeakRow>,
}

/// Relative distances from Θ* whose price is reported.
pub const TARGETS: [f64; 3] = [1.0, 0.1, 0.02];

/// One run on one mesh.
struct Run {
    controls: Vector,
    /// (seconds, value at the center) per evaluation.
    history: Vec<(f64, f64)>,
    seconds: f64,
}

/// Runs all strategies on the levels of `extent`.
///
/// # Errors
/// [`Failure`] from a scene, a solver or the optimizer.
pub fn study(scene: SceneName, extent: Extent) -> Result<OptimizationStudy, Failure> {
    let levels = extent.levels();
    let fine = levels[levels.len() - 1];
    let evaluations = extent.evaluations();
    let objective = Method::DESCENT.objective(scene, fine, norm())?;
    let start = objective.solver().start();
    // The first solve pays for what is kept from solve to solve.
    let before = value(&objective, &start)?;
    let mut courses = Vec::new();
    for (strategy, policy) in
        [("always tight", AccuracyPolicy::Tightest), ("accuracy on demand", AccuracyPolicy::ON_DEMAND)]
    {
        let run = minimize(&objective, start.clone(), policy, evaluations)?;
        courses.push(course(strategy, &objective, &run, 0, 0.0)?);
    }
    let clock = Instant::now();
    let (mut controls, mut coarse) = (start.clone(), 0);
    for &level in &levels[..levels.len() - 1] {
        let objective = Method::DESCENT.objective(scene, level, norm())?;
        let run = minimize(&objective, controls, AccuracyPolicy::ON_DEMAND, evaluations)?;
        coarse += run.history.len();
        controls = run.controls;
    }
    let passed = clock.elapsed().as_secs_f64();
    let run = minimize(&objective, controls, AccuracyPolicy::ON_DEMAND, evaluations)?;
    courses.push(course("coarse to fine, on demand", &objective, &run, coarse, passed)?);
    let lowest = courses.iter().map(|course| course.value).fold(f64::INFINITY, f64::min);
    for course in &mut courses {
        course.reached = TARGETS.map(|target| {
            let point = course.points.iter().find(|point| point.2 <= (1.0 + target) * lowest);
            point.map(|point| (point.0, point.1))
        });
    }
    let peak_mesh = levels[1.min(levels.len() - 1)];
    let peaks = peaks(scene, peak_mesh, evaluations)?;
    Ok(OptimizationStudy { scene, levels: levels.to_vec(), start: before, lowest, courses, peak_mesh, peaks })
}

fn value(objective: &Objective, control: &Vector) -> Result<f64, Failure> {
    let state = objective.solver().solve(control, None, Accuracy::TIGHTEST)?;
    Ok(objective.cost().value(control, &state))
}

fn peak(objective: &Objective, control: &Vector) -> Result<f64, Failure> {
    let state = objective.solver().solve(control, None, Accuracy::TIGHTEST)?;
    Ok(objective.cost().pressures(&state).into_iter().fold(f64::NEG_INFINITY, f64::max))
}

/// As the command `optimize` does it, with a policy of accuracy.
fn minimize(
    objective: &Objective,
    start: Vector,
    accuracy: AccuracyPolicy,
    max_evaluations: usize,
) -> Result<Run, Failure> {
    let clock = Instant::now();
    let first_step = first_step(objective, &start);
    let config =
        BundleTrustConfig { max_evaluations, accuracy, first_step: Some(first_step), ..BundleTrustConfig::default() };
    let scaled = Reparametrized::new(objective, mean_height_coordinates(&start, first_step))?;
    let set = objective.solver().problem().admissible.polyhedron();
    let report = BundleTrust::new(config)?
        .constraints(scaled.transformed_set(set)?)
        .minimize(&scaled, scaled.transformed(&start))?;
    Ok(Run {
        controls: scaled.original(&report.solution),
        history: report.history.iter().map(|record| (record.seconds, record.center_value)).collect(),
        seconds: clock.elapsed().as_secs_f64(),
    })
}

fn course(
    strategy: &'static str,
    objective: &Objective,
    run: &Run,
    coarse_evaluations: usize,
    passed: f64,
) -> Result<Course, Failure> {
    let mut best = f64::INFINITY;
    let points = run.history.iter().enumerate().map(|(index, &(seconds, value))| {
        best = best.min(value);
        (coarse_evaluations + index + 1, passed + seconds, best)
    });
    Ok(Course {
        strategy,
        points: points.collect(),
        evaluations: run.history.len(),
        coarse_evaluations,
        seconds: passed + run.seconds,
        value: value(objective, &run.controls)?,
        reached: [None; TARGETS.len()],
    })
}

/// Norms of several exponents and the peak pressure itself, each with the same number of evaluations.
fn peaks(scene: SceneName, mesh: usize, evaluations: usize) -> Result<Vec<PeakRow>, Failure> {
    let judge = Method::DESCENT.objective(scene, mesh, norm())?;
    let row = |measure: String, evaluations: usize, seconds: f64, controls: &Vector| -> Result<PeakRow, Failure> {
        let (peak, norm) = (peak(&judge, controls)?, value(&judge, controls)?);
        Ok(PeakRow { measure, evaluations, seconds, peak, norm })
    };
    let norms = [4.0, 8.0, 16.0].map(|exponent| (format!("Σσ^{exponent}"), PressureMeasure::Norm { exponent }));
    let mut rows = vec![row("nothing (start)".into(), 0, 0.0, &judge.solver().start())?];
    for (measure, kind) in norms.into_iter().chain([("max σ".to_owned(), PressureMeasure::Peak)]) {
        let objective = Method::DESCENT.objective(scene, mesh, kind)?;
        let run = minimize(&objective, objective.solver().start(), AccuracyPolicy::Tightest, evaluations)?;
        rows.push(row(measure, run.history.len(), run.seconds, &run.controls)?);
    }
    Ok(rows)
}
