//! What a function of the displacements adds to the adjoint: l = ∂J/∂u acts on the condensed bodies like a load.
//!
//! ```text
//! l̂ = l_c − K_ci K_ii⁻¹ l_i,   u_c = C (f̂ − Bᵀλ) + N a   ⇒   l·du = l̂·du_c = −Σ_bodies (C l̂)·Bᵀdλ + (Nᵀ l̂)·da
//! ```

use crate::body::Body;
use crate::direct::compliant_body::CompliantBody;
use crate::linear::dense::multiply;
use crate::linear::vector::dot;
use faer::Mat;

/// The gradient of J with respect to the displacements of one body.
#[derive(Debug)]
pub(super) struct CondensedLoad {
    /// l over the whole body in the coordinates of its nodes, 0 at held dofs, unit of J per mm.
    pub(super) full: Vec<f64>,
    /// C l̂ over the contact dofs, unit of J per N.
    pub(super) response: Vec<f64>,
    /// The resultants Nᵀ l̂.
    pub(super) resultants: Vec<f64>,
    /// Σ|l_i u_i| for the displacements of the state, unit of J.
    pub(super) size: f64,
}

impl CondensedLoad {
    /// The load on a body, and its displacements, along the axes over its dofs.
    pub(super) fn new((own, body): (&Body, &CompliantBody), mut load: Vec<f64>, displacement: &[f64]) -> Self {
        let size = load.iter().zip(displacement).map(|(l, u)| (l * u).abs()).sum();
        let condensed = &body.condensed;
        condensed.pattern.coordinates.free_forces(&own.trace, &condensed.weights, &mut load);
        let condensed = body.condensed.condense_loads(Mat::from_fn(load.len(), 1, |dof, _| load[dof]));
        let contact = condensed.col_as_slice(0);
        let response = multiply(&body.compliance, contact);
        let resultants = body.motions.iter().map(|motion| dot(motion, contact)).collect();
        Self { full: load, response, resultants, size }
    }
}
