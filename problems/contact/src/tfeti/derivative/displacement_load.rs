//! What a function of the displacements adds to the adjoint system: l = ∂J/∂u acts on the bodies like a load.
//!
//! ```text
//! u of a node = mean over its copies   ⇒   every copy carries l/(number of copies);     K⁺ l,   B K⁺ l,   e_l = Rᵀ l
//! ```

use crate::tfeti::dual::DualOperator;
use crate::tfeti::torn::{RowVector, TornVector, torn_loads};

/// The gradient of J with respect to the displacements, as the adjoint system needs it.
#[derive(Debug, Clone)]
pub struct DisplacementLoad {
    /// K⁺ l over the torn dofs, unit of J per N.
    pub response: TornVector,
    /// The jumps B K⁺ l.
    pub jumps: RowVector,
    /// Rᵀ l of all clusters, unit of J per mm.
    pub resultants: Vec<f64>,
    /// l·u and Σ|l_i u_i|, unit of J.
    pub products: [f64; 2],
}

impl DisplacementLoad {
    /// From three entries per node of every body, lower first, and the displacement of the state. Where there are
    /// several processes, all of them call it.
    pub fn new(operator: &DualOperator<'_>, loads: &[f64], displacement: &TornVector) -> Self {
        let model = operator.model;
        let forces = torn_loads(model, loads);
        let terms: Vec<f64> = model
            .subdomains
            .iter()
            .enumerate()
            .flat_map(|(index, _)| {
                let dofs = operator.system.dofs(index);
                let products = forces.0[dofs.clone()].iter().zip(&displacement.0[dofs]).map(|(l, u)| l * u);
                products.fold([0.0; 2], |[sum, absolute], term| [sum + term, absolute + term.abs()])
            })
            .collect();
        let sums = model.distribution.sum(&terms, 2);
        let (response, resultants) = operator.response(&forces);
        let jumps = operator.gather(response.clone());
        Self { response, jumps, resultants, products: [sums[0], sums[1]] }
    }
}
