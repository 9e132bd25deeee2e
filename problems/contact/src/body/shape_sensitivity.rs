//! −pᵀ(∂_αK u − ∂_αf), element by element, as sensitivities of the heights of the columns; method.md (5.1), (5.2).
//!
//! ```text
//! x₃ of layer k is F·k/n₃:   ∂/∂F_column = Σ_k (k/n₃) ∂/∂x₃ of node (column, k)
//! ```

use crate::body::elasticity::Material;
use crate::body::elasticity::brick::DOFS;
use crate::body::elasticity::hex8;
use crate::body::mesh::{Block, Subdomain};
use crate::body::shape_load::{height_derivative, loaded_faces};
use crate::lattice;
use crate::scene::Load;

/// Sensitivities of the column heights from one subdomain of the lower body: (column, value) for its columns.
///
/// `u`, `p`: displacement and adjoint displacement over the subdomain's dofs.
pub fn column_sensitivities(
    block: &Block,
    place: &Subdomain,
    material: &Material,
    loads: &[Load],
    u: &[f64],
    p: &[f64],
) -> Vec<(usize, f64)> {
    let [n1, n2, n3] = place.nodes();
    let mut nodes = vec![0.0; n1 * n2 * n3];
    for local in lattice::points([0; 3], place.cells) {
        let corners = lattice::corners(local).map(|node| place.local_node(node));
        let take =
            |values: &[f64]| -> [f64; DOFS] { std::array::from_fn(|dof| values[3 * corners[dof / 3] + dof % 3]) };
        let coordinates = block.brick(lattice::add(local, place.first_cell));
        let derivative = hex8::height_derivative(&coordinates, material, &take(u), &take(p));
        for (corner, derivative) in corners.into_iter().zip(derivative) {
            nodes[corner] -= derivative;
        }
    }
    let local = |node: [usize; 3]| place.local_node(lattice::subtract(node, place.first_cell));
    for load in loads {
        for face in loaded_faces(&block.grid, load.face, Some(place)) {
            let adjoint = |node| {
                let first = 3 * local(node);
                [p[first], p[first + 1], p[first + 2]]
            };
            height_derivative(block, &face, load.traction, adjoint, |node, value| nodes[local(node)] += value);
        }
    }
    let layers = block.grid.cells[2] as f64;
    let mut columns = Vec::with_capacity(n1 * n2);
    for i in 0..n1 {
        for j in 0..n2 {
            let column = block.grid.column(i + place.first_cell[0], j + place.first_cell[1]);
            let sum =
                (0..n3).map(|k| nodes[place.local_node([i, j, k])] * (k + place.first_cell[2]) as f64 / layers).sum();
            columns.push((column, sum));
        }
    }
    columns
}
