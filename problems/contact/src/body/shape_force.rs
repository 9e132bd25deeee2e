//! −∂(K u − f): the nodal forces that changes of the column heights cause at a fixed displacement u; method.md (5.2).
//!
//! ```text
//! x₃ of layer k is F·k/n₃:   r = −Σ_nodes (k/n₃) δF_column ∂(K u − f)/∂x₃
//! ```
//! The adjoint counterpart is [`shape_sensitivity`](super::shape_sensitivity): its −pᵀ∂(K u − f) is pᵀr.

use crate::body::elasticity::Material;
use crate::body::elasticity::brick::DOFS;
use crate::body::elasticity::hex8;
use crate::body::mesh::{Block, Subdomain};
use crate::body::shape_load::{loaded_faces, weight_derivatives};
use crate::lattice;
use crate::scene::Load;

/// The forces over the dofs of one subdomain of the lower body, N, one vector per change of the column heights (mm, all
/// columns of the body) of `changes`; `u`: displacement over the subdomain's dofs.
pub fn shape_forces(
    block: &Block,
    place: &Subdomain,
    material: &Material,
    loads: &[Load],
    u: &[f64],
    changes: &[Vec<f64>],
) -> Vec<Vec<f64>> {
    let mut forces = vec![vec![0.0; place.dof_count()]; changes.len()];
    let layers = block.grid.cells[2] as f64;
    // Change of x₃ of a node of the block.
    let moved =
        |node: [usize; 3], change: &[f64]| change[block.grid.column(node[0], node[1])] * node[2] as f64 / layers;
    for local in lattice::points([0; 3], place.cells) {
        let corners = lattice::corners(local).map(|node| place.local_node(node));
        let nodes = lattice::corners(lattice::add(local, place.first_cell));
        let brick = block.brick(lattice::add(local, place.first_cell));
        let displacement: [f64; DOFS] = std::array::from_fn(|dof| u[3 * corners[dof / 3] + dof % 3]);
        let derivative = hex8::height_forces(&brick, material, &displacement);
        for (force, change) in forces.iter_mut().zip(changes) {
            let heights = nodes.map(|node| moved(node, change));
            if heights.iter().all(|height| *height == 0.0) {
                continue;
            }
            for dof in 0..DOFS {
                let sum: f64 = derivative.iter().zip(heights).map(|(row, height)| row[dof] * height).sum();
                force[3 * corners[dof / 3] + dof % 3] -= sum;
            }
        }
    }
    let local = |node: [usize; 3]| place.local_node(lattice::subtract(node, place.first_cell));
    for load in loads {
        for face in loaded_faces(&block.grid, load.face, Some(place)) {
            let derivatives = weight_derivatives(block, &face);
            for (force, change) in forces.iter_mut().zip(changes) {
                for (node, weights) in face.iter().zip(&derivatives) {
                    let height = moved(*node, change);
                    for (corner, weight) in face.iter().zip(weights) {
                        for (component, traction) in load.traction.iter().enumerate() {
                            force[3 * local(*corner) + component] += height * weight * traction;
                        }
                    }
                }
            }
        }
    }
    forces
}
