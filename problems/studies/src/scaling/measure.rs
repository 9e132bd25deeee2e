//! Measures one case with one solver.

use crate::scaling::cases::{Case, SceneName, Variant};
use crate::scaling::repeat::{TIMED, failure, median};
use crate::scaling::row::Row;
use crate::scaling::solve::{Sample, Solve, Start};
use crate::scaling::{bandwidth, memory, threads, timing};
use contact::contact_shape::{AnySolver, ContactState, ContactWarmStart};
use contact::equilibrium::{ContactProblem, SolverState};
use contact::error::ContactError;
use problems::commands::Failure;
use std::sync::Arc;
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
    let problem = Arc::new(ContactProblem::new(scene.scene(case)?)?);
    let controls = vec![problem.scene.start_height; change.len()];
    let nearby: Vec<f64> = controls.iter().zip(change).map(|(control, change)| control + change).collect();
    let clock = Instant::now();
    let mut solver = variant.solver(&problem).map_err(failure)?;
    let setup_seconds = clock.elapsed().as_secs_f64();
    let [dofs, multipliers] = solver.sizes();
    let mut restart = None;
    let mut first = true;
    let cold = median(|| {
        if !first {
            // Bodies that keep their shape are factored again: a cold state owns nothing.
            solver = variant.solver(&problem)?;
        }
        first = false;
        let (sample, state) = sample(&*solver, &controls, None)?;
        restart = Some(state.solution.warm_start());
        Ok(sample)
    })
    .map_err(failure)?;
    let mut failures = Vec::new();
    let warm = median(|| Ok(sample(&*solver, &nearby, restart.as_ref())?.0));
    let warm = warm.map_err(|error| failures.push(format!("warm to {TIMED:e}: {error}"))).ok();
    let others =
        if variant == Variant::Direct { Vec::new() } else { counted(&*solver, [&controls, &nearby], &mut failures) };
    // Up to here one state lived at a time; what follows needs memory of its own.
    let peak_memory = memory::peak();
    let thorough = matches!(variant, Variant::Dirichlet | Variant::Direct);
    let threads = if thorough { Some(threads::measure(&problem, variant, &controls)?) } else { None };
    let bandwidth = match variant.preconditioner() {
        Some(preconditioner) if matches!(variant, Variant::Dirichlet | Variant::Lumped) => {
            bandwidth::measure(&problem, preconditioner, &controls)?
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
pub fn sample(
    solver: &AnySolver,
    controls: &[f64],
    start: Option<&ContactWarmStart>,
) -> Result<(Sample, ContactState), ContactError> {
    let (found, state) = timing::solve(solver, controls, start, TIMED)?;
    let (_, adjoint) = timing::adjoint(solver, &found, TIMED)?;
    Ok((Sample { state, adjoint }, found))
}

/// States to the other tolerances: cold at the first controls, warm at the second from the cold state of that tolerance.
fn counted(solver: &AnySolver, [controls, nearby]: [&[f64]; 2], failures: &mut Vec<String>) -> Vec<Solve> {
    let mut solves = Vec::new();
    let mut record = |controls: &[f64], restart: Option<&ContactWarmStart>, tolerance: f64| {
        let start = if restart.is_some() { Start::Warm } else { Start::Cold };
        let solved = timing::solve(solver, controls, restart, tolerance);
        let solved = solved.map_err(|error| failures.push(format!("{start:?} to {tolerance:e}: {error}")));
        let (state, solve) = solved.ok()?;
        solves.push(solve);
        Some(state.solution.warm_start())
    };
    for tolerance in COLD {
        let restart = record(controls, None, tolerance);
        if let Some(restart) = restart.filter(|_| WARM.contains(&tolerance)) {
            record(nearby, Some(&restart), tolerance);
        }
    }
    solves
}
