//! Geometry of a trilinear brick: shape functions, their gradients, Gauss points.
//!
//! Nodes of a brick are ordered a = 4i + 2j + k with i, j, k ∈ {0, 1} along x₁, x₂, x₃; dof 3a + component.

use crate::scalar::Scalar;

/// Coordinates of the eight nodes, mm.
pub type Nodes<T> = [[T; 3]; 8];

/// Dofs of one brick.
pub const DOFS: usize = 24;

/// Gradients of the shape functions and weighted Jacobian determinant at one Gauss point.
#[derive(Debug, Clone, Copy)]
pub struct GaussPoint<T> {
    /// ∂N_a/∂x_i as `gradients[a][i]`, 1/mm.
    pub gradients: [[T; 3]; 8],
    /// det(∂x/∂ξ) times the Gauss weight, mm³.
    pub volume: T,
}

/// 1/√3, the abscissa of the two-point Gauss rule.
const ABSCISSA: f64 = 0.577_350_269_189_625_8;

/// −1 or 1 for the two ends of an edge.
fn sign(bit: usize) -> f64 {
    if bit == 1 { 1.0 } else { -1.0 }
}

/// Reference gradients of the eight shape functions at ξ ∈ [−1, 1]³.
fn reference_gradients(xi: [f64; 3]) -> [[f64; 3]; 8] {
    std::array::from_fn(|a| {
        let s = [sign(a >> 2 & 1), sign(a >> 1 & 1), sign(a & 1)];
        let f = [1.0 + s[0] * xi[0], 1.0 + s[1] * xi[1], 1.0 + s[2] * xi[2]];
        [s[0] * f[1] * f[2] / 8.0, s[1] * f[0] * f[2] / 8.0, s[2] * f[0] * f[1] / 8.0]
    })
}

/// Values of the eight shape functions at ξ ∈ [−1, 1]³.
pub fn shape_values(xi: [f64; 3]) -> [f64; 8] {
    std::array::from_fn(|a| {
        let s = [sign(a >> 2 & 1), sign(a >> 1 & 1), sign(a & 1)];
        (1.0 + s[0] * xi[0]) * (1.0 + s[1] * xi[1]) * (1.0 + s[2] * xi[2]) / 8.0
    })
}

/// The eight Gauss points of a brick. A `volume` ≤ 0 marks an inverted element.
pub(crate) fn gauss_points<T: Scalar>(nodes: &Nodes<T>) -> [GaussPoint<T>; 8] {
    std::array::from_fn(|point| sample(nodes, [2, 1, 0].map(|shift| sign(point >> shift & 1) * ABSCISSA)))
}

/// Gradients at ξ ∈ [−1, 1]³, with det(∂x/∂ξ) as `volume`.
pub fn sample<T: Scalar>(nodes: &Nodes<T>, xi: [f64; 3]) -> GaussPoint<T> {
    let reference = reference_gradients(xi);
    let mut jacobian = [[T::constant(0.0); 3]; 3];
    for (node, gradient) in nodes.iter().zip(&reference) {
        for (i, row) in jacobian.iter_mut().enumerate() {
            for (entry, &derivative) in row.iter_mut().zip(gradient) {
                *entry += node[i] * T::constant(derivative);
            }
        }
    }
    let (inverse, volume) = invert(&jacobian);
    let gradients = std::array::from_fn(|a| {
        std::array::from_fn(|i| {
            let mut sum = T::constant(0.0);
            for (k, &derivative) in reference[a].iter().enumerate() {
                sum += inverse[k][i] * T::constant(derivative);
            }
            sum
        })
    });
    GaussPoint { gradients, volume }
}

/// Inverse and determinant of a 3×3 matrix `m[i][k] = ∂x_i/∂ξ_k`; the inverse is `[k][i] = ∂ξ_k/∂x_i`.
fn invert<T: Scalar>(m: &[[T; 3]; 3]) -> ([[T; 3]; 3], T) {
    let cofactor = |i: usize, k: usize| {
        let (i1, i2, k1, k2) = ((i + 1) % 3, (i + 2) % 3, (k + 1) % 3, (k + 2) % 3);
        m[i1][k1] * m[i2][k2] - m[i1][k2] * m[i2][k1]
    };
    let determinant = m[0][0] * cofactor(0, 0) + m[0][1] * cofactor(0, 1) + m[0][2] * cofactor(0, 2);
    (std::array::from_fn(|k| std::array::from_fn(|i| cofactor(i, k) / determinant)), determinant)
}

/// Volume of a brick, mm³; exact, the determinant is of degree two along each axis.
pub fn volume(nodes: &Nodes<f64>) -> f64 {
    gauss_points(nodes).iter().map(|point| point.volume).sum()
}

/// ∂u_j/∂x_i as `[j][i]` at one Gauss point.
pub fn displacement_gradient(point: &GaussPoint<f64>, u: &[f64; DOFS]) -> [[f64; 3]; 3] {
    let mut gradient = [[0.0; 3]; 3];
    for (a, shape) in point.gradients.iter().enumerate() {
        for (j, row) in gradient.iter_mut().enumerate() {
            for (entry, derivative) in row.iter_mut().zip(shape) {
                *entry += u[3 * a + j] * derivative;
            }
        }
    }
    gradient
}
