//! Θ(best) − Θ* against evaluations and seconds: always tight, accuracy on demand, coarse to fine; pressure norms
//! against the true peak pressure.
//!
//! Work is counted in products with the dual operator of the finest mesh: one on a coarser mesh counts as its share of
//! dofs. It leaves out factorisations, one set per evaluation.

use crate::accuracy::extent::{Extent, case};
use crate::accuracy::objective::{norm, objective_of};
use crate::scaling::SceneName;
use contact::cost::{NodeWeight, PressureMeasure};
use nonsmooth::{AccuracyPolicy, BundleTrust, BundleTrustConfig, VariableScaling, Vector};
use problems::commands::{ContactObjective, Failure, SolvedShape};
use serde::Serialize;
use std::time::Instant;

/// What a course has come to.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Milestone {
    /// Evaluations on all meshes so far.
    pub evaluations: usize,
    /// Products with the dual operator of the finest mesh, or what they are worth.
    pub work: f64,
    /// Seconds since the start.
    pub seconds: f64,
    /// Best Θ so far.
    pub best: f64,
}

/// The course of one strategy on the finest mesh.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Course {
    pub strategy: &'static str,
    /// One milestone per evaluation on the finest mesh.
    pub points: Vec<Milestone>,
    /// Evaluations on the finest mesh.
    pub evaluations: usize,
    /// Evaluations on coarser meshes.
    pub coarse_evaluations: usize,
    /// Seconds, coarser meshes included.
    pub seconds: f64,
    /// Θ at the end, to the tightest accuracy.
    pub value: f64,
    /// First milestone at which (Θ(best) − Θ*)/Θ* is at most 1, 0.1 and 0.02.
    pub reached: [Option<Milestone>; TARGETS.len()],
}

/// One measure of pressure as the objective.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PeakRow {
    /// Name of the measure that is minimised.
    pub measure: String,
    /// Number of evaluations of Θ.
    pub evaluations: usize,
    /// Wall-clock seconds of the optimization.
    pub seconds: f64,
    /// Peak pressure at the end, MPa.
    pub peak: f64,
    /// Σσ⁴ at the end.
    pub norm: f64,
}

/// All courses on one scene.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct OptimizationStudy {
    pub scene: SceneName,
    /// The meshes, coarse to fine.
    pub levels: Vec<usize>,
    /// Σσ⁴ at the start.
    pub start: f64,
    /// Lowest Σσ⁴ of all strategies, Θ*.
    pub lowest: f64,
    /// Course of each strategy.
    pub courses: Vec<Course>,
    /// Mesh of the measures of pressure.
    pub peak_mesh: usize,
    /// Measures of pressure; the first row is the start.
    pub peaks: Vec<PeakRow>,
}

/// Relative distances from Θ* whose price is reported.
pub const TARGETS: [f64; 3] = [1.0, 0.1, 0.02];

/// One run on one mesh.
struct StrategyRun {
    controls: Vector,
    /// One milestone per evaluation of this run.
    history: Vec<Milestone>,
    seconds: f64,
}

/// Runs all strategies on the levels of `extent`.
pub fn study(scene: SceneName, extent: Extent) -> Result<OptimizationStudy, Failure> {
    let levels = extent.levels;
    let fine = levels[levels.len() - 1];
    let evaluations = extent.evaluations;
    let objective = objective_of(scene, fine, norm())?;
    let start = objective.solver().start();
    // The first solve pays for what is kept from solve to solve.
    let before = SolvedShape::at(&objective, &start)?.value;
    let mut courses = Vec::new();
    for (strategy, policy) in
        [("always tight", AccuracyPolicy::Tightest), ("accuracy on demand", AccuracyPolicy::ON_DEMAND)]
    {
        let run = minimize(&objective, start.clone(), policy, evaluations)?;
        courses.push(course(strategy, &objective, &run, Milestone::START)?);
    }
    let clock = Instant::now();
    let (mut controls, mut passed) = (start.clone(), Milestone::START);
    for &level in &levels[..levels.len() - 1] {
        let objective = objective_of(scene, level, norm())?;
        let run = minimize(&objective, controls, AccuracyPolicy::ON_DEMAND, evaluations)?;
        let products = run.history.last().map_or(0.0, |milestone| milestone.work);
        passed.evaluations += run.history.len();
        passed.work += products * torn_dofs(level) / torn_dofs(fine);
        controls = run.controls;
    }
    passed.seconds = clock.elapsed().as_secs_f64();
    let run = minimize(&objective, controls, AccuracyPolicy::ON_DEMAND, evaluations)?;
    courses.push(course("coarse to fine, on demand", &objective, &run, passed)?);
    let lowest = courses.iter().map(|course| course.value).fold(f64::INFINITY, f64::min);
    for course in &mut courses {
        course.reached =
            TARGETS.map(|target| course.points.iter().find(|point| point.best <= (1.0 + target) * lowest).copied());
    }
    let peak_mesh = levels[1.min(levels.len() - 1)];
    let peaks = peaks(scene, peak_mesh, evaluations)?;
    Ok(OptimizationStudy { scene, levels: levels.to_vec(), start: before, lowest, courses, peak_mesh, peaks })
}

impl Milestone {
    const START: Self = Self { evaluations: 0, work: 0.0, seconds: 0.0, best: f64::INFINITY };
}

/// Torn dofs per body, the size of a product with the dual operator.
fn torn_dofs(mesh: usize) -> f64 {
    let case = case(mesh);
    (3 * case.subdomains.pow(3) * (case.ratio() + 1).pow(3)) as f64
}

/// As the command `optimize` with `--optimizer bundle` does it, but with a given policy of accuracy.
fn minimize(
    objective: &ContactObjective,
    start: Vector,
    accuracy: AccuracyPolicy,
    max_evaluations: usize,
) -> Result<StrategyRun, Failure> {
    let clock = Instant::now();
    let first_step = objective.first_step(&start);
    let config = BundleTrustConfig {
        max_evaluations,
        accuracy,
        composite_model: false,
        first_step: Some(first_step),
        scaling: VariableScaling::Linear(objective.coordinates(&start, first_step)),
        ..BundleTrustConfig::default()
    };
    let set = objective.solver().problem().admissible.polyhedron().clone();
    let report = BundleTrust::new(config)?.constraints(set).minimize(objective, start)?;
    let (mut best, mut work) = (f64::INFINITY, 0.0);
    let milestones = report.history.iter().enumerate().map(|(index, record)| {
        best = best.min(record.center_value);
        work += record.work as f64;
        Milestone { evaluations: index + 1, work, seconds: record.seconds, best }
    });
    Ok(StrategyRun { controls: report.solution, history: milestones.collect(), seconds: clock.elapsed().as_secs_f64() })
}

fn course(
    strategy: &'static str,
    objective: &ContactObjective,
    run: &StrategyRun,
    passed: Milestone,
) -> Result<Course, Failure> {
    let points = run.history.iter().map(|point| Milestone {
        evaluations: passed.evaluations + point.evaluations,
        work: passed.work + point.work,
        seconds: passed.seconds + point.seconds,
        best: point.best,
    });
    Ok(Course {
        strategy,
        points: points.collect(),
        evaluations: run.history.len(),
        coarse_evaluations: passed.evaluations,
        seconds: passed.seconds + run.seconds,
        value: SolvedShape::at(objective, &run.controls)?.value,
        reached: [None; TARGETS.len()],
    })
}

/// Norms of several exponents and the peak pressure itself, each with the same number of evaluations.
fn peaks(scene: SceneName, mesh: usize, evaluations: usize) -> Result<Vec<PeakRow>, Failure> {
    let reference = objective_of(scene, mesh, norm())?;
    let row = |measure: String, evaluations: usize, seconds: f64, controls: &Vector| -> Result<PeakRow, Failure> {
        let SolvedShape { value: norm, peak_pressure: peak, .. } = SolvedShape::at(&reference, controls)?;
        Ok(PeakRow { measure, evaluations, seconds, peak, norm })
    };
    let norms = [4.0, 8.0, 16.0]
        .map(|exponent| (format!("Σσ^{exponent}"), PressureMeasure::Norm { exponent, weight: NodeWeight::Nodes }));
    let mut rows = vec![row("nothing (start)".into(), 0, 0.0, &reference.solver().start())?];
    for (measure, kind) in norms.into_iter().chain([("max σ".to_owned(), PressureMeasure::Peak)]) {
        let objective = objective_of(scene, mesh, kind)?;
        let run = minimize(&objective, objective.solver().start(), AccuracyPolicy::Tightest, evaluations)?;
        rows.push(row(measure, run.history.len(), run.seconds, &run.controls)?);
    }
    Ok(rows)
}
