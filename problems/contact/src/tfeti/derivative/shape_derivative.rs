//! From the adjoint to the positions of the nodes of the lower body: element sums, and the contact rows.
//!
//! ```text
//! ∂J/∂x = −pᵀ (∂K u − ∂f)/∂x − Σ_rows (λ_r p + η_r u)·∂d_r/∂x + Σ_nodes η_N ∂gap/∂x,     η = Q q
//! ```
//! Here u and p are the displacements of a contact node less those of its partner.

use crate::body::shape_sensitivity::position_sensitivities;
use crate::equilibrium::{ContactPoint, ContactRows, RowSensitivities};
use crate::tfeti::derivative::adjoint::TornAdjoint;
use crate::tfeti::torn::{RowVector, TornModel, TornVector};
use rayon::prelude::*;

/// A solved shape as its derivative needs it.
#[derive(Debug, Clone, Copy)]
pub struct SolvedShape<'a> {
    /// Positions of the nodes of the lower body, mm.
    pub lower: &'a [[f64; 3]],
    pub rows: &'a ContactRows,
    /// u over torn dofs, mm.
    pub displacement: &'a TornVector,
    /// λ over the rows of B.
    pub multipliers: &'a RowVector,
}

/// ∂J/∂x per node of the lower body.
pub fn shape_derivative(model: &TornModel, shape: SolvedShape<'_>, adjoint: &TornAdjoint) -> Vec<[f64; 3]> {
    let moves = |node: u32| model.problem.map.moves(node);
    // Per subdomain: nodes and their sums, one after the other.
    let sums = |(index, subdomain): (usize, &crate::tfeti::torn::TornSubdomain)| {
        if subdomain.body != 0 {
            return vec![];
        }
        let (body, piece) = model.piece(index);
        let dofs = model.starts[index]..model.starts[index + 1];
        let displacements = [&shape.displacement.0[dofs.clone()], &adjoint.displacement.0[dofs]];
        let sums = position_sensitivities(body, piece, shape.lower, displacements, moves);
        sums.into_iter().flat_map(|(node, [x, y, z])| [f64::from(node), x, y, z]).collect()
    };
    let pieces = model.distribution.complete(model.subdomains.par_iter().enumerate().map(sums).collect());
    let mut result = vec![[0.0; 3]; model.problem.bodies[0].mesh.node_count()];
    for [node, sums @ ..] in pieces.iter().flat_map(|piece| piece.as_chunks::<4>().0) {
        (0..3).for_each(|axis| result[*node as usize][axis] += sums[axis]);
    }
    let boundary = &model.problem.boundary;
    shape.rows.pull_back(boundary, &row_sensitivities(model, shape, adjoint), &mut result);
    result
}

/// ∂J/∂(directions and gap) of every contact node.
fn row_sensitivities(model: &TornModel, shape: SolvedShape<'_>, adjoint: &TornAdjoint) -> Vec<RowSensitivities> {
    let eta = adjoint.multipliers.contact();
    let nodes = model.problem.boundary.points.iter().zip(&model.constraints.normalisation);
    let mut sensitivities: Vec<RowSensitivities> = nodes
        .map(|(point, nu)| RowSensitivities { gap: eta[point.start] / nu, ..RowSensitivities::default() })
        .collect();
    if model.problem.geometry.is_fixed() {
        return sensitivities;
    }
    let lambda = shape.multipliers.contact();
    let u = model.contact_displacements(shape.displacement);
    let p = model.contact_displacements(&adjoint.displacement);
    let nodes = model.problem.boundary.points.iter().zip(&model.constraints.normalisation).zip(u.iter().zip(&p));
    for (own, ((point, nu), (u, p))) in sensitivities.iter_mut().zip(nodes) {
        let of_row = |row: usize| std::array::from_fn(|axis| -(lambda[row] * p[axis] + eta[row] * u[axis]) / nu);
        own.directions = ContactPoint::rows(point).map(of_row).collect();
    }
    sensitivities
}
