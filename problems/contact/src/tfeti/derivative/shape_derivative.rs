//! From the adjoint to the heights of the columns: element sums over the lower body, and the gaps.
//!
//! ```text
//! ∂J/∂F = −pᵀ (∂K u − ∂f)/∂F + (Q q)ᵀ ∂g/∂F
//! ```

use crate::body::mesh::Block;
use crate::body::shape_sensitivity::column_sensitivities;
use crate::tfeti::derivative::adjoint::TornAdjoint;
use crate::tfeti::torn::{TornModel, TornSystem, TornVector};
use rayon::prelude::*;

/// ∂J/∂F per column of nodes; `lower` is the lower body, `displacement` is u.
pub fn height_sensitivities(
    model: &TornModel,
    system: &TornSystem,
    lower: &Block,
    displacement: &TornVector,
    adjoint: &TornAdjoint,
) -> Vec<f64> {
    let scene = &model.problem.scene.lower;
    let subdomains = model.subdomains.par_iter().zip(&system.parts);
    let sums: Vec<Vec<(usize, f64)>> = subdomains
        .map(|(subdomain, part)| {
            if subdomain.body != 0 || part.factors.is_none() {
                return vec![];
            }
            let dofs = subdomain.first_dof..subdomain.first_dof + subdomain.place.dof_count();
            let (u, p) = (&displacement.0[dofs.clone()], &adjoint.displacement.0[dofs]);
            column_sensitivities(lower, &subdomain.place, &scene.material, &scene.loads, u, p)
        })
        .collect();
    let pieces =
        model.share_pieces(|index| sums[index].iter().flat_map(|&(column, value)| [column as f64, value]).collect());
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
