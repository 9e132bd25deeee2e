//! Pressures, tractions and gaps on the contact boundary.

use crate::body::mesh::Grid;
use crate::equilibrium::{ContactForces, ContactProblem, ContactStatus, SolvedBody};

/// Fields on the contact boundary, one entry per contact node in the order of the grid's columns.
#[derive(Debug, Clone, PartialEq)]
pub struct ContactFields {
    /// The grid whose columns of nodes the contact nodes are.
    pub grid: Grid,
    /// Undeformed position on the lower body, mm.
    pub position: Vec<[f64; 3]>,
    /// Displacement of the lower body there, mm.
    pub displacement: Vec<[f64; 3]>,
    /// Tributary area A on the projected grid, mm².
    pub area: Vec<f64>,
    /// Pressure λ_N/A, MPa; compression positive.
    pub pressure: Vec<f64>,
    /// Tangential traction λ_T/A along x₁, x₂, MPa: what the lower body exerts on the upper one or the obstacle. None
    /// without friction.
    pub traction: Option<Vec<[f64; 2]>>,
    /// Tangential jump, displacement of the lower body less that of the upper one, mm. None without friction.
    pub slip: Option<Vec<[f64; 2]>>,
    /// Open, stick or slip.
    pub status: Vec<ContactStatus>,
    /// Gap before loading, mm; negative where the shapes overlap.
    pub gap: Vec<f64>,
    /// Gap that is left under load, mm; ≥ 0 up to the accuracy of the state. It is minus the `opening` of
    /// [`ContactForces`], the normal jump less the gap.
    pub remaining_gap: Vec<f64>,
    /// ∂J/∂(height of the contact node), unit of J per mm, where it was asked for: see
    /// [`ContactShape::height_sensitivity`](crate::contact_shape::ContactShape::height_sensitivity).
    pub sensitivity: Option<Vec<f64>>,
}

impl ContactFields {
    /// From the lower body and the contact forces of a solved shape, without sensitivities.
    pub(crate) fn new(problem: &ContactProblem, lower: &SolvedBody, forces: &ContactForces) -> Self {
        let (grid, points) = (lower.block.grid, &problem.boundary.points);
        let nodes: Vec<[usize; 3]> =
            points.iter().map(|point| [point.position[0], point.position[1], grid.cells[2]]).collect();
        let friction = problem.boundary.has_friction();
        let tractions = || {
            let pairs = forces.tangential.iter().zip(points);
            pairs.map(|(force, point)| force.map(|force| force / point.area)).collect()
        };
        Self {
            grid,
            position: nodes.iter().map(|&node| lower.block.coordinates(node)).collect(),
            displacement: nodes.iter().map(|&node| lower.displacement[grid.node(node)]).collect(),
            area: points.iter().map(|point| point.area).collect(),
            pressure: forces.normal.iter().zip(points).map(|(force, point)| force / point.area).collect(),
            traction: friction.then(tractions),
            slip: friction.then(|| forces.slip.clone()),
            status: forces.status.clone(),
            gap: problem.gaps(&lower.block),
            remaining_gap: forces.opening.iter().map(|opening| -opening).collect(),
            sensitivity: None,
        }
    }
}
