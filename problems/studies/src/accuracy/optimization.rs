//! Θ(best) − Θ* against evaluations and products: always tight, accuracy on demand, coarse to fine.
//!
//! Work is counted in products with the dual operator of the finest mesh: one on a coarser mesh counts as its share of
//! dofs. It leaves out factorisations, one set per evaluation.

use crate::accuracy::objective::{case, objective_of};
use crate::markdown::{or_dash, seconds, section};
use crate::scaling::{SceneName, option_name};
use nonsmooth::{AccuracyPolicy, BundleTrust, BundleTrustConfig, VariableScaling, Vector};
use problems::commands::{ContactObjective, Failure, SolvedShape};
use serde::Serialize;
use std::time::Instant;

/// What a course has come to.
#[derive(Debug, Clone, Copy, Serialize)]
pub struct Milestone {
    /// Evaluations on all meshes so far.
    evaluations: usize,
    /// Products with the dual operator of the finest mesh, or what they are worth.
    pub work: f64,
    /// Best Θ so far.
    pub best: f64,
}

/// The course of one strategy on the finest mesh.
#[derive(Debug, Serialize)]
pub struct Course {
    pub strategy: &'static str,
    /// One milestone per evaluation on the finest mesh.
    pub points: Vec<Milestone>,
    /// Evaluations on coarser meshes.
    coarse_evaluations: usize,
    /// Seconds, coarser meshes included.
    seconds: f64,
    /// Θ at the end, to the tightest accuracy.
    value: f64,
}

/// All courses on one scene.
#[derive(Debug, Serialize)]
pub struct OptimizationStudy {
    pub scene: SceneName,
    /// The finest mesh.
    pub fine: usize,
    /// Σσ⁴ at the start.
    start: f64,
    /// Lowest Σσ⁴ of all strategies, Θ*.
    pub lowest: f64,
    /// Course of each strategy.
    pub courses: Vec<Course>,
}

/// Relative distances from Θ* whose price is reported.
const TARGETS: [f64; 3] = [1.0, 0.1, 0.02];

/// One run on one mesh.
struct StrategyRun {
    controls: Vector,
    /// One milestone per evaluation of this run.
    points: Vec<Milestone>,
    seconds: f64,
}

impl OptimizationStudy {
    /// Runs all strategies on some meshes, coarse to fine, with so many evaluations on each.
    pub fn new(scene: SceneName, levels: &[usize], evaluations: usize) -> Result<Self, Failure> {
        let fine = levels[levels.len() - 1];
        let objective = objective_of(scene, fine)?;
        let first = objective.solver().start();
        let start = SolvedShape::at(&objective, &first)?.value;
        let mut courses = Vec::new();
        for (strategy, policy) in
            [("always tight", AccuracyPolicy::Tightest), ("accuracy on demand", AccuracyPolicy::ON_DEMAND)]
        {
            courses.push(course(strategy, &objective, minimize(&objective, first.clone(), policy, evaluations)?, 0)?);
        }
        courses.push(coarse_to_fine(scene, levels, &objective, evaluations)?);
        let lowest = courses.iter().map(|course| course.value).fold(f64::INFINITY, f64::min);
        Ok(Self { scene, fine, start, lowest, courses })
    }

    /// The table of strategies.
    pub fn markdown(&self) -> String {
        let Self { fine, start, lowest, .. } = self;
        let courses = self.courses.iter().map(|course| {
            let evaluations = format!("{} + {}", course.points.len(), course.coarse_evaluations);
            let mut cells = vec![course.strategy.to_owned(), evaluations, seconds(course.seconds)];
            cells.extend(TARGETS.map(|target| {
                let reached = course.points.iter().find(|point| point.best <= (1.0 + target) * lowest);
                or_dash(reached, |point| format!("{}, {:.0}", point.evaluations, point.work))
            }));
            cells.push(format!("{:.5e}", course.value));
            cells
        });
        let targets = TARGETS.map(|target| format!("to {:.0} %: evaluations, products", 100.0 * target));
        let head = format!("strategy | evaluations fine + coarse | seconds | {} | Θ at the end", targets.join(" | "));
        let scene = option_name(&self.scene);
        section(&format!("{scene}, {fine}³ bricks: distance from the minimum"), &head, courses)
            + &format!("\nΘ at the start {start:.5e}; Θ* = {lowest:.5e} is the lowest of these runs.\n")
    }
}

/// The course on the finest mesh from the end of the courses on the coarser ones, one after the other.
fn coarse_to_fine(
    scene: SceneName,
    levels: &[usize],
    objective: &ContactObjective,
    evaluations: usize,
) -> Result<Course, Failure> {
    let (mut controls, mut passed, mut seconds) = (objective.solver().start(), (0, 0.0), 0.0);
    let (fine, coarser) = levels.split_last().map_or((0, levels), |(fine, coarser)| (*fine, coarser));
    for &level in coarser {
        let run = minimize(&objective_of(scene, level)?, controls, AccuracyPolicy::ON_DEMAND, evaluations)?;
        let share = case(level).torn_dofs() as f64 / case(fine).torn_dofs() as f64;
        passed.0 += run.points.len();
        passed.1 += share * run.points.last().map_or(0.0, |point| point.work);
        seconds += run.seconds;
        controls = run.controls;
    }
    let mut run = minimize(objective, controls, AccuracyPolicy::ON_DEMAND, evaluations)?;
    run.seconds += seconds;
    for point in &mut run.points {
        point.evaluations += passed.0;
        point.work += passed.1;
    }
    course("coarse to fine, on demand", objective, run, passed.0)
}

fn course(
    strategy: &'static str,
    objective: &ContactObjective,
    run: StrategyRun,
    coarse_evaluations: usize,
) -> Result<Course, Failure> {
    let value = SolvedShape::at(objective, &run.controls)?.value;
    Ok(Course { strategy, points: run.points, coarse_evaluations, seconds: run.seconds, value })
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
    let points = report.history.iter().enumerate().map(|(index, record)| {
        best = best.min(record.center_value);
        work += record.work as f64;
        Milestone { evaluations: index + 1, work, best }
    });
    let points = points.collect();
    Ok(StrategyRun { controls: report.solution, points, seconds: clock.elapsed().as_secs_f64() })
}
