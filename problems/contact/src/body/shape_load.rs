//! Faces that carry a traction, the nodal loads of a body, and their derivative with respect to node heights.

use crate::body::elasticity::traction::face_weights;
use crate::body::mesh::{Block, Face, Grid, Subdomain};
use crate::scalar::Dual;
use crate::scene::BodyScene;

/// Four block nodes of every brick face on a side of the block, optionally only those of one subdomain.
pub fn loaded_faces(grid: &Grid, face: Face, place: Option<&Subdomain>) -> Vec<[[usize; 3]; 4]> {
    let (first, cells) = place.map_or(([0; 3], grid.cells), |place| (place.first_cell, place.cells));
    let (axis, level) = grid.side(face);
    let touches = level == if level == 0 { first[axis] } else { first[axis] + cells[axis] };
    if !touches {
        return Vec::new();
    }
    let (second, third) = ((axis + 1) % 3, (axis + 2) % 3);
    let mut faces = Vec::new();
    for p in first[second]..first[second] + cells[second] {
        for q in first[third]..first[third] + cells[third] {
            faces.push(std::array::from_fn(|corner| {
                let mut node = [0; 3];
                node[axis] = level;
                node[second] = p + (corner >> 1);
                node[third] = q + (corner & 1);
                node
            }));
        }
    }
    faces
}

/// Consistent nodal loads of a whole body, N: three components per node of its grid.
pub fn body_load(block: &Block, scene: &BodyScene) -> Vec<f64> {
    let grid = &block.grid;
    let mut load = vec![0.0; 3 * grid.node_count()];
    for part in &scene.loads {
        for face in loaded_faces(grid, part.face, None) {
            let weights = face_weights(&face.map(|node| block.coordinates(node)));
            for (node, weight) in face.into_iter().zip(weights) {
                for (component, traction) in part.traction.iter().enumerate() {
                    load[3 * grid.node(node) + component] += weight * traction;
                }
            }
        }
    }
    load
}

/// ∂(weight of corner b)/∂x₃ of corner a as `[a][b]`, for the four corners of a face, mm.
pub fn weight_derivatives(block: &Block, face: &[[usize; 3]; 4]) -> [[f64; 4]; 4] {
    let nodes = face.map(|node| block.coordinates(node));
    std::array::from_fn(|moved| {
        let mut dual = nodes.map(|x| x.map(|value| Dual::new(value, 0.0)));
        dual[moved][2].derivative = 1.0;
        face_weights(&dual).map(|weight| weight.derivative)
    })
}

/// Passes ∂(p·f)/∂x₃ of every node of a face to `add(node, value)`, for a traction and adjoint displacements `p(node)`.
pub fn height_derivative(
    block: &Block,
    face: &[[usize; 3]; 4],
    traction: [f64; 3],
    p: impl Fn([usize; 3]) -> [f64; 3],
    mut add: impl FnMut([usize; 3], f64),
) {
    let work: [f64; 4] = face.map(|node| p(node).iter().zip(traction).map(|(p, t)| p * t).sum());
    for (node, weights) in face.iter().zip(weight_derivatives(block, face)) {
        add(*node, weights.iter().zip(&work).map(|(weight, work)| weight * work).sum());
    }
}
