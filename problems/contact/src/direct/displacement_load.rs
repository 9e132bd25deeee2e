//! What a function of the displacements adds to the adjoint: l = ∂J/∂u acts on the condensed bodies like a load.
//!
//! ```text
//! l̂ = l_c − K_ci K_ii⁻¹ l_i,   u_c = C (f̂ ∓ Bᵀλ) + N a   ⇒   l·du = l̂·du_c = Σ_bodies ∓ (C l̂)·Bᵀdλ + (Nᵀ l̂)·da
//! ```

use crate::direct::compliant_body::CompliantBody;
use crate::direct::condensation::CondensationPattern;
use crate::linear::dense::multiply;
use crate::linear::vector::dot;
use faer::Mat;

/// The gradient of J with respect to the displacements of one body.
#[derive(Debug)]
pub(super) struct CondensedLoad {
    /// l over the whole body, 0 at held dofs, unit of J per mm.
    pub(super) full: Vec<f64>,
    /// C l̂ over the contact dofs, unit of J per N.
    pub(super) response: Vec<f64>,
    /// The resultants Nᵀ l̂.
    pub(super) resultants: Vec<f64>,
}

impl CondensedLoad {
    /// The load on a body, from three entries per node.
    pub(super) fn new(body: &CompliantBody, pattern: &CondensationPattern, load: &[f64]) -> Self {
        let free = load.iter().zip(&pattern.held);
        let full: Vec<f64> = free.map(|(load, held)| if *held { 0.0 } else { *load }).collect();
        let column = Mat::from_fn(full.len(), 1, |dof, _| full[dof]);
        let condensed = body.condensed.condense_loads(column, &pattern.held);
        let contact = condensed.col_as_slice(0);
        let response = multiply(&body.compliance, contact);
        let resultants = body.motions.iter().map(|motion| dot(motion, contact)).collect();
        Self { full, response, resultants }
    }
}
