//! From the adjoint to the heights of the columns: element sums over the lower body, and the gaps.
//!
//! ```text
//! ∂J/∂F = −pᵀ (∂K u − ∂f)/∂F + (Q q)ᵀ ∂g/∂F
//! ```

use crate::body::mesh::Block;
use crate::body::shape_sensitivity::column_sensitivities;
use crate::tfeti::derivative::adjoint::TornAdjoint;
use crate::tfeti::torn::{TornModel, TornSubdomain, TornVector};
use rayon::prelude::*;

/// ∂J/∂F per column of nodes; `lower` is the lower body, `displacement` is u.
pub fn height_sensitivities(
    model: &TornModel,
    lower: &Block,
    displacement: &TornVector,
    adjoint: &TornAdjoint,
) -> Vec<f64> {
    let scene = &model.problem.scene.lower;
    // Columns and sums, one after the other.
    let sums = |subdomain: &TornSubdomain| {
        if subdomain.body != 0 {
            return vec![];
        }
        let dofs = subdomain.first_dof..subdomain.first_dof + subdomain.place.dof_count();
        let (u, p) = (&displacement.0[dofs.clone()], &adjoint.displacement.0[dofs]);
        let sums = column_sensitivities(lower, &subdomain.place, &scene.material, &scene.loads, u, p);
        sums.into_iter().flat_map(|(column, value)| [column as f64, value]).collect()
    };
    let pieces = model.distribution.complete(model.subdomains.par_iter().map(sums).collect());
    let mut heights = vec![0.0; model.problem.grid.column_count()];
    for pair in pieces.concat().chunks_exact(2) {
        heights[pair[0] as usize] += pair[1];
    }
    // The gap F² − F_α falls as the surface rises.
    let nodes = model.problem.boundary.points.iter().zip(&model.constraints.normalisation);
    for (height, (point, nu)) in heights.iter_mut().zip(nodes) {
        *height -= adjoint.multipliers.contact()[point.start] / nu;
    }
    heights
}
