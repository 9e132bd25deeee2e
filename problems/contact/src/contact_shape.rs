//! [`ContactShape`]: control heights ↦ contact forces, as a state problem of the framework.
//!
//! ```text
//! S: α ↦ y = (λ_N; λ_T),    D*S(α)(y*):  one adjoint solve + one pass over the elements             method.md (5.1)
//! ```
//! The only file that knows both the framework and the mechanics. Dual of the state: the normal forces of all contact nodes,
//! then, with friction, two tangential forces per node ([`crate::equilibrium::ContactBoundary::dual_dimension`] entries).

use crate::direct::{DirectSolver, DirectState};
use crate::equilibrium::{ContactForces, ContactProblem, Diagnosis, ValueError, Work};
use crate::error::{ContactError, SceneError};
use crate::fields::Fields;
use crate::memory;
use crate::scene::Scene;
use crate::tfeti::{
    AugmentedLagrangianCounts, AugmentedLagrangianSettings, NewtonSettings, PreconditionerKind, Recycling, TornSolver,
    TornState,
};
use nonsmooth::{Accuracy, Coderivative, InputError, OracleError, StateSolver, Vector};
use std::sync::atomic::{AtomicUsize, Ordering};

/// Which contact solver.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
#[non_exhaustive]
pub enum SolverKind {
    /// Semismooth Newton on total FETI.
    #[default]
    Newton,
    /// Semismooth Newton on directly condensed bodies.
    Direct,
    /// The paper's path on total FETI: successive approximations, dual QPs by SMALSE-M and MPGP.
    AugmentedLagrangian,
}

/// The control-to-state map of a scene.
#[derive(Debug)]
pub struct ContactShape {
    problem: ContactProblem,
    solver: Solver,
    kind: SolverKind,
    recycling: Recycling,
}

#[derive(Debug)]
enum Solver {
    Torn(Box<TornSolver>),
    Direct(Box<DirectSolver>),
}

/// A solved shape.
#[derive(Debug)]
pub struct ContactState {
    /// Forces, status, certificates.
    pub forces: ContactForces,
    /// Estimated contraction factor of the successive approximations, if that path was taken.
    pub contraction: Option<f64>,
    work: Work,
    adjoint_applications: AtomicUsize,
    error: f64,
    solution: Solution,
}

#[derive(Debug)]
enum Solution {
    Torn(Box<TornState>),
    Direct(Box<DirectState>),
}

/// What restarts a solve nearby.
#[derive(Debug, Clone, serde::Serialize, serde::Deserialize)]
pub enum ContactWarmStart {
    /// Multipliers of the torn problem.
    Multipliers(Vec<f64>),
    /// Contact displacements of the condensed problem.
    Displacements(Vec<f64>),
}

/// Relative residual of the state per relative accuracy asked of Θ: a safety factor, since single pressures are less accurate
/// than the residual.
const RESIDUAL_SHARE: f64 = 0.1;

/// Residual per accuracy of the adjoint.
const ADJOINT_SHARE: f64 = 0.1;

/// Tightest relative residual asked of the adjoint.
const TIGHTEST_ADJOINT: f64 = 1e-11;

impl ContactShape {
    /// Checks a scene and prepares its solver.
    ///
    /// # Errors
    /// [`SceneError`] for a bad field; a failing symbolic analysis is reported as the scene's size.
    pub fn new(scene: Scene, kind: SolverKind) -> Result<Self, SceneError> {
        Self::with_preconditioner(scene, kind, PreconditionerKind::default())
    }

    /// As [`ContactShape::new`], with a choice of the TFETI preconditioner.
    ///
    /// # Errors
    /// As [`ContactShape::new`].
    pub fn with_preconditioner(
        scene: Scene,
        kind: SolverKind,
        preconditioner: PreconditionerKind,
    ) -> Result<Self, SceneError> {
        scene.validate()?;
        memory::check(&scene, kind, preconditioner)?;
        let problem = ContactProblem::new(scene)?;
        let size = |error: ContactError| SceneError::out_of_range("mesh", error, "a size that can be factored");
        let solver = match kind {
            SolverKind::Newton | SolverKind::AugmentedLagrangian => {
                Solver::Torn(Box::new(TornSolver::new(&problem, preconditioner).map_err(size)?))
            }
            SolverKind::Direct => Solver::Direct(Box::new(DirectSolver::new(&problem).map_err(size)?)),
        };
        Ok(Self { problem, solver, kind, recycling: Recycling::default() })
    }

    /// The same map with another use of dual directions by the Newton solver on total FETI: [`Recycling::Off`] gives every
    /// Newton step a GMRES of its own. Other solvers do not look at it.
    #[must_use]
    pub fn with_recycling(mut self, recycling: Recycling) -> Self {
        self.recycling = recycling;
        self
    }

    /// The discrete problem.
    pub fn problem(&self) -> &ContactProblem {
        &self.problem
    }

    /// The controls the scene starts from.
    pub fn start(&self) -> Vector {
        Vector::from_element(self.control_dimension(), self.problem.scene.start_height)
    }

    /// Contraction and condition at a solved shape; see [`Diagnosis`].
    ///
    /// # Errors
    /// [`OracleError::Failed`] and [`OracleError::NotConverged`] from the linear systems, or when the state was found by
    /// another kind of solver.
    pub fn diagnose(&self, state: &ContactState) -> Result<Diagnosis, OracleError> {
        match (&self.solver, &state.solution) {
            (Solver::Torn(solver), Solution::Torn(torn)) => solver.diagnose(&self.problem, torn).map_err(oracle),
            (Solver::Direct(solver), Solution::Direct(direct)) => {
                solver.diagnose(&self.problem, direct).map_err(oracle)
            }
            _ => Err(other_solver()),
        }
    }

    /// What this scene did not need, in words.
    pub fn left_out(&self) -> Vec<&'static str> {
        let scene = &self.problem.scene;
        let mut left_out = Vec::new();
        if scene.friction == 0.0 {
            left_out.push("tangential multipliers (no friction)");
            left_out.push("nonsymmetric adjoint (no friction)");
        }
        if scene.upper.is_none() {
            left_out.push("second body (rigid obstacle)");
        } else {
            left_out
                .push("repeated factorisation of the upper body (its shape does not change: factored once per run)");
            left_out.push("shape derivative of the upper body (its shape does not change)");
        }
        match &self.solver {
            Solver::Torn(solver) if solver.model().constraints.gluing_count == 0 => {
                left_out.push("gluing (one subdomain per body)");
            }
            Solver::Torn(_) => {}
            Solver::Direct(_) => left_out.push("tearing, gluing, dual operator (direct condensation)"),
        }
        left_out
    }

    fn check_dimension(&self, control: &Vector) -> Result<(), OracleError> {
        let (expected, found) = (self.control_dimension(), control.len());
        if expected != found {
            return Err(InputError::Dimension { what: "control", expected, found }.into());
        }
        match nonsmooth::linalg::first_non_finite(control.as_slice()) {
            Some(index) => Err(InputError::NotFinite { what: "control", index, value: control[index] }.into()),
            None => Ok(()),
        }
    }
}

impl ContactState {
    /// Work spent so far, the adjoint included.
    pub fn work(&self) -> Work {
        let adjoint_applications = self.adjoint_applications.load(Ordering::Relaxed);
        Work {
            adjoint_applications,
            dual_operator_applications: self.work.dual_operator_applications + adjoint_applications,
            ..self.work
        }
    }

    /// The TFETI state, if that solver found it.
    pub fn torn(&self) -> Option<&TornState> {
        match &self.solution {
            Solution::Torn(state) => Some(state),
            Solution::Direct(_) => None,
        }
    }
}

impl StateSolver for ContactShape {
    type State = ContactState;
    type WarmStart = ContactWarmStart;

    fn control_dimension(&self) -> usize {
        self.problem.scene.control_points[0] * self.problem.scene.control_points[1]
    }

    fn solve(
        &self,
        control: &Vector,
        start: Option<&ContactWarmStart>,
        accuracy: Accuracy,
    ) -> Result<ContactState, OracleError> {
        self.check_dimension(control)?;
        let tolerance = RESIDUAL_SHARE * accuracy.tolerance();
        let controls = control.as_slice();
        let mut contraction = None;
        let (solution, forces, work, load) = match (&self.solver, start) {
            (Solver::Torn(solver), start) => {
                let start = match start {
                    Some(ContactWarmStart::Multipliers(multipliers)) => Some(multipliers.as_slice()),
                    _ => None,
                };
                let (state, forces, work) = if self.kind == SolverKind::AugmentedLagrangian {
                    let settings = AugmentedLagrangianSettings::to(tolerance);
                    let mut counts = AugmentedLagrangianCounts::default();
                    let solved = solver.solve_by(&self.problem, controls, |contact| {
                        let (solution, work) = contact.solve_by_successive_approximations(start, &settings)?;
                        counts = work;
                        Ok(solution)
                    });
                    contraction = Some(counts.contraction).filter(|factor| *factor > 0.0);
                    solved.map(|(state, forces, work)| (state, forces, counts.added_to(work)))
                } else {
                    let settings = NewtonSettings { recycling: self.recycling, ..NewtonSettings::to(tolerance) };
                    solver.solve_by(&self.problem, controls, |contact| contact.solve(start, &settings))
                }
                .map_err(oracle)?;
                let load = state.load();
                (Solution::Torn(Box::new(state)), forces, work, load)
            }
            (Solver::Direct(solver), start) => {
                let start = match start {
                    Some(ContactWarmStart::Displacements(displacements)) => Some(displacements.as_slice()),
                    _ => None,
                };
                let (state, forces, work) = solver.solve(&self.problem, controls, start, tolerance).map_err(oracle)?;
                let load = state.load();
                (Solution::Direct(Box::new(state)), forces, work, load)
            }
        };
        let error = forces.residuals.newton * load;
        tracing::debug!(
            newton_steps = work.newton_steps,
            products = work.dual_operator_applications,
            residual = forces.residuals.newton,
            "contact state"
        );
        Ok(ContactState { forces, contraction, work, adjoint_applications: AtomicUsize::new(0), error, solution })
    }

    fn warm_start(&self, state: &ContactState) -> ContactWarmStart {
        match &state.solution {
            Solution::Torn(state) => ContactWarmStart::Multipliers(state.multipliers().to_vec()),
            Solution::Direct(state) => ContactWarmStart::Displacements(state.contact_displacement().to_vec()),
        }
    }

    /// Residual times load, N: the size of the error of the contact forces. For a cost, [`ContactShape::pull_back`] has the
    /// sharper estimate.
    fn state_error(&self, state: &ContactState) -> f64 {
        state.error
    }
}

impl ContactShape {
    /// One element of D*S(α)(y*), and what the residual of the state does to a function with the gradient y* there.
    ///
    /// # Errors
    /// [`OracleError`] on wrong sizes, on a state of another kind of solver, and when the adjoint does not converge.
    pub fn pull_back(
        &self,
        control: &Vector,
        state: &ContactState,
        direction: &Vector,
    ) -> Result<(Vector, ValueError), OracleError> {
        self.check_dimension(control)?;
        let (heights, error) = self.height_sensitivity(state, direction)?;
        Ok((Vector::from_vec(self.problem.height_map.pull_back(&heights)), error))
    }

    /// As [`ContactShape::pull_back`], for the heights of the contact nodes instead of the controls: with y* = ∂J/∂y of a cost,
    /// ∂J/∂(height) per contact node, unit of J per mm. A shape may move every node on its own here; the controls move them
    /// together.
    ///
    /// # Errors
    /// As [`ContactShape::pull_back`].
    pub fn height_sensitivity(
        &self,
        state: &ContactState,
        direction: &Vector,
    ) -> Result<(Vec<f64>, ValueError), OracleError> {
        let (expected, found) = (self.problem.boundary.dual_dimension(), direction.len());
        if expected != found {
            return Err(InputError::Dimension { what: "dual of the contact state", expected, found }.into());
        }
        let packed = self.problem.boundary.pack(direction.as_slice());
        match (&self.solver, &state.solution) {
            (Solver::Torn(solver), Solution::Torn(torn)) => {
                let tolerance = (ADJOINT_SHARE * state.forces.residuals.newton).clamp(TIGHTEST_ADJOINT, 1e-3);
                let result = solver.sensitivities(&self.problem, torn, &packed, tolerance).map_err(oracle)?;
                state.adjoint_applications.fetch_add(result.applications, Ordering::Relaxed);
                Ok((result.heights, result.value_error))
            }
            (Solver::Direct(solver), Solution::Direct(direct)) => {
                solver.sensitivities(&self.problem, direct, &packed).map_err(oracle)
            }
            _ => Err(other_solver()),
        }
    }

    /// Displacements, stresses and contact fields of a solved shape; the sensitivity is left out.
    ///
    /// # Errors
    /// [`OracleError::Failed`] for a state of another kind of solver or of another mesh.
    pub fn fields(&self, state: &ContactState) -> Result<Fields, OracleError> {
        let bodies = match (&self.solver, &state.solution) {
            (Solver::Torn(solver), Solution::Torn(torn)) => solver.bodies(&self.problem, torn),
            (Solver::Direct(solver), Solution::Direct(direct)) => solver.bodies(&self.problem, direct),
            _ => return Err(other_solver()),
        };
        Ok(Fields::new(&self.problem, bodies.map_err(oracle)?, &state.forces))
    }

    /// Strain energy of all bodies, N·mm; none for direct condensation, which keeps no displacements inside the bodies.
    pub fn strain_energy(&self, state: &ContactState) -> Option<f64> {
        match (&self.solver, &state.solution) {
            (Solver::Torn(solver), Solution::Torn(torn)) => Some(solver.strain_energy(torn)),
            _ => None,
        }
    }
}

impl Coderivative for ContactShape {
    fn coderivative(&self, control: &Vector, state: &ContactState, direction: &Vector) -> Result<Vector, OracleError> {
        Ok(self.pull_back(control, state, direction)?.0)
    }

    fn coderivative_with_error(
        &self,
        control: &Vector,
        state: &ContactState,
        direction: &Vector,
    ) -> Result<(Vector, Option<f64>), OracleError> {
        let (product, error) = self.pull_back(control, state, direction)?;
        Ok((product, Some(error.bound)))
    }
}

/// A state that this solver did not find.
fn other_solver() -> OracleError {
    OracleError::Failed("the state was found by another kind of contact solver".into())
}

/// Mechanics' reasons in the framework's words.
fn oracle(error: ContactError) -> OracleError {
    match error {
        ContactError::InvertedElement { .. } => OracleError::OutsideDomain { reason: error.to_string() },
        ContactError::NotConverged { solver, residual, iterations, .. } => {
            OracleError::NotConverged { solver, residual, iterations }
        }
        ContactError::NotFinite { what } => OracleError::NotFinite { what },
        other => OracleError::Failed(Box::new(other)),
    }
}
