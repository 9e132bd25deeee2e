//! A contact case: a scene, its controls, what is expected, and the paths that solve it.

use crate::stability::record::Path;
use contact::direct::DirectSolver;
use contact::equilibrium::{ContactForces, ContactProblem, Diagnosis, Kink, Residuals, StatusCounts, Work};
use contact::error::{ContactError, SceneError};
use contact::scene::Scene;
use contact::tfeti::{AugmentedLagrangianCounts, AugmentedLagrangianSettings, PreconditionerKind, TornSolver};

/// What a case is expected to end in.
#[derive(Debug, Clone)]
pub enum Expected {
    /// Certified states on which the paths agree.
    Solved,
    /// All paths refuse with an error of this kind.
    Refused(&'static str),
    /// What TFETI and direct condensation do (the kind of a refusal, or none for a state), and the cause. Solved by both is
    /// as good: rounding decides at the edge.
    Limit([Option<&'static str>; 2], &'static str),
}

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

    /// At other controls.
    #[must_use]
    pub fn at(mut self, controls: Vec<f64>) -> Self {
        self.controls = Some(controls);
        self
    }

    /// Expects a refusal of all paths.
    #[must_use]
    pub fn refused(mut self, kind: &'static str) -> Self {
        self.expected = Expected::Refused(kind);
        self
    }

    /// Expects a known limit.
    #[must_use]
    pub fn limit(mut self, kinds: [Option<&'static str>; 2], cause: &'static str) -> Self {
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

/// A state found by one path.
pub struct Found {
    pub forces: ContactForces,
    pub heights: Result<Vec<f64>, String>,
    pub diagnosis: Option<Result<Diagnosis, String>>,
}

/// A path's report with its state, if it found one.
pub type Attempt = (Path, Option<Found>);

fn packed_dual(problem: &ContactProblem) -> Vec<f64> {
    (0..problem.boundary.row_count).map(|row| (0.7 * row as f64).cos()).collect()
}

fn path(solver: &'static str, work: Work, forces: &ContactForces) -> Path {
    Path {
        solver,
        steps: work.newton_steps,
        products: work.dual_operator_applications,
        residuals: Some(forces.residuals),
        status: Some(forces.counts()),
        kink: Some(forces.kink),
        refusal: None,
        reason: None,
    }
}

fn refusal(solver: &'static str, error: &ContactError) -> Attempt {
    let none: (Option<Residuals>, Option<StatusCounts>, Option<Kink>) = (None, None, None);
    let path = Path {
        solver,
        steps: 0,
        products: 0,
        residuals: none.0,
        status: none.1,
        kink: none.2,
        refusal: Some(error.kind().into()),
        reason: Some(error.to_string()),
    };
    (path, None)
}

/// Newton on TFETI.
pub fn by_tfeti(problem: &ContactProblem, controls: &[f64]) -> Attempt {
    let attempt = || {
        let solver = TornSolver::new(problem, PreconditionerKind::Dirichlet)?;
        let (state, forces, work) = solver.solve(problem, controls, None, TOLERANCE)?;
        let heights = solver
            .sensitivities(problem, &state, &packed_dual(problem), ADJOINT_TOLERANCE)
            .map(|sensitivities| sensitivities.heights)
            .map_err(|error| error.to_string());
        Ok((path("tfeti", work, &forces), Some(Found { forces, heights, diagnosis: None })))
    };
    attempt().unwrap_or_else(|error| refusal("tfeti", &error))
}

/// Newton on condensed bodies.
pub fn by_condensation(problem: &ContactProblem, controls: &[f64]) -> Attempt {
    let attempt = || {
        let solver = DirectSolver::new(problem)?;
        let (state, forces, work) = solver.solve(problem, controls, None, TOLERANCE)?;
        let heights = solver
            .sensitivities(problem, &state, &packed_dual(problem))
            .map(|(heights, _)| heights)
            .map_err(|error| error.to_string());
        let diagnosis = Some(solver.diagnose(problem, &state).map_err(|error| error.to_string()));
        Ok((path("direct", work, &forces), Some(Found { forces, heights, diagnosis })))
    };
    attempt().unwrap_or_else(|error| refusal("direct", &error))
}

/// Successive approximations on TFETI.
pub fn by_successive_approximations(problem: &ContactProblem, controls: &[f64]) -> Attempt {
    let attempt = || {
        let solver = TornSolver::new(problem, PreconditionerKind::Dirichlet)?;
        let settings = AugmentedLagrangianSettings::to(PAPER_TOLERANCE);
        let mut counts = AugmentedLagrangianCounts::default();
        let (_, forces, work) = solver.solve_by(problem, controls, |contact| {
            let (solution, spent) = contact.solve_by_successive_approximations(None, &settings)?;
            counts = spent;
            Ok(solution)
        })?;
        let mut path = path("successive approximations", work, &forces);
        path.reason = Some(format!("observed contraction {:.3}", counts.contraction));
        Ok((path, Some(Found { forces, heights: Ok(Vec::new()), diagnosis: None })))
    };
    attempt().unwrap_or_else(|error| refusal("successive approximations", &error))
}
