//! Derivatives of a contact state as its solver returns them.

use crate::equilibrium::{ContactProblem, ContactRows, RowChange, ValueError};
use crate::shape::Velocities;

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
    /// Changes of the areas of the contact nodes per change of the controls, mm².
    pub areas: Vec<Vec<f64>>,
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
        let changes = |column| rows.changes(&problem.boundary, velocities, column);
        let changes: Vec<Vec<RowChange>> = (0..count).map(changes).collect();
        let opening = |changes: &Vec<RowChange>| changes.iter().map(|change| -change.gap).collect();
        let forces = vec![vec![0.0; problem.boundary.row_count]; count];
        let displacements =
            (of == TangentsOf::Displacements).then(|| vec![vec![0.0; problem.displacement_count()]; count]);
        let openings = changes.iter().map(opening).collect();
        let areas = changes.iter().map(|changes| rows.area_changes(changes)).collect();
        Self { forces, openings, areas, displacements, residual: 0.0, applications: 0 }
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
