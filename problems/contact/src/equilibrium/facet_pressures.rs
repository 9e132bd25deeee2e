//! The noise of facets in the pressures of a state, beside the mean pressure.

use crate::equilibrium::facet_noise::FacetNoise;
use crate::equilibrium::{ContactForces, ContactProblem, ContactRows, ContactStatus};
use crate::patches::CurvedFace;
use crate::scene::FaceGeometry;

/// Share of the mean pressure from which the noise of facets is no small thing. Pressures that are wrong by a quarter
/// and more have 0.9 to 274 of it, right ones at most 0.105.
const NOISY: f64 = 0.2;

/// The noise of pressures of a contact of a state.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FacetPressure {
    /// The contact, by its place in the scene.
    pub contact: usize,
    /// Whether gaps are those of surfaces, not of flat facets.
    pub is_curved: bool,
    /// p_f, MPa.
    pub noise: f64,
    /// Mean pressure of the closed nodes, MPa.
    pub mean: f64,
}

impl FacetPressure {
    /// Whether the noise is too large a share of the mean pressure.
    pub fn is_noisy(&self) -> bool {
        self.noise > NOISY * self.mean
    }
}

/// The noise of the pressures of every contact between curved faces at a state.
pub fn facet_pressures(problem: &ContactProblem, rows: &ContactRows, forces: &ContactForces) -> Vec<FacetPressure> {
    let is_closed = |index: usize| forces.status.get(index).is_some_and(|status| *status != ContactStatus::Open);
    over_nodes(problem, is_closed, |closed| {
        let force: f64 = closed.iter().map(|&index| forces.normal[index]).sum();
        let area: f64 = closed.iter().map(|&index| rows.nodes[index].area).sum();
        if area > 0.0 { force / area } else { 0.0 }
    })
}

/// The noise that pressures of every contact between curved faces would have if all nodes closed; the mean is 0.
pub fn facet_pressures_before_loading(problem: &ContactProblem) -> Vec<FacetPressure> {
    over_nodes(problem, |_| true, |_| 0.0)
}

fn over_nodes(
    problem: &ContactProblem,
    counts: impl Fn(usize) -> bool,
    mean: impl Fn(&[usize]) -> f64,
) -> Vec<FacetPressure> {
    let of_contact = |(index, faces): (usize, &Option<[CurvedFace; 2]>)| {
        let (faces, contact) = (faces.as_ref()?, &problem.scene.contacts[index]);
        let meshes = [&contact.slave, contact.master_face()?].map(|face| &*problem.bodies[face.body].mesh);
        let noise = FacetNoise::new(contact.geometry == FaceGeometry::Curved, meshes, faces);
        let own: Vec<usize> = problem.boundary.of_contact(index).filter(|index| counts(*index)).collect();
        let nodes: Vec<u32> = own.iter().map(|&index| problem.boundary.points[index].node).collect();
        let modulus = own.iter().map(|&index| problem.contact_moduli[index]).fold(0.0, f64::max);
        let pressure = 0.5 * std::f64::consts::PI * modulus * noise.size(&nodes) / noise.width;
        Some(FacetPressure { contact: index, is_curved: noise.is_curved, noise: pressure, mean: mean(&own) })
    };
    problem.curved_faces.iter().enumerate().filter_map(of_contact).collect()
}
