//! Stiffness of a cell and its derivative with respect to the positions of its nodes.
//!
//! ```text
//! K_ab = ∫ λ ∇N_a ∇N_bᵀ + μ ∇N_b ∇N_aᵀ + μ (∇N_a·∇N_b) I
//! ∂(qᵀK u)/∂x_aᵛ = Σ det [ (σ(u):∇q) G_aᵥ − Σ σ(u)_ji ∂_a q_j G_iᵥ − Σ σ(q)_ji ∂_a u_j G_iᵥ ]      method.md (5.2)
//! ∂(K u)[x′]     = Σ det [ div x′ σ(u) − σ(u) (∇x′)ᵀ − σ(∇u ∇x′) ] ∇N
//! ```
//! With a mean dilatation, λ at the integration points is that of `VolumeModuli`, and `mean_dilatation` adds its part.

use crate::body::elasticity::Material;
use crate::body::elasticity::gauss::GaussPoint;
use crate::body::elasticity::mean_dilatation::{self, VolumeModuli};
use crate::body::elasticity::packed::lower_start;
use crate::scalar::Scalar;

/// A displacement gradient `[j][i]` = ∂u_j/∂x_i, or a stress.
pub type Tensor = [[f64; 3]; 3];

/// Stiffness matrix of a cell as its lower triangle by rows, N/mm; dof 3v + component.
pub fn stiffness<T: Scalar, const N: usize>(points: &[GaussPoint<T, N>], material: &Material) -> Vec<T> {
    let moduli = VolumeModuli::of::<N>(material);
    let (lambda, mu) = (T::constant(moduli.pointwise), T::constant(material.shear_modulus()));
    let mut matrix = vec![T::constant(0.0); lower_start(3 * N)];
    for point in points {
        let g = &point.gradients;
        for a in 0..N {
            for b in 0..=a {
                let dot = (g[a][0] * g[b][0] + g[a][1] * g[b][1] + g[a][2] * g[b][2]) * mu * point.volume;
                for i in 0..3 {
                    let row = &mut matrix[lower_start(3 * a + i) + 3 * b..][..if a == b { i + 1 } else { 3 }];
                    for (j, entry) in row.iter_mut().enumerate() {
                        *entry += (lambda * g[a][i] * g[b][j] + mu * g[a][j] * g[b][i]) * point.volume;
                    }
                    row[i] += dot;
                }
            }
        }
    }
    if let Some(modulus) = moduli.mean {
        mean_dilatation::add_stiffness(points, modulus, &mut matrix);
    }
    matrix
}

/// ∂(qᵀK u)/∂x of every node, N for q without unit; method.md (5.2). `u`, `q`: 3N entries each.
pub fn position_derivative<const N: usize>(
    points: &[GaussPoint<f64, N>],
    material: &Material,
    u: &[f64],
    q: &[f64],
) -> [[f64; 3]; N] {
    let mut result = [[0.0; 3]; N];
    let moduli = VolumeModuli::of::<N>(material);
    let lame = (moduli.pointwise, material.shear_modulus());
    for point in points {
        let (grad_u, grad_q) = (point.gradient(u), point.gradient(q));
        let (stress_u, stress_q) = (stress(&grad_u, lame), stress(&grad_q, lame));
        let energy = contraction(&stress_u, &grad_q);
        let flux: Tensor = std::array::from_fn(|a| {
            std::array::from_fn(|i| {
                (0..3).map(|j| stress_u[j][i] * grad_q[j][a] + stress_q[j][i] * grad_u[j][a]).sum::<f64>()
            })
        });
        for (node, g) in result.iter_mut().zip(&point.gradients) {
            for (a, entry) in node.iter_mut().enumerate() {
                let moved = flux[a][0] * g[0] + flux[a][1] * g[1] + flux[a][2] * g[2];
                *entry += point.volume * (energy * g[a] - moved);
            }
        }
    }
    if let Some(modulus) = moduli.mean {
        mean_dilatation::add_position_derivative(points, modulus, u, q, &mut result);
    }
    result
}

/// Adds ∂(K u)[x′], the change of the nodal forces while the nodes move with the velocities x′ (3N entries), to
/// `forces`: the same derivative as [`position_derivative`], for all q at once.
pub fn add_moved_forces<const N: usize>(
    points: &[GaussPoint<f64, N>],
    material: &Material,
    u: &[f64],
    velocities: &[f64],
    forces: &mut [f64],
) {
    let moduli = VolumeModuli::of::<N>(material);
    let lame = (moduli.pointwise, material.shear_modulus());
    for point in points {
        let (grad_u, grad_v) = (point.gradient(u), point.gradient(velocities));
        let stress_u = stress(&grad_u, lame);
        let dilation = grad_v[0][0] + grad_v[1][1] + grad_v[2][2];
        let transported: Tensor =
            std::array::from_fn(|i| std::array::from_fn(|j| (0..3).map(|a| grad_u[i][a] * grad_v[a][j]).sum::<f64>()));
        let moved = stress(&transported, lame);
        let flux: Tensor = std::array::from_fn(|k| {
            std::array::from_fn(|a| {
                let turned: f64 = (0..3).map(|i| stress_u[k][i] * grad_v[a][i]).sum();
                point.volume * (dilation * stress_u[k][a] - turned - moved[k][a])
            })
        });
        for (force, g) in forces.as_chunks_mut::<3>().0.iter_mut().zip(&point.gradients) {
            for (force, flux) in force.iter_mut().zip(&flux) {
                *force += flux[0] * g[0] + flux[1] * g[1] + flux[2] * g[2];
            }
        }
    }
    if let Some(modulus) = moduli.mean {
        mean_dilatation::add_moved_forces(points, modulus, u, velocities, forces);
    }
}

/// Stress λ tr(ε) I + 2 μ ε of a displacement gradient and (λ, μ) at an integration point, MPa.
pub fn stress(gradient: &Tensor, (lambda, mu): (f64, f64)) -> Tensor {
    let volumetric = lambda * (gradient[0][0] + gradient[1][1] + gradient[2][2]);
    std::array::from_fn(|i| {
        std::array::from_fn(|j| mu * (gradient[i][j] + gradient[j][i]) + if i == j { volumetric } else { 0.0 })
    })
}

fn contraction(a: &Tensor, b: &Tensor) -> f64 {
    a.iter().flatten().zip(b.iter().flatten()).map(|(a, b)| a * b).sum()
}
