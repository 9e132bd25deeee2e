//! What every contact solver offers: a state, its derivative, what is known about it.

use crate::equilibrium::{
    ContactProblem, ContactRows, ContactState, ContactWarmStart, Diagnosis, SolvedBody, SolverState, ValueError,
};
use crate::error::ContactError;
use crate::shape::Velocities;
use std::fmt;

/// A solver of one contact problem.
///
/// A state belongs to the solver that found it. That of another mesh is refused with [`ContactError::ForeignState`]; a
/// solver whose kind is chosen when the program runs refuses that of another kind with [`ContactError::OtherSolver`].
pub trait ContactSolver: fmt::Debug + Send + Sync {
    /// What the solver keeps of a solved shape for derivative, diagnosis and displacements.
    type State: SolverState;

    /// The problem that is solved.
    fn problem(&self) -> &ContactProblem;

    /// Number of degrees of freedom of all bodies, and number of multipliers.
    fn sizes(&self) -> [usize; 2];

    /// What this solver did not need for its scene, in words.
    fn left_out(&self) -> Option<&'static str>;

    /// Whether several processes share the work: all of them must make the same calls in the same order.
    fn is_shared(&self) -> bool {
        false
    }

    /// Solves one shape to a relative residual, from nothing or from a state of a similar shape. A start of another
    /// kind of solver is not used.
    ///
    /// # Errors
    /// [`ContactError`]: inverted elements, no equilibrium, no convergence.
    fn solve(
        &self,
        controls: &[f64],
        start: Option<&ContactWarmStart>,
        tolerance: f64,
    ) -> Result<ContactState<Self::State>, ContactError>;

    /// Sensitivities of the positions of the nodes of all bodies for a dual: j = ∂J/∂λ in packed rows, then, where J
    /// depends on the displacements, l = ∂J/∂u with three entries per node of every body, in the order of the scene.
    /// What J depends on the shape itself is not part of them. `tolerance`: relative residual of the adjoint, for
    /// solvers that iterate.
    ///
    /// # Errors
    /// [`ContactError::NotConverged`] from the adjoint, [`ContactError::NotFinite`] when it is singular,
    /// [`ContactError::ForeignState`] for a dual of another size.
    fn sensitivities(
        &self,
        state: &Self::State,
        direction: &[f64],
        tolerance: f64,
    ) -> Result<Sensitivities, ContactError>;

    /// Forward derivative of the contact state for changes of the controls, one vector per change: columns of the
    /// generalized Jacobian that [`sensitivities`](Self::sensitivities) has rows of. `of`: whether displacements of the
    /// bodies are differentiated as well, which costs one more solve per change. `tolerance`: relative residual of the
    /// linearized contact problems, for solvers that iterate.
    ///
    /// # Errors
    /// [`ContactError::NotConverged`] from the linearized problems, [`ContactError::NotFinite`] when they are singular,
    /// [`ContactError::ForeignState`] for changes of another number of controls.
    fn tangents(
        &self,
        state: &Self::State,
        changes: &[Vec<f64>],
        of: TangentsOf,
        tolerance: f64,
    ) -> Result<Tangents, ContactError>;

    /// Contraction and condition at a solved shape.
    ///
    /// # Errors
    /// [`ContactError`] from the linear systems.
    fn diagnose(&self, state: &Self::State) -> Result<Diagnosis, ContactError>;

    /// A rough estimate of the contraction of the slip bounds at a solved shape, for at most so many products with the
    /// dual operator; 0 where no closed node has a friction force (total FETI) or no node is closed (direct
    /// condensation). See method.md section 4.
    ///
    /// # Errors
    /// [`ContactError`] from the linear system.
    fn estimate_contraction(&self, state: &Self::State, max_products: usize) -> Result<f64, ContactError>;

    /// What the solver has lost of the contact forces by the rounding of its own matrices, as a share of the load, to
    /// first order (method.md section 4); zero for a solver whose residuals know of it.
    ///
    /// # Errors
    /// [`ContactError::ForeignState`] for a state of another mesh, where it says anything of the state.
    fn force_rounding(&self, _state: &Self::State) -> Result<f64, ContactError> {
        Ok(0.0)
    }

    /// All bodies of a solved shape, in the order of the scene.
    ///
    /// # Errors
    /// [`ContactError::ForeignState`] for a state of another mesh.
    fn bodies(&self, state: &Self::State) -> Result<Vec<SolvedBody>, ContactError>;
}

/// What of a contact state is differentiated.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub enum TangentsOf {
    /// Forces and openings of the contact nodes.
    Contact,
    /// Forces and openings of the contact nodes, and displacements of all nodes of all bodies.
    Displacements,
}

/// Directional derivatives of a contact state, one per change of the controls, and what they cost.
#[derive(Debug, Clone)]
pub struct Tangents {
    /// Changes of the multipliers per change of the controls, packed rows, N.
    pub forces: Vec<Vec<f64>>,
    /// Changes of the openings (normal jump less gap) of the contact nodes per change of the controls, mm.
    pub openings: Vec<Vec<f64>>,
    /// Changes of the displacements per change of the controls, where they were asked for: three entries along the axes
    /// per node of every body, mm. They are total derivatives at fixed nodes of the mesh, which move with
    /// the shape. Of several processes, the first one alone has the entries.
    pub displacements: Option<Vec<Vec<f64>>>,
    /// Relative residual of the linearized contact problems.
    pub residual: f64,
    /// Products with the dual operator F, every column counted; 0 for direct condensation.
    pub applications: usize,
}

impl Tangents {
    /// The tangents of bodies at rest: no force and no displacement depends on the shape (one-sidedly where a gap is
    /// closed), and openings follow the gaps.
    pub(crate) fn at_rest(
        problem: &ContactProblem,
        rows: &ContactRows,
        velocities: &Velocities<'_>,
        of: TangentsOf,
    ) -> Self {
        let count = velocities.count();
        let opening = |column| {
            let changes = rows.changes(&problem.boundary, velocities, column);
            changes.iter().map(|change| -change.gap).collect()
        };
        let forces = vec![vec![0.0; problem.boundary.row_count]; count];
        let displacements =
            (of == TangentsOf::Displacements).then(|| vec![vec![0.0; problem.displacement_count()]; count]);
        let openings = (0..count).map(opening).collect();
        Self { forces, openings, displacements, residual: 0.0, applications: 0 }
    }
}

/// Sensitivities of the positions of the nodes of all bodies, and what they cost.
#[derive(Debug, Clone)]
pub struct Sensitivities {
    /// ∂J/∂x per node and component, mm⁻¹ times the unit of J; 0 for nodes that do not move with the shape.
    pub positions: Vec<[f64; 3]>,
    /// Products with the dual operator F; 0 for direct condensation.
    pub applications: usize,
    /// Seconds of the adjoint system.
    pub adjoint_seconds: f64,
    /// Seconds of the element sums.
    pub shape_seconds: f64,
    /// What the state's residual does to J.
    pub value_error: ValueError,
}

impl Sensitivities {
    /// Sensitivities of bodies at rest: no force depends on the shape (one-sidedly where a gap is closed).
    pub(crate) fn at_rest(problem: &ContactProblem) -> Self {
        Self {
            positions: problem.no_sensitivities(),
            applications: 0,
            adjoint_seconds: 0.0,
            shape_seconds: 0.0,
            value_error: ValueError::default(),
        }
    }
}
