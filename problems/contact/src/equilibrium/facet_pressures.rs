//! The noise of facets in the pressures of a state, beside the mean pressure.

use crate::equilibrium::facet_noise::FacetNoise;
use crate::equilibrium::{ContactForces, ContactProblem, ContactRows, ContactStatus};

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
    let of_contact = |(contact, noise): (usize, &Option<FacetNoise>)| {
        let noise: &FacetNoise = noise.as_ref()?;
        let range = problem.boundary.of_contact(contact);
        let is_closed = |index: &usize| forces.status.get(*index).is_some_and(|s| *s != ContactStatus::Open);
        let closed: Vec<usize> = range.filter(is_closed).collect();
        let nodes: Vec<u32> = closed.iter().map(|&index| problem.boundary.points[index].node).collect();
        let [force, area] = closed
            .iter()
            .fold([0.0; 2], |[force, area], &index| [force + forces.normal[index], area + rows.nodes[index].area]);
        let modulus = closed.iter().map(|&index| problem.contact_moduli[index]).fold(0.0, f64::max);
        let noise_pressure = 0.5 * std::f64::consts::PI * modulus * noise.size(&nodes) / noise.width;
        let mean = if area > 0.0 { force / area } else { 0.0 };
        Some(FacetPressure { contact, is_curved: noise.is_curved, noise: noise_pressure, mean })
    };
    problem.facet_noise.iter().enumerate().filter_map(of_contact).collect()
}
