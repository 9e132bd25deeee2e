//! What a function of the displacements adds to the adjoint: l = ∂J/∂u acts on the condensed bodies like a load.
//!
//! ```text
//! l̂: l put on the contact dofs,   w = C (f̂ − Bᵀλ) + N a   ⇒   l·du = l̂·dw = −Σ_bodies (C l̂)·Bᵀdλ + (Nᵀ l̂)·da
//! ```

use crate::direct::compliant_body::CompliantBody;
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
    pub(super) fn new(body: &CompliantBody, mut load: Vec<f64>, displacement: &[f64]) -> Self {
        let size = load.iter().zip(displacement).map(|(l, u)| (l * u).abs()).sum();
        body.condensed.pattern.free_forces(&mut load);
        let found = body.response(Mat::from_fn(load.len(), 1, |dof, _| load[dof]));
        let [response, resultants] =
            [&found.displacement, &found.resultants].map(|columns| columns.col_as_slice(0).to_vec());
        Self { full: load, response, resultants, size }
    }
}
