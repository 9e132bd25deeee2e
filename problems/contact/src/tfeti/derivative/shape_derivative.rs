//! From the adjoint to the positions of the nodes of all bodies: element sums, and the contact rows.
//!
//! ```text
//! ∂J/∂x = −pᵀ (∂K u − ∂f)/∂x − Σ_rows Σ_sides (λ_r p + η_r u)·∂(w d_r)/∂x + Σ_nodes η_N ∂gap/∂x,     η = Q q
//! ```

use crate::body::shape_sensitivity::position_sensitivities;
use crate::equilibrium::ContactRows;
use crate::equilibrium::problem::add_at;
use crate::equilibrium::row_work::{row_sensitivities, side_forces};
use crate::equilibrium::trace_work::TraceWork;
use crate::linear::parallel;
use crate::shape::Positions;
use crate::tfeti::derivative::adjoint::TornAdjoint;
use crate::tfeti::torn::{RowVector, TornModel, TornVector};

/// A solved shape as its derivative needs it.
#[derive(Debug, Clone, Copy)]
pub struct SolvedShape<'a> {
    /// Positions of the nodes of all bodies, mm.
    pub positions: &'a Positions,
    pub rows: &'a ContactRows,
    /// u over torn dofs, mm.
    pub displacement: &'a TornVector,
    /// λ over the rows of B.
    pub multipliers: &'a RowVector,
}

/// ∂J/∂x per node of all bodies.
pub fn shape_derivative(model: &TornModel, shape: SolvedShape<'_>, adjoint: &TornAdjoint) -> Vec<[f64; 3]> {
    let (problem, map) = (&model.problem, &model.problem.map);
    // Per subdomain: nodes and their sums, one after the other.
    let sums = |index: usize| {
        let number = model.subdomains[index].body;
        if !map.shapes(number) {
            return vec![];
        }
        let (body, piece) = model.piece(index);
        let dofs = model.starts[index]..model.starts[index + 1];
        let displacements = [&shape.displacement.0[dofs.clone()], &adjoint.displacement.0[dofs]];
        let moves = |node: u32| map.moves(number, node);
        let sums = position_sensitivities(body, piece, &shape.positions[number], displacements, moves);
        let first = map.nodes(number).start as f64;
        sums.into_iter().flat_map(|(node, [x, y, z])| [first + f64::from(node), x, y, z]).collect()
    };
    let pieces = model.distribution.complete(parallel::map(model.subdomains.len(), &sums));
    let mut result = problem.no_sensitivities();
    for [node, sums @ ..] in pieces.iter().flat_map(|piece| piece.as_chunks::<4>().0) {
        add_at(&mut result, *node as usize, *sums);
    }
    let moves = |body: usize, node: u32| map.moves(body, node);
    let changes = !problem.geometry.is_fixed();
    let nodal = changes.then(|| [shape.displacement, &adjoint.displacement].map(|u| model.contact_displacements(u)));
    let physical = |rows: &RowVector| -> Vec<f64> {
        let scales = model.constraints.contact_scales(&problem.boundary);
        rows.contact().iter().zip(scales).map(|(row, nu)| row / nu).collect()
    };
    let (lambda, eta) = (physical(shape.multipliers), physical(&adjoint.multipliers));
    let weighted = nodal.as_ref().map(|fields| fields.each_ref().map(|u| model.weighted(shape.rows, u)));
    let fields = weighted.as_ref().map(|[u, p]| [u, p]);
    let rows = row_sensitivities((&problem.boundary, shape.rows), [&lambda, &eta], fields);
    shape.rows.pull_back(&problem.boundary, &rows, moves, |body, node, sensitivity| {
        add_at(&mut result, problem.node_number(body, node), sensitivity);
    });
    let work = TraceWork::new(problem, shape.rows, shape.positions);
    if let Some((work, [u, p])) = work.zip(nodal.as_ref()) {
        let own = (&problem.boundary, shape.rows);
        let by_side = [&lambda, &eta].map(|forces| side_forces(own, forces, problem.bodies.len()));
        work.pull_back(by_side.each_ref(), [u, p], |body, node, sensitivity| {
            add_at(&mut result, problem.node_number(body, node), sensitivity);
        });
    }
    result
}
