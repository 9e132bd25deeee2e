//! Consistent nodal loads of a constant traction on a bilinear face.
//!
//! ```text
//! f_a = t ∫_face N_a dA,   dA = |∂x/∂ξ × ∂x/∂η| dξ dη   (2×2 Gauss points)
//! ```

use crate::scalar::Scalar;

/// ∫ N_a dA over a face of four nodes, ordered a = 2p + q along its two parameters; mm².
pub fn face_weights<T: Scalar>(nodes: &[[T; 3]; 4]) -> [T; 4] {
    let abscissa = 1.0 / 3.0_f64.sqrt();
    let mut weights = [T::constant(0.0); 4];
    for point in 0..4 {
        let xi = if point & 2 == 2 { abscissa } else { -abscissa };
        let eta = if point & 1 == 1 { abscissa } else { -abscissa };
        let sign = |bit: usize| if bit == 1 { 1.0 } else { -1.0 };
        let (mut along_xi, mut along_eta) = ([T::constant(0.0); 3], [T::constant(0.0); 3]);
        for (a, node) in nodes.iter().enumerate() {
            let (s, t) = (sign(a >> 1), sign(a & 1));
            for i in 0..3 {
                along_xi[i] += node[i] * T::constant(s * (1.0 + t * eta) / 4.0);
                along_eta[i] += node[i] * T::constant(t * (1.0 + s * xi) / 4.0);
            }
        }
        let cross = |i: usize, j: usize| along_xi[i] * along_eta[j] - along_xi[j] * along_eta[i];
        let (n1, n2, n3) = (cross(1, 2), cross(2, 0), cross(0, 1));
        let area = (n1 * n1 + n2 * n2 + n3 * n3).sqrt();
        for (a, weight) in weights.iter_mut().enumerate() {
            let (s, t) = (sign(a >> 1), sign(a & 1));
            *weight += area * T::constant((1.0 + s * xi) * (1.0 + t * eta) / 4.0);
        }
    }
    weights
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn weights_of_a_tilted_rectangle_sum_to_its_area() {
        let nodes = [[0.0, 0.0, 0.0], [0.0, 2.0, 0.0], [3.0, 0.0, 4.0], [3.0, 2.0, 4.0]];
        let weights = face_weights(&nodes);
        for weight in weights {
            assert!((weight - 2.5).abs() < 1e-14);
        }
    }
}
