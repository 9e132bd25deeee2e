//! [`ContactShape`]: controls ↦ contact forces, as a state problem of the framework.
//!
//! ```text
//! S: α ↦ y = (λ; u),    D*S(α)(y*):  one adjoint solve + one pass over the elements          method.md (5.1)
//! ```
//! Contact solvers use no trait of the framework: this module and [`crate::cost`] implement them. A dual of the state
//! has one entry per contact row, node by node: the normal row, then the tangential ones
//! ([`ContactBoundary::row_count`](crate::equilibrium::ContactBoundary) entries). A cost of the displacements adds
//! three entries per node of every body ([`ContactProblem::displacement_count`]); other costs leave them
//! out, and nothing is computed for them.

use crate::cost::PressureOutputs;
use crate::equilibrium::{ContactProblem, ContactStatus, Diagnosis, SolvedBody, Tangents, TangentsOf, ValueError};
use crate::error::{ContactError, SceneError};
use crate::fields::{Fields, Resultants};
use crate::plausibility::{self, Estimates, Warning};
use crate::scene::Scene;
use crate::solvers::{Processes, SolverPlan};
use nonsmooth::composite::{InactiveConstraints, Linearization};
use nonsmooth::interruption::interrupted;
use nonsmooth::{
    Accuracy, Coderivative, CostGradient, InputError, Matrix, OracleError, OutputJacobian, Sensitivity, StateSolver,
    Vector,
};
use std::sync::atomic::Ordering;

pub use crate::equilibrium::ContactWarmStart;
pub use crate::solvers::{Solver, SolverKind, SolverState};

/// A solved shape.
pub type ContactState = crate::equilibrium::ContactState<SolverState>;

/// The control-to-state map of a scene by a contact solver.
#[derive(Debug)]
pub struct ContactShape {
    solver: Solver,
    /// Whether states hold the displacements of all bodies.
    displacements: bool,
    outputs: PressureOutputs,
}

/// Share of a state's products that its checks may take.
const CHECKS_SHARE: f64 = 0.1;

/// Relative residual of the state per relative accuracy asked of Θ: a safety factor, since single pressures are less
/// accurate than the residual.
const RESIDUAL_SHARE: f64 = 0.1;

/// Relative residual of the adjoint per relative residual of the state.
const ADJOINT_SHARE: f64 = 0.1;

/// Tightest relative residual asked of the adjoint.
const TIGHTEST_ADJOINT: f64 = 1e-11;

impl ContactShape {
    /// Checks a scene and prepares its solver in this process; [`Processes::solver`] has more choices.
    ///
    /// # Errors
    /// As [`Processes::solver`].
    pub fn new(scene: Scene, kind: SolverKind) -> Result<Self, SceneError> {
        Ok(Self::by(Processes::alone().solver(SolverPlan::new(scene, kind))?))
    }

    /// The map by a given solver.
    pub fn by(solver: impl Into<Solver>) -> Self {
        Self { solver: solver.into(), displacements: false, outputs: PressureOutputs::default() }
    }

    /// Lets the states hold the displacements of all bodies as well: for costs of the displacements.
    #[must_use]
    pub fn with_displacements(self) -> Self {
        Self { displacements: true, ..self }
    }

    /// Whether the states hold the displacements of all bodies.
    pub fn holds_displacements(&self) -> bool {
        self.displacements
    }

    /// Replaces the outputs, which are the contact pressures: where the areas of contact nodes change with the shape, a
    /// cost is a function of [outputs of its own](crate::cost::PressureCost::outputs).
    #[must_use]
    pub fn with_outputs(self, outputs: PressureOutputs) -> Self {
        Self { outputs, ..self }
    }

    /// The contact solver behind the map.
    pub fn contact_solver(&self) -> &Solver {
        &self.solver
    }

    /// The discrete problem that the solver solves.
    pub fn problem(&self) -> &ContactProblem {
        self.solver.problem()
    }

    /// The controls the scene starts from.
    pub fn start(&self) -> Vector {
        Vector::from_vec(self.problem().scene.start())
    }

    /// Contraction and condition at a solved shape; see [`Diagnosis`].
    ///
    /// # Errors
    /// [`OracleError::Failed`] and [`OracleError::NotConverged`] from the linear systems.
    pub fn diagnose(&self, state: &ContactState) -> Result<Diagnosis, OracleError> {
        self.solver.diagnose(&state.solution).map_err(oracle)
    }

    /// What is implausible about a state; the check for uniqueness takes at most a tenth of its products with F.
    ///
    /// # Errors
    /// [`OracleError::Failed`] for a state of another mesh.
    pub fn warnings(&self, state: &ContactState) -> Result<Vec<Warning>, OracleError> {
        let products = (CHECKS_SHARE * state.work().dual_operator_applications as f64) as usize;
        let friction = self.problem().boundary.has_friction();
        // An estimate that fails says nothing.
        let contraction = friction.then(|| self.solver.estimate_contraction(&state.solution, products).ok()).flatten();
        let bodies = self.bodies(state)?;
        let force_rounding = self.solver.force_rounding(&state.solution).map_err(oracle)?;
        let estimates = Estimates { contraction: contraction.unwrap_or(0.0), force_rounding };
        Ok(plausibility::warnings(self.problem(), &bodies, (&state.rows, &state.forces), estimates))
    }

    /// What this scene did not need, in words.
    pub fn left_out(&self) -> Vec<&'static str> {
        let scene = &self.problem().scene;
        let mut left_out = Vec::new();
        if !self.problem().boundary.has_friction() {
            left_out.push("tangential multipliers (no friction)");
            left_out.push("nonsymmetric adjoint (no friction)");
        }
        let fixed = scene.bodies.iter().filter(|body| body.shape.is_none()).map(|body| body.name.as_str());
        left_out.extend(match &fixed.collect::<Vec<_>>()[..] {
            [] if scene.bodies.len() == 1 => &["second body (rigid obstacle)"][..],
            [] => &[],
            ["upper"] => &[
                "repeated factorisation of the upper body (its shape does not change: factored once per run)",
                "shape derivative of the upper body (its shape does not change)",
            ],
            _ => &[
                "repeated factorisation of bodies of fixed shape (factored once per run)",
                "shape derivative of bodies of fixed shape",
            ],
        });
        left_out.extend(self.solver.left_out());
        left_out
    }

    /// One element of D*S(α)(y*), method.md (5.1), and the error that the residual of the state causes in a function
    /// whose gradient there is y*, method.md (5.3).
    ///
    /// # Errors
    /// [`OracleError`] on wrong sizes, and when the adjoint does not converge.
    pub fn pull_back(
        &self,
        control: &Vector,
        state: &ContactState,
        direction: &Vector,
    ) -> Result<(Vector, ValueError), OracleError> {
        self.check_dimension(control)?;
        let (positions, error) = self.position_sensitivity(state, direction)?;
        Ok((Vector::from_vec(self.problem().map.pull_back(&positions)), error))
    }

    /// As [`ContactShape::pull_back`], for the positions of the nodes of all bodies, in the order of the scene, instead
    /// of the controls: with y* = ∂J/∂y of a cost, ∂J/∂x per node and component, unit of J per mm; 0 for nodes that no
    /// control moves.
    ///
    /// # Errors
    /// As [`ContactShape::pull_back`].
    pub fn position_sensitivity(
        &self,
        state: &ContactState,
        direction: &Vector,
    ) -> Result<(Vec<[f64; 3]>, ValueError), OracleError> {
        let (expected, found) = (self.problem().boundary.row_count, direction.len());
        if found != expected && found != expected + self.problem().displacement_count() {
            return Err(InputError::Dimension { what: "dual of the contact state", expected, found }.into());
        }
        let tolerance = (ADJOINT_SHARE * state.forces.residuals.newton).clamp(TIGHTEST_ADJOINT, 1e-3);
        let result = self.solver.sensitivities(&state.solution, direction.as_slice(), tolerance).map_err(oracle)?;
        state.adjoint_applications.fetch_add(result.applications, Ordering::Relaxed);
        Ok((result.positions, result.value_error))
    }

    /// Displacements, stresses and contact fields of a solved shape; the sensitivity is left out.
    ///
    /// # Errors
    /// [`OracleError::Failed`] for a state of another mesh.
    pub fn fields(&self, state: &ContactState) -> Result<Fields, OracleError> {
        Ok(Fields::new(self.problem(), self.bodies(state)?, (&state.rows, &state.forces)))
    }

    /// Resultants of the forces on the bodies of a solved shape, reactions of their supports, and the largest stress.
    ///
    /// # Errors
    /// [`OracleError::Failed`] for a state of another mesh.
    pub fn resultants(&self, state: &ContactState) -> Result<Resultants, OracleError> {
        Ok(Resultants::new(self.problem(), &self.bodies(state)?, (&state.rows, &state.forces)))
    }

    /// All bodies of a solved shape: those that the state holds, else recovered now.
    ///
    /// # Errors
    /// [`OracleError::Failed`] for a state of another mesh.
    pub fn bodies(&self, state: &ContactState) -> Result<Vec<SolvedBody>, OracleError> {
        state.bodies.clone().map_or_else(|| self.solver.bodies(&state.solution).map_err(oracle), Ok)
    }

    /// The derivative of Σ weights·outputs by the positions of the nodes of all bodies at fixed contact forces.
    pub(crate) fn output_position_gradient(&self, state: &ContactState, weights: &Vector) -> Vec<[f64; 3]> {
        let problem = self.problem();
        let [_, by_area] = self.outputs.pull_back(&state.forces.normal, &state.rows.areas(), weights.as_slice());
        problem.pull_back_areas(&state.rows, &by_area)
    }

    /// Tangents of a state for a change of every control by 1, in their order: all that Jacobians of outputs and rows
    /// of [pieces](crate::cost::StatePiece::row) need. Their products count among those of the state.
    ///
    /// # Errors
    /// [`OracleError`] when the linearized problems have no solution.
    pub fn tangents(&self, state: &ContactState, of: TangentsOf, accuracy: Accuracy) -> Result<Tangents, OracleError> {
        let changes = unit_changes(self.control_dimension());
        let tangents = self.solver.tangents(&state.solution, &changes, of, accuracy.tolerance()).map_err(oracle)?;
        state.adjoint_applications.fetch_add(tangents.applications, Ordering::Relaxed);
        Ok(tangents)
    }

    /// The linearization of the outputs at a state by its [tangents](Self::tangents).
    ///
    /// # Errors
    /// [`OracleError`] for another number of controls.
    pub fn linearize_by(
        &self,
        control: &Vector,
        state: &ContactState,
        tangents: &Tangents,
    ) -> Result<Linearization, OracleError> {
        self.check_dimension(control)?;
        let (problem, outputs) = (self.problem(), self.outputs(state));
        let (points, areas) = (problem.boundary.contact_points(), state.rows.areas());
        let mut jacobian = Matrix::zeros(outputs.len(), control.len());
        for (k, mut column) in jacobian.column_iter_mut().enumerate() {
            let forces = |node: usize| tangents.forces[k][points[node].start];
            let changes = self.outputs.push_forward([&state.forces.normal, &areas], forces, &tangents.areas[k]);
            column.copy_from_slice(&changes);
        }
        let open: Vec<usize> = (0..points.len()).filter(|&i| state.forces.status[i] == ContactStatus::Open).collect();
        let inactive = InactiveConstraints {
            slacks: Vector::from_iterator(open.len(), open.iter().map(|&i| -state.forces.opening[i])),
            jacobian: Matrix::from_fn(open.len(), control.len(), |row, k| -tangents.openings[k][open[row]]),
        };
        Ok(Linearization { outputs, jacobian, accuracy: tangents.residual, inactive: Some(inactive) })
    }

    fn check_dimension(&self, control: &Vector) -> Result<(), OracleError> {
        Ok(InputError::check_vector("control", self.control_dimension(), control)?)
    }
}

impl StateSolver for ContactShape {
    type State = ContactState;
    type WarmStart = ContactWarmStart;

    fn control_dimension(&self) -> usize {
        self.problem().map.control_count()
    }

    fn solve(
        &self,
        control: &Vector,
        start: Option<&ContactWarmStart>,
        accuracy: Accuracy,
    ) -> Result<Self::State, OracleError> {
        self.check_dimension(control)?;
        let tolerance = RESIDUAL_SHARE * accuracy.tolerance();
        let mut state = self.solver.solve(control.as_slice(), start, tolerance).map_err(oracle)?;
        if self.displacements {
            state.bodies = Some(self.solver.bodies(&state.solution).map_err(oracle)?);
        }
        tracing::debug!(
            newton_steps = state.work.newton_steps,
            products = state.work.dual_operator_applications,
            residual = state.forces.residuals.newton,
            "contact state"
        );
        Ok(state)
    }

    fn warm_start(&self, state: &Self::State) -> ContactWarmStart {
        state.solution.warm_start()
    }

    /// Products with the dual operator, adjoints included; 0 by direct condensation alone.
    fn work(&self, state: &Self::State) -> usize {
        state.work().dual_operator_applications
    }
}

impl Coderivative for ContactShape {
    fn coderivative(
        &self,
        control: &Vector,
        state: &Self::State,
        direction: &Vector,
    ) -> Result<Sensitivity, OracleError> {
        let (element, error) = self.pull_back(control, state, direction)?;
        Ok(Sensitivity { element, error_bound: error.bound })
    }
}

/// The outputs are the contact pressures σ = λ_N/A per contact node, MPa, or those of a cost
/// ([`ContactShape::with_outputs`]); the slacks are gaps of open nodes, mm.
impl OutputJacobian for ContactShape {
    fn outputs(&self, state: &Self::State) -> Vector {
        Vector::from_vec(self.outputs.values(&state.forces.normal, &state.rows.areas()))
    }

    fn output_dual(&self, _control: &Vector, state: &Self::State, weights: &Vector) -> CostGradient {
        let problem = self.problem();
        let [by_force, _] = self.outputs.pull_back(&state.forces.normal, &state.rows.areas(), weights.as_slice());
        let mut dual = Vector::zeros(problem.boundary.row_count);
        problem.boundary.contact_points().iter().zip(by_force).for_each(|(point, weight)| dual[point.start] = weight);
        let explicit = problem.map.pull_back(&self.output_position_gradient(state, weights));
        CostGradient { control: Vector::from_vec(explicit), state: dual }
    }

    fn linearize(
        &self,
        control: &Vector,
        state: &Self::State,
        accuracy: Accuracy,
    ) -> Result<Linearization, OracleError> {
        self.check_dimension(control)?;
        self.linearize_by(control, state, &self.tangents(state, TangentsOf::Contact, accuracy)?)
    }
}

/// A change of every control by 1.
pub(crate) fn unit_changes(count: usize) -> Vec<Vec<f64>> {
    let unit = |k: usize| (0..count).map(|i| f64::from(u8::from(i == k))).collect();
    (0..count).map(unit).collect()
}

/// Mechanics' reasons in the framework's words.
fn oracle(error: ContactError) -> OracleError {
    match error {
        // Loops that were ended say no more than that they did not converge.
        _ if interrupted() => OracleError::Interrupted,
        ContactError::InvertedElement { .. } | ContactError::NoFoot { .. } | ContactError::LeftMaster { .. } => {
            OracleError::OutsideDomain { reason: error.to_string() }
        }
        ContactError::NotConverged { solver, residual, iterations, .. } => {
            OracleError::NotConverged { solver, residual, iterations }
        }
        ContactError::NotFinite { what } => OracleError::NotFinite { what },
        other => OracleError::Failed(Box::new(other)),
    }
}
