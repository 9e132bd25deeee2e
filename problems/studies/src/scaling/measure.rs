//! Measures one case with one solver; tolerances are relative residuals.

use crate::scaling::cases::{Case, Subject, Variant, cluster_count};
use crate::scaling::memory;
use contact::contact_shape::{ContactState, ContactWarmStart, Solver};
use contact::equilibrium::{ContactProblem, StageSeconds, Work};
use contact::error::ContactError;
use nonsmooth::verify::seeded_direction;
use problems::commands::Failure;
use serde::Serialize;
use std::sync::Arc;
use std::time::Instant;

/// Tolerance of the timed states and of all subgradients.
pub const TIMED: f64 = 1e-8;
/// Tolerances of the states that are only counted: cold ones, and of the last one a warm one.
pub const COLD: [f64; 2] = [1e-6, 1e-10];
/// Repetitions of what takes less than [`LONG_RUN`].
const REPETITIONS: usize = 3;
/// Seconds from which one repetition is enough.
const LONG_RUN: f64 = 5.0;
/// Exponent of the paper's pressure norm.
const EXPONENT: i32 = 4;
/// Seed of the change of the controls.
const SEED: u64 = 20_231;
/// Largest change of a control, relative to the height of the body: 0.1 mm for the 100 mm of Example 5.1.
const CHANGE: f64 = 1e-3;

/// Where a solve starts from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Start {
    /// Without a warm start.
    Cold,
    /// From the state of slightly different controls.
    Warm,
}

/// Work and time of a state, and of a subgradient where one was computed.
#[derive(Debug, Serialize)]
pub struct Solve {
    start: Start,
    /// Relative Newton residual asked for.
    tolerance: f64,
    /// Steps and products with the dual operator.
    pub work: Work,
    /// The objective Σσ⁴, MPa⁴.
    objective: f64,
    /// Wall-clock time, s.
    seconds: f64,
    /// Stages of these; none for direct condensation.
    pub stages: Option<StageSeconds>,
    pub adjoint: Option<Adjoint>,
}

/// Work and time of a subgradient.
#[derive(Debug, Clone, Copy, Default, Serialize)]
pub struct Adjoint {
    /// Products with the dual operator; 0 for direct condensation.
    pub applications: usize,
    /// Wall-clock seconds of the adjoint system (direct: with the element sums).
    pub seconds: f64,
    /// Wall-clock seconds of the element sums.
    shape_seconds: f64,
}

/// One case with one solver: keys of the JSON output.
#[derive(Debug, Serialize)]
pub struct ScalingRow {
    /// What was measured: N/S or the name of a file.
    pub name: String,
    /// Bricks and subdomains per edge; none for a file.
    #[serde(flatten)]
    pub case: Option<Case>,
    pub variant: Variant,
    /// Subdomains per edge of a cluster.
    pub clusters: usize,
    /// Rigid amplitudes of the clusters; none for direct condensation.
    pub coarse_unknowns: Option<usize>,
    /// Torn degrees of freedom; untorn ones for direct condensation.
    pub dofs: usize,
    /// Rows of B; contact rows for direct condensation.
    pub multipliers: usize,
    pub contact_nodes: usize,
    /// Seconds of what is done once per run: patterns, symbolic analysis, rows.
    pub setup_seconds: f64,
    /// States to all tolerances; first those to 1e-8, with subgradients to 1e-8, the repetitions of median time.
    solves: Vec<Solve>,
    /// Peak resident memory of the process in this case, GiB; none where the system does not tell.
    pub peak_memory: Option<f64>,
    /// Messages about solves that did not reach their tolerance.
    pub failures: Vec<String>,
}

impl Solve {
    /// Products with the dual operator; 0 for direct condensation.
    pub fn applications(&self) -> usize {
        self.work.dual_operator_applications
    }

    /// Seconds of state and subgradient.
    pub fn total_seconds(&self) -> f64 {
        self.seconds + self.adjoint.map_or(0.0, |adjoint| adjoint.seconds + adjoint.shape_seconds)
    }
}

impl ScalingRow {
    /// The state solved from `start` to `tolerance`.
    pub fn solve(&self, start: Start, tolerance: f64) -> Option<&Solve> {
        self.solves.iter().find(|solve| solve.start == start && solve.tolerance == tolerance)
    }

    /// The state from nothing to 1e-8, which every row has.
    pub fn cold(&self) -> &Solve {
        &self.solves[0]
    }
}

/// Measures a case; warm states have controls that differ a little from those of the cold ones.
///
/// # Errors
/// [`Failure`] when the timed cold state cannot be found; other failures are listed in the row.
pub fn row(subject: &Subject, variant: Variant, clusters: usize) -> Result<ScalingRow, Failure> {
    memory::reset_peak();
    let problem = Arc::new(ContactProblem::new(subject.scene()?)?);
    let controls = problem.scene.start();
    let nearby = changed(&problem, &controls);
    let clock = Instant::now();
    let mut solver = variant.solver(&problem, clusters).map_err(failure)?;
    let setup_seconds = clock.elapsed().as_secs_f64();
    let [dofs, multipliers] = solver.sizes();
    let mut restart = None;
    let cold = median(|| {
        if restart.is_some() {
            // A solver keeps the factors of bodies whose shape has not changed; a cold state must not have them.
            solver = variant.solver(&problem, clusters)?;
        }
        let (state, solve) = solve(&solver, &controls, None, TIMED)?;
        restart = Some(state.solution.warm_start());
        Ok(solve)
    });
    let (mut solves, mut failures) = (vec![cold.map_err(failure)?], Vec::new());
    match median(|| Ok(solve(&solver, &nearby, restart.as_ref(), TIMED)?.1)) {
        Ok(warm) => solves.push(warm),
        Err(error) => failures.push(format!("warm to {TIMED:e}: {error}")),
    }
    if variant != Variant::Direct {
        let mut count = |controls: &[f64], restart: Option<&ContactWarmStart>, tolerance: f64| {
            let solved = solve(&solver, controls, restart, tolerance);
            let start = if restart.is_some() { "warm" } else { "cold" };
            let (state, solve) =
                solved.map_err(|error| failures.push(format!("{start} to {tolerance:e}: {error}"))).ok()?;
            solves.push(solve);
            Some(state.solution.warm_start())
        };
        count(&controls, None, COLD[0]);
        if let Some(restart) = count(&controls, None, COLD[1]) {
            count(&nearby, Some(&restart), COLD[1]);
        }
    }
    Ok(ScalingRow {
        name: subject.to_string(),
        case: subject.case(),
        variant,
        clusters,
        coarse_unknowns: variant.preconditioner().map(|_| 6 * cluster_count(&problem, clusters)),
        dofs,
        multipliers,
        contact_nodes: problem.boundary.points.len(),
        setup_seconds,
        solves,
        peak_memory: memory::peak(),
        failures,
    })
}

/// Controls that change the shape a little: heights relative to themselves, displacements to the extent of the bodies.
fn changed(problem: &ContactProblem, controls: &[f64]) -> Vec<f64> {
    let positions = problem.start_positions();
    let extent = |axis: usize| {
        let along = || positions.iter().flat_map(|body| body.iter().map(move |x| x[axis]));
        along().fold(f64::NEG_INFINITY, f64::max) - along().fold(f64::INFINITY, f64::min)
    };
    let extent = (0..3).map(extent).fold(f64::INFINITY, f64::min);
    let change = seeded_direction(controls.len(), SEED);
    let moved =
        |(control, entry): (&f64, &f64)| control + CHANGE * if *control == 0.0 { extent } else { *control } * entry;
    controls.iter().zip(change.as_slice()).map(moved).collect()
}

/// A solver's reason as a failed command.
fn failure(error: ContactError) -> Failure {
    match error {
        ContactError::InvertedElement { .. } | ContactError::NoEquilibrium { .. } | ContactError::Clusters { .. } => {
            Failure::Input(error.to_string())
        }
        _ => Failure::Computation(error.to_string()),
    }
}

/// The repetition of median time; one alone when it takes long.
fn median(mut run: impl FnMut() -> Result<Solve, ContactError>) -> Result<Solve, ContactError> {
    let mut solves = vec![run()?];
    while solves.len() < REPETITIONS && solves[0].total_seconds() < LONG_RUN {
        solves.push(run()?);
    }
    solves.sort_by(|a, b| a.total_seconds().total_cmp(&b.total_seconds()));
    Ok(solves.swap_remove(solves.len() / 2))
}

/// Solves a state, to [`TIMED`] with its subgradient, and measures the time.
fn solve(
    solver: &Solver,
    controls: &[f64],
    start: Option<&ContactWarmStart>,
    tolerance: f64,
) -> Result<(ContactState, Solve), ContactError> {
    let clock = Instant::now();
    let state = solver.solve(controls, start, tolerance)?;
    let seconds = clock.elapsed().as_secs_f64();
    let solve = Solve {
        start: if start.is_some() { Start::Warm } else { Start::Cold },
        tolerance,
        work: state.work(),
        objective: pressures(&state).map(|(pressure, _)| pressure.powi(EXPONENT)).sum(),
        seconds,
        stages: state.stages,
        adjoint: if tolerance == TIMED { Some(adjoint(solver, &state)?) } else { None },
    };
    Ok((state, solve))
}

/// Sensitivities of the column heights of Σσ⁴, timed.
fn adjoint(solver: &Solver, state: &ContactState) -> Result<Adjoint, ContactError> {
    let boundary = &solver.problem().boundary;
    let mut dual = vec![0.0; boundary.row_count];
    for (point, (pressure, area)) in boundary.points.iter().zip(pressures(state)) {
        dual[point.start] = f64::from(EXPONENT) * pressure.powi(EXPONENT - 1) / area;
    }
    let result = solver.sensitivities(&state.solution, &dual, TIMED)?;
    let (seconds, shape_seconds) = (result.adjoint_seconds, result.shape_seconds);
    Ok(Adjoint { applications: result.applications, seconds, shape_seconds })
}

/// max(σ, 0) and area per contact node.
fn pressures(state: &ContactState) -> impl Iterator<Item = (f64, f64)> {
    state.forces.normal.iter().zip(&state.rows.nodes).map(|(force, node)| ((force / node.area).max(0.0), node.area))
}
