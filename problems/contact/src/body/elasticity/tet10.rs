//! Isoparametric tetrahedron of second order with four integration points.
//!
//! ```text
//! L₀ = 1 − ξ₁ − ξ₂ − ξ₃,  L_k = ξ_k:    N_v = L_v (2 L_v − 1) at vertices,  N = 4 L_a L_b on the edge (a, b)
//! ```
//! Nodes 0 to 3 are the vertices, nodes 4 to 9 lie on the edges of [`EDGES`]: the order of Gmsh.

use crate::body::elasticity::gauss::GaussPoint;
use crate::scalar::Scalar;

/// Vertices of the edges on which nodes 4 to 9 lie.
pub const EDGES: [[usize; 2]; 6] = [[0, 1], [1, 2], [0, 2], [0, 3], [2, 3], [1, 3]];

/// Barycentric coordinate of an integration point at its vertex, (5 + 3√5)/20, and at the others.
const NEAR: f64 = 0.585_410_196_624_968_5;
const FAR: f64 = 0.138_196_601_125_010_5;
/// Volume of the reference tetrahedron.
const VOLUME: f64 = 1.0 / 6.0;

/// ∂L_v/∂ξ.
const SLOPES: [[f64; 3]; 4] = [[-1.0, -1.0, -1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

/// Gradients of the shape functions at barycentric coordinates.
fn reference_gradients(l: [f64; 4]) -> [[f64; 3]; 10] {
    std::array::from_fn(|v| {
        std::array::from_fn(|k| match v.checked_sub(4) {
            None => (4.0 * l[v] - 1.0) * SLOPES[v][k],
            Some(edge) => {
                let [a, b] = EDGES[edge];
                4.0 * (l[a] * SLOPES[b][k] + l[b] * SLOPES[a][k])
            }
        })
    })
}

/// The four integration points.
pub fn gauss_points<T: Scalar>(nodes: &[[T; 3]; 10]) -> [GaussPoint<T, 10>; 4] {
    std::array::from_fn(|vertex| {
        let l = std::array::from_fn(|v| if v == vertex { NEAR } else { FAR });
        GaussPoint::new(nodes, &reference_gradients(l), VOLUME / 4.0)
    })
}

/// Shape functions at an integration point.
pub(crate) fn values(point: usize) -> [f64; 10] {
    let l = |v: usize| if v == point { NEAR } else { FAR };
    std::array::from_fn(|v| match v.checked_sub(4) {
        None => l(v) * (2.0 * l(v) - 1.0),
        Some(edge) => 4.0 * l(EDGES[edge][0]) * l(EDGES[edge][1]),
    })
}

/// The centroid, with the volume of the reference tetrahedron as weight.
pub fn centre<T: Scalar>(nodes: &[[T; 3]; 10]) -> GaussPoint<T, 10> {
    GaussPoint::new(nodes, &reference_gradients([0.25; 4]), VOLUME)
}
