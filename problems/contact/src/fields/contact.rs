//! Pressures, tractions and gaps on the contact boundary.

use crate::equilibrium::{ContactFacets, ContactForces, ContactProblem, ContactRows, ContactStatus, SolvedBody};

/// Fields on the contact boundary, one entry per contact node.
#[derive(Debug, Clone, PartialEq)]
pub struct ContactFields {
    /// The slave body of every contact node.
    pub bodies: Vec<usize>,
    /// The contact nodes in the meshes of their bodies.
    pub nodes: Vec<u32>,
    /// The contact of every node, by its place in the scene.
    pub contacts: Vec<usize>,
    /// The facets of the contact surfaces.
    pub facets: ContactFacets,
    /// Undeformed position, mm.
    pub position: Vec<[f64; 3]>,
    /// Displacement of the slave body there, mm.
    pub displacement: Vec<[f64; 3]>,
    /// Unit normal from the slave body outwards.
    pub normal: Vec<[f64; 3]>,
    /// Tributary area A, mm².
    pub area: Vec<f64>,
    /// Pressure λ_N/A, MPa; compression positive.
    pub pressure: Vec<f64>,
    /// Tangential traction λ_T/A along the axes, MPa: what the slave body exerts on the master or the obstacle. None
    /// without friction.
    pub traction: Option<Vec<[f64; 3]>>,
    /// Tangential jump along the axes, displacement of the slave body less that of the master, mm. None without
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
    /// From the bodies and the contact forces of a solved shape, without sensitivities.
    pub(crate) fn new(
        problem: &ContactProblem,
        solved: &[SolvedBody],
        (rows, forces): (&ContactRows, &ContactForces),
    ) -> Self {
        let points = || problem.boundary.contact_points().iter();
        let friction = problem.boundary.has_friction();
        let tractions = || {
            let pairs = forces.tangential.iter().zip(&rows.nodes);
            pairs.map(|(force, node)| force.map(|force| force / node.area)).collect()
        };
        Self {
            position: points().map(|point| solved[point.body].positions[point.node as usize]).collect(),
            displacement: points().map(|point| solved[point.body].displacement[point.node as usize]).collect(),
            bodies: points().map(|point| point.body).collect(),
            nodes: points().map(|point| point.node).collect(),
            contacts: points().map(|point| point.contact).collect(),
            facets: problem.contact_facets(),
            normal: rows.contact_nodes().iter().map(|node| node.normal).collect(),
            area: rows.areas(),
            pressure: rows.pressures(&forces.normal),
            traction: friction.then(tractions),
            slip: friction.then(|| forces.slip.clone()),
            status: forces.status.clone(),
            gap: rows.contact_nodes().iter().map(|node| node.gap).collect(),
            remaining_gap: forces.opening.iter().map(|opening| -opening).collect(),
            sensitivity: None,
        }
    }

    /// Lets the fields hold the sensitivities of a function of the positions of the nodes of all bodies, in the order
    /// of the scene.
    pub fn set_sensitivity(&mut self, problem: &ContactProblem, positions: &[[f64; 3]]) {
        let along = |((&body, &node), normal): ((&usize, &u32), &[f64; 3])| {
            let own = positions[problem.node_number(body, node)];
            (0..3).map(|axis| normal[axis] * own[axis]).sum()
        };
        self.sensitivity = Some(self.bodies.iter().zip(&self.nodes).zip(&self.normal).map(along).collect());
    }
}
