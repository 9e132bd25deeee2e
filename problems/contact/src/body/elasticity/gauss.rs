//! Shape functions of a cell at its integration points.
//!
//! ```text
//! ∂N_v/∂x = (∂N_v/∂ξ) (∂x/∂ξ)⁻¹,   volume = det(∂x/∂ξ) · weight
//! ```

use crate::scalar::Scalar;

/// Gradients of the N shape functions of a cell and weighted Jacobian determinant at one integration point.
#[derive(Debug, Clone, Copy)]
pub struct GaussPoint<T, const N: usize> {
    /// ∂N_v/∂x_i as `gradients[v][i]`, 1/mm.
    pub gradients: [[T; 3]; N],
    /// det(∂x/∂ξ) times the weight of the point, mm³. At most 0 marks an inverted cell.
    pub volume: T,
}

impl<T: Scalar, const N: usize> GaussPoint<T, N> {
    /// The point of a cell with these nodes at which the shape functions have the gradients `reference[v][k]` =
    /// ∂N_v/∂ξ_k.
    pub fn new(nodes: &[[T; 3]; N], reference: &[[f64; 3]; N], weight: f64) -> Self {
        let mut jacobian = [[T::constant(0.0); 3]; 3];
        for (node, gradient) in nodes.iter().zip(reference) {
            for (i, row) in jacobian.iter_mut().enumerate() {
                for (entry, &derivative) in row.iter_mut().zip(gradient) {
                    *entry += node[i] * T::constant(derivative);
                }
            }
        }
        let (inverse, determinant) = invert(&jacobian);
        let gradients = std::array::from_fn(|v| {
            std::array::from_fn(|i| {
                let mut sum = T::constant(0.0);
                for (k, &derivative) in reference[v].iter().enumerate() {
                    sum += inverse[k][i] * T::constant(derivative);
                }
                sum
            })
        });
        Self { gradients, volume: determinant * T::constant(weight) }
    }
}

impl<const N: usize> GaussPoint<f64, N> {
    /// ∂u_j/∂x_i as `[j][i]` of nodal values u, entry 3v + j.
    pub fn gradient(&self, u: &[f64]) -> [[f64; 3]; 3] {
        let mut gradient = [[0.0; 3]; 3];
        for (v, shape) in self.gradients.iter().enumerate() {
            for (j, row) in gradient.iter_mut().enumerate() {
                for (entry, derivative) in row.iter_mut().zip(shape) {
                    *entry += u[3 * v + j] * derivative;
                }
            }
        }
        gradient
    }
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
