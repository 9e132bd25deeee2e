//! A contact case: a scene, its controls, what is expected, and the paths that solve it.

use crate::stability::record::Path;
use contact::contact_shape::{ContactState, Solver};
use contact::direct::DirectSolver;
use contact::equilibrium::{ContactForces, ContactProblem, Diagnosis};
use contact::error::{ContactError, SceneError};
use contact::scene::Scene;
use contact::tfeti::{DualMethod, TornOptions, TotalFeti};
use std::sync::Arc;
use testset::kit::wavy;

/// What a case is expected to end in.
#[derive(Debug, Clone)]
pub enum Expected {
    /// Certified states on which the paths agree.
    Solved,
    /// All paths refuse with an error of this kind.
    Refused(&'static str),
    /// What TFETI and direct condensation do (the kind of a refusal, or none for a state), and the cause. A case that
    /// both solve is as good, since rounding decides at the edge.
    Limit(LimitKinds, &'static str),
}

/// Kinds of refusals that are expected of total FETI, then of direct condensation; an empty list expects a state.
pub type LimitKinds = [&'static [&'static str]; 2];

/// A finding about a solved state, or what is wrong with it.
pub type Check = Box<dyn Fn(&ContactProblem, &ContactForces) -> Result<String, String> + Send + Sync>;

/// A contact case under construction.
pub struct ContactCase {
    pub(super) scene: Result<Scene, SceneError>,
    pub(super) controls: Option<Vec<f64>>,
    pub(super) expected: Expected,
    pub(super) check: Option<Check>,
    pub(super) paper: bool,
}

/// Relative residual asked of the states.
const TOLERANCE: f64 = 1e-12;
/// Relative residual asked of the successive approximations.
const PAPER_TOLERANCE: f64 = 1e-7;
/// Relative residual asked of adjoints.
const ADJOINT_TOLERANCE: f64 = 1e-10;

impl ContactCase {
    /// A case that is to be solved at the scene's start shape.
    pub fn new(scene: Result<Scene, SceneError>) -> Self {
        Self { scene, controls: None, expected: Expected::Solved, check: None, paper: false }
    }

    #[must_use]
    pub fn at(mut self, controls: Vec<f64>) -> Self {
        self.controls = Some(controls);
        self
    }

    /// At a gently wavy surface below the start height.
    #[must_use]
    pub fn wavy(self) -> Self {
        Self { controls: self.scene.as_ref().ok().map(wavy_controls), ..self }
    }

    /// Expects a refusal of all paths.
    #[must_use]
    pub fn refused(mut self, kind: &'static str) -> Self {
        self.expected = Expected::Refused(kind);
        self
    }

    /// Expects a known limit.
    #[must_use]
    pub fn limit(mut self, kinds: LimitKinds, cause: &'static str) -> Self {
        self.expected = Expected::Limit(kinds, cause);
        self
    }

    /// Looks at the state.
    #[must_use]
    pub fn check(
        mut self,
        check: impl Fn(&ContactProblem, &ContactForces) -> Result<String, String> + Send + Sync + 'static,
    ) -> Self {
        self.check = Some(Box::new(check));
        self
    }

    /// Also by the successive approximations.
    #[must_use]
    pub fn with_paper(mut self) -> Self {
        self.paper = true;
        self
    }
}

/// Control heights of a gently wavy surface below the start height of a scene.
pub fn wavy_controls(scene: &Scene) -> Vec<f64> {
    let start = scene.start();
    wavy(start[0], start.len())
}

/// A state found by one path.
pub struct Found {
    pub forces: ContactForces,
    /// Sensitivities of the control heights, for a dual that is nothing special.
    pub heights: Result<Vec<f64>, String>,
    pub diagnosis: Option<Result<Diagnosis, String>>,
}

/// A path's report with its state, if it found one.
pub type Attempt = (Path, Option<Found>);

/// A state by a solver, and what is asked of it besides.
fn attempt(
    name: &'static str,
    solver: Result<Solver, ContactError>,
    controls: &[f64],
    tolerance: f64,
    examine: impl FnOnce(&Solver, ContactState, &mut Path) -> Found,
) -> Attempt {
    match solver.and_then(|solver| Ok((solver.solve(controls, None, tolerance)?, solver))) {
        Ok((state, solver)) => {
            let work = state.work();
            let mut path = Path {
                solver: name,
                steps: work.newton_steps,
                products: work.dual_operator_applications,
                residuals: Some(state.forces.residuals),
                status: Some(state.forces.counts()),
                kink: Some(state.forces.kink),
                ..Path::default()
            };
            let found = examine(&solver, state, &mut path);
            (path, Some(found))
        }
        Err(error) => {
            let (refusal, reason) = (Some(error.kind()), Some(error.to_string()));
            (Path { solver: name, refusal, reason, ..Path::default() }, None)
        }
    }
}

/// Sensitivities of the control heights for a dual that is nothing special.
fn heights(solver: &Solver, state: &ContactState) -> Result<Vec<f64>, String> {
    let problem = solver.problem();
    let dual: Vec<f64> = (0..problem.boundary.row_count).map(|row| (0.7 * row as f64).cos()).collect();
    let sensitivities = solver.sensitivities(&state.solution, &dual, ADJOINT_TOLERANCE);
    sensitivities.map(|found| problem.map.pull_back(&found.positions)).map_err(|error| error.to_string())
}

/// Solves a state by total FETI and the semismooth Newton method.
pub fn by_tfeti(problem: &Arc<ContactProblem>, controls: &[f64]) -> Attempt {
    let solver = TotalFeti::new(Arc::clone(problem), TornOptions::default()).map(Solver::from);
    attempt("tfeti", solver, controls, TOLERANCE, |solver, state, _| {
        let heights = heights(solver, &state);
        Found { forces: state.forces, heights, diagnosis: None }
    })
}

/// Newton on condensed bodies.
pub fn by_condensation(problem: &Arc<ContactProblem>, controls: &[f64]) -> Attempt {
    let solver = DirectSolver::new(Arc::clone(problem)).map(Solver::from);
    attempt("direct", solver, controls, TOLERANCE, |solver, state, _| {
        let heights = heights(solver, &state);
        let diagnosis = Some(solver.diagnose(&state.solution).map_err(|error| error.to_string()));
        Found { forces: state.forces, heights, diagnosis }
    })
}

/// Successive approximations on TFETI.
pub fn by_successive_approximations(problem: &Arc<ContactProblem>, controls: &[f64]) -> Attempt {
    let solver = TotalFeti::new(Arc::clone(problem), TornOptions::default());
    let solver = solver.map(|solver| Solver::from(solver.with_method(DualMethod::SuccessiveApproximations)));
    attempt("successive approximations", solver, controls, PAPER_TOLERANCE, |_, state, path| {
        path.reason = Some(format!("observed contraction {:.3}", state.contraction.unwrap_or(0.0)));
        Found { forces: state.forces, heights: Ok(Vec::new()), diagnosis: None }
    })
}
