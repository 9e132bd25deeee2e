//! Pressures, tractions and gaps on the contact boundary.

use crate::equilibrium::{ContactFacets, ContactForces, ContactProblem, ContactRows, ContactStatus, SolvedBody};

/// Fields on the contact boundary, one entry per contact node.
#[derive(Debug, Clone, PartialEq)]
pub struct ContactFields {
    /// The contact nodes in the mesh of the lower body, ascending.
    pub nodes: Vec<u32>,
    /// The facets of the contact surface.
    pub facets: ContactFacets,
    /// Undeformed position on the lower body, mm.
    pub position: Vec<[f64; 3]>,
    /// Displacement of the lower body there, mm.
    pub displacement: Vec<[f64; 3]>,
    /// Unit normal from the lower body outwards.
    pub normal: Vec<[f64; 3]>,
    /// Tributary area A, mm².
    pub area: Vec<f64>,
    /// Pressure λ_N/A, MPa; compression positive.
    pub pressure: Vec<f64>,
    /// Tangential traction λ_T/A along the axes, MPa: what the lower body exerts on the upper one or the obstacle. None
    /// without friction.
    pub traction: Option<Vec<[f64; 3]>>,
    /// Tangential jump along the axes, displacement of the lower body less that of the upper one, mm. None without
    /// friction.
    pub slip: Option<Vec<[f64; 3]>>,
    /// Open, stick or slip.
    pub status: Vec<ContactStatus>,
    /// Gap before loading, mm; negative where the shapes overlap.
    pub gap: Vec<f64>,
    /// Gap that is left under load, mm; ≥ 0 up to the accuracy of the state. It is minus the `opening` of
    /// [`ContactForces`], the normal jump less the gap.
    pub remaining_gap: Vec<f64>,
    /// n·∂J/∂x of the contact node, unit of J per mm, where it was asked for: see
    /// [`ContactShape::position_sensitivity`](crate::contact_shape::ContactShape::position_sensitivity).
    pub sensitivity: Option<Vec<f64>>,
}

impl ContactFields {
    /// From the lower body and the contact forces of a solved shape, without sensitivities.
    pub(crate) fn new(
        problem: &ContactProblem,
        lower: &SolvedBody,
        (rows, forces): (&ContactRows, &ContactForces),
    ) -> Self {
        let nodes: Vec<u32> = problem.boundary.points.iter().map(|point| point.node).collect();
        let friction = problem.boundary.has_friction();
        let tractions = || {
            let pairs = forces.tangential.iter().zip(&rows.nodes);
            pairs.map(|(force, node)| force.map(|force| force / node.area)).collect()
        };
        Self {
            position: nodes.iter().map(|&node| lower.positions[node as usize]).collect(),
            displacement: nodes.iter().map(|&node| lower.displacement[node as usize]).collect(),
            nodes,
            facets: problem.contact_facets(),
            normal: rows.nodes.iter().map(|node| node.normal).collect(),
            area: rows.areas(),
            pressure: rows.pressures(&forces.normal),
            traction: friction.then(tractions),
            slip: friction.then(|| forces.slip.clone()),
            status: forces.status.clone(),
            gap: rows.gaps().collect(),
            remaining_gap: forces.opening.iter().map(|opening| -opening).collect(),
            sensitivity: None,
        }
    }

    /// Lets the fields hold the sensitivities of a function of the positions of all nodes.
    pub fn set_sensitivity(&mut self, positions: &[[f64; 3]]) {
        let along =
            |(&node, normal): (&u32, &[f64; 3])| (0..3).map(|axis| normal[axis] * positions[node as usize][axis]).sum();
        self.sensitivity = Some(self.nodes.iter().zip(&self.normal).map(along).collect());
    }
}
