//! Measures one case with one solver.

use crate::scaling::cases::{Case, SceneName, Variant};
use crate::scaling::engine::{Engine, Solved};
use crate::scaling::repeat::{TIMED, failure, median};
use crate::scaling::row::Row;
use crate::scaling::solve::{Sample, Solve, Start};
use crate::scaling::{bandwidth, memory, threads};
use contact::equilibrium::ContactProblem;
use contact::error::ContactError;
use problems::commands::Failure;
use std::time::Instant;

/// Tolerances of the states that are only counted, cold.
pub const COLD: [f64; 2] = [1e-6, 1e-10];
/// The same for warm states.
pub const WARM: [f64; 1] = [1e-10];

/// Measures a case; `change` is what distinguishes the controls of the warm states from those of the cold ones, mm.
///
/// # Errors
/// [`Failure`] when the timed cold state cannot be found; other failures are listed in the row.
pub fn row(scene: SceneName, case: Case, variant: Variant, change: &[f64]) -> Result<Row, Failure> {
    let problem = ContactProblem::new(scene.scene(case)?)?;
    let controls = vec![problem.scene.start_height; change.len()];
    let nearby: Vec<f64> = controls.iter().zip(change).map(|(control, change)| control + change).collect();
    let clock = Instant::now();
    let mut engine = Engine::new(&problem, variant).map_err(failure)?;
    let setup_seconds = clock.elapsed().as_secs_f64();
    let [dofs, multipliers] = engine.sizes(&problem);
    let mut restart = Vec::new();
    let mut first = true;
    let cold = median(|| {
        if !first {
            // Bodies that keep their shape are factored again: a cold state owns nothing.
            engine = Engine::new(&problem, variant)?;
        }
        first = false;
        let (sample, solved) = sample(&engine, &problem, &controls, None)?;
        restart = solved.restart();
        Ok(sample)
    })
    .map_err(failure)?;
    let mut failures = Vec::new();
    let warm = median(|| Ok(sample(&engine, &problem, &nearby, Some(&restart))?.0));
    let warm = warm.map_err(|error| failures.push(format!("warm to {TIMED:e}: {error}"))).ok();
    let others = if variant == Variant::Direct {
        Vec::new()
    } else {
        counted(&engine, &problem, [&controls, &nearby], &mut failures)
    };
    // Up to here one state lived at a time; what follows needs memory of its own.
    let peak_memory = memory::peak();
    let thorough = matches!(variant, Variant::Dirichlet | Variant::Direct);
    let threads = if thorough { Some(threads::measure(&problem, variant, &controls)?) } else { None };
    let bandwidth = match engine.torn() {
        Some(solver) if matches!(variant, Variant::Dirichlet | Variant::Lumped) => {
            bandwidth::measure(&problem, solver.model(), variant, &controls)?
        }
        _ => Vec::new(),
    };
    let contact_nodes = problem.boundary.points.len();
    Ok(Row {
        scene,
        case,
        variant,
        dofs,
        multipliers,
        contact_nodes,
        setup_seconds,
        cold,
        warm,
        others,
        peak_memory,
        threads,
        bandwidth,
        failures,
    })
}

/// A state to [`TIMED`] and its subgradient.
fn sample(
    engine: &Engine,
    problem: &ContactProblem,
    controls: &[f64],
    start: Option<&[f64]>,
) -> Result<(Sample, Solved), ContactError> {
    let solved = engine.solve(problem, controls, start, TIMED)?;
    let (_, adjoint) = engine.adjoint(problem, &solved, TIMED)?;
    Ok((Sample { state: solved.solve.clone(), adjoint }, solved))
}

/// States to the other tolerances: cold at the first controls, warm at the second from the cold state of that tolerance.
fn counted(
    engine: &Engine,
    problem: &ContactProblem,
    [controls, nearby]: [&[f64]; 2],
    failures: &mut Vec<String>,
) -> Vec<Solve> {
    let mut solves = Vec::new();
    let mut record = |result: Result<Solved, ContactError>, start: Start, tolerance: f64| {
        let solved = result.map_err(|error| failures.push(format!("{start:?} to {tolerance:e}: {error}"))).ok()?;
        solves.push(solved.solve.clone());
        Some(solved.restart())
    };
    for tolerance in COLD {
        let restart = record(engine.solve(problem, controls, None, tolerance), Start::Cold, tolerance);
        if let Some(restart) = restart.filter(|_| WARM.contains(&tolerance)) {
            record(engine.solve(problem, nearby, Some(&restart), tolerance), Start::Warm, tolerance);
        }
    }
    solves
}
