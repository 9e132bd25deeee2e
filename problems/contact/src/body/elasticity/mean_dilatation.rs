//! The volumetric part of a brick by its mean dilatation (B-bar; \[NagtegaalParksRice1974\], \[Hughes1980\]).
//!
//! ```text
//! K = K_deviatoric + (κ/V) D Dᵀ,   D_a = ∫ ∇N_a dV,   V = ∫ dV,    so that ∫ κ θ̄(u) θ̄(q) dV = κ D(u) D(q)/V
//! ∂/∂x₃ᵛ:  κ (D′(u) D(q) + D(u) D′(q) − D(u) D(q) V′/V)/V,   D′(u) = Σ det [ ∇·u G₃ᵥ − Σ ∂₃u_i G_iᵥ ],   V′ = Σ det G₃ᵥ
//! ```
//! One constraint per brick instead of eight: near-incompressible bricks keep their bending modes. The deviatoric part
//! is integrated fully, so no spurious mode appears.

use crate::body::elasticity::brick::{DOFS, GaussPoint, displacement_gradient};
use crate::scalar::Scalar;

/// D(u)/V: the mean over the brick of its relative change of volume.
pub fn mean(points: &[GaussPoint<f64>; 8], u: &[f64; DOFS]) -> f64 {
    let (mut dilatation, mut volume) = (0.0, 0.0);
    for point in points {
        let gradient = displacement_gradient(point, u);
        dilatation += point.volume * (gradient[0][0] + gradient[1][1] + gradient[2][2]);
        volume += point.volume;
    }
    dilatation / volume
}

/// Adds κ D Dᵀ/V to the lower triangle of a stiffness matrix.
pub fn add_stiffness<T: Scalar>(points: &[GaussPoint<T>; 8], bulk_modulus: f64, matrix: &mut [[T; DOFS]; DOFS]) {
    let (mut divergence, mut volume) = ([T::constant(0.0); DOFS], T::constant(0.0));
    for point in points {
        volume += point.volume;
        for (dof, entry) in divergence.iter_mut().enumerate() {
            *entry += point.gradients[dof / 3][dof % 3] * point.volume;
        }
    }
    let factor = T::constant(bulk_modulus) / volume;
    for row in 0..DOFS {
        for column in 0..=row {
            matrix[row][column] += factor * divergence[row] * divergence[column];
        }
    }
}

/// Adds the derivative of κ D(u) D(q)/V with respect to the heights of the nodes.
pub fn add_height_derivative(
    points: &[GaussPoint<f64>; 8],
    bulk_modulus: f64,
    u: &[f64; DOFS],
    q: &[f64; DOFS],
    result: &mut [f64; 8],
) {
    let (mut moved_u, mut moved_q, mut moved_volume) = ([0.0; 8], [0.0; 8], [0.0; 8]);
    let (mut dilatation_u, mut dilatation_q, mut volume) = (0.0, 0.0, 0.0);
    for point in points {
        let (grad_u, grad_q) = (displacement_gradient(point, u), displacement_gradient(point, q));
        let (trace_u, trace_q) =
            (grad_u[0][0] + grad_u[1][1] + grad_u[2][2], grad_q[0][0] + grad_q[1][1] + grad_q[2][2]);
        volume += point.volume;
        dilatation_u += point.volume * trace_u;
        dilatation_q += point.volume * trace_q;
        for (node, g) in point.gradients.iter().enumerate() {
            let along = |gradient: &[[f64; 3]; 3]| (0..3).map(|i| gradient[i][2] * g[i]).sum::<f64>();
            moved_u[node] += point.volume * (trace_u * g[2] - along(&grad_u));
            moved_q[node] += point.volume * (trace_q * g[2] - along(&grad_q));
            moved_volume[node] += point.volume * g[2];
        }
    }
    let factor = bulk_modulus / volume;
    for (node, result) in result.iter_mut().enumerate() {
        let products = moved_u[node] * dilatation_q + dilatation_u * moved_q[node];
        *result += factor * (products - dilatation_u * dilatation_q * moved_volume[node] / volume);
    }
}
