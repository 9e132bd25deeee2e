//! Trilinear hexahedron with 2 × 2 × 2 Gauss points.
//!
//! Nodes 0 to 3 lie counterclockwise around the lower face ξ₃ = −1, seen from above, nodes 4 to 7 above them: the order
//! of Gmsh and VTK.

use crate::body::elasticity::gauss::GaussPoint;
use crate::scalar::Scalar;

/// 1/√3, the abscissa of the two-point Gauss rule.
const ABSCISSA: f64 = 0.577_350_269_189_625_8;

/// ξ of the nodes.
pub const CORNERS: [[f64; 3]; 8] = [
    [-1.0, -1.0, -1.0],
    [1.0, -1.0, -1.0],
    [1.0, 1.0, -1.0],
    [-1.0, 1.0, -1.0],
    [-1.0, -1.0, 1.0],
    [1.0, -1.0, 1.0],
    [1.0, 1.0, 1.0],
    [-1.0, 1.0, 1.0],
];

/// Gradients of the shape functions at ξ ∈ [−1, 1]³.
fn reference_gradients(xi: [f64; 3]) -> [[f64; 3]; 8] {
    CORNERS.map(|s| {
        let f = [1.0 + s[0] * xi[0], 1.0 + s[1] * xi[1], 1.0 + s[2] * xi[2]];
        [s[0] * f[1] * f[2] / 8.0, s[1] * f[0] * f[2] / 8.0, s[2] * f[0] * f[1] / 8.0]
    })
}

/// The eight Gauss points.
pub fn gauss_points<T: Scalar>(nodes: &[[T; 3]; 8]) -> [GaussPoint<T, 8>; 8] {
    CORNERS.map(|corner| GaussPoint::new(nodes, &reference_gradients(corner.map(|s| s * ABSCISSA)), 1.0))
}

/// Shape functions at a Gauss point.
pub(crate) fn values(point: usize) -> [f64; 8] {
    let xi = CORNERS[point].map(|s| s * ABSCISSA);
    CORNERS.map(|s| (1.0 + s[0] * xi[0]) * (1.0 + s[1] * xi[1]) * (1.0 + s[2] * xi[2]) / 8.0)
}

/// The corners, weighed like Gauss points; not finite where the cell is flat.
pub(crate) fn corners<T: Scalar>(nodes: &[[T; 3]; 8]) -> [GaussPoint<T, 8>; 8] {
    CORNERS.map(|corner| GaussPoint::new(nodes, &reference_gradients(corner), 1.0))
}

/// The centre, with the volume of the cube in ξ as weight.
pub fn centre<T: Scalar>(nodes: &[[T; 3]; 8]) -> GaussPoint<T, 8> {
    GaussPoint::new(nodes, &reference_gradients([0.0; 3]), 8.0)
}
