//! The volumetric part of a cell by its mean dilatation (B-bar; \[NagtegaalParksRice1974\], \[Hughes1980\]). On
//! tetrahedra of second order, it is the element P2 with a constant pressure.
//!
//! ```text
//! K = K_deviatoric + (κ/V) D Dᵀ,   D_a = ∫ ∇N_a dV,   V = ∫ dV,    so that ∫ κ θ̄(u) θ̄(q) dV = κ D(u) D(q)/V
//! ∂/∂x_aᵛ:  κ (D′(u) D(q) + D(u) D′(q) − D(u) D(q) V′/V)/V,   D′(u) = Σ det [ ∇·u G_aᵥ − Σ ∂_a u_i G_iᵥ ],   V′ = Σ det G_aᵥ
//! ```
//! One constraint per cell instead of one per integration point: nearly incompressible cells keep their bending modes.
//! On hexahedra, the rest is the deviatoric part, integrated fully. The four points of a tetrahedron see too few modes
//! by it alone: there, the mean takes λ tr(ε) only (κ becomes λ), and 2μ ε remains at the points.

use crate::body::elasticity::gauss::GaussPoint;
use crate::body::elasticity::packed::lower_start;
use crate::body::elasticity::{Formulation, Material};
use crate::scalar::Scalar;

/// Moduli of the change of volume, MPa.
#[derive(Debug, Clone, Copy)]
pub struct VolumeModuli {
    /// λ at the integration points.
    pub pointwise: f64,
    /// That of the mean dilatation, if there is one.
    pub mean: Option<f64>,
}

impl VolumeModuli {
    /// Those of a cell with N nodes.
    pub fn of<const N: usize>(material: &Material) -> Self {
        let (lambda, mu) = (material.lame_lambda(), material.shear_modulus());
        match material.formulation() {
            Formulation::Standard => Self { pointwise: lambda, mean: None },
            Formulation::MeanDilatation if N == 8 => {
                Self { pointwise: -2.0 / 3.0 * mu, mean: Some(material.bulk_modulus()) }
            }
            Formulation::MeanDilatation => Self { pointwise: 0.0, mean: Some(lambda) },
        }
    }
}

/// D(u)/V: the mean over the cell of its relative change of volume.
pub fn mean<const N: usize>(points: &[GaussPoint<f64, N>], u: &[f64]) -> f64 {
    let (mut dilatation, mut volume) = (0.0, 0.0);
    for point in points {
        let gradient = point.gradient(u);
        dilatation += point.volume * (gradient[0][0] + gradient[1][1] + gradient[2][2]);
        volume += point.volume;
    }
    dilatation / volume
}

/// D and V of a cell.
fn divergence<T: Scalar, const N: usize>(points: &[GaussPoint<T, N>]) -> ([[T; 3]; N], T) {
    let (mut divergence, mut volume) = ([[T::constant(0.0); 3]; N], T::constant(0.0));
    for point in points {
        volume += point.volume;
        for (sum, gradient) in divergence.iter_mut().zip(&point.gradients) {
            for (sum, &gradient) in sum.iter_mut().zip(gradient) {
                *sum += gradient * point.volume;
            }
        }
    }
    (divergence, volume)
}

/// Adds κ D Dᵀ/V to the lower triangle of a stiffness matrix.
pub fn add_stiffness<T: Scalar, const N: usize>(points: &[GaussPoint<T, N>], bulk_modulus: f64, matrix: &mut [T]) {
    let (divergence, volume) = divergence(points);
    let factor = T::constant(bulk_modulus) / volume;
    let divergence = divergence.as_flattened();
    for row in 0..3 * N {
        for (entry, &column) in matrix[lower_start(row)..].iter_mut().zip(&divergence[..=row]) {
            *entry += factor * divergence[row] * column;
        }
    }
}

/// Adds the derivative of κ D(u) D(q)/V with respect to the positions of the nodes.
pub fn add_position_derivative<const N: usize>(
    points: &[GaussPoint<f64, N>],
    bulk_modulus: f64,
    u: &[f64],
    q: &[f64],
    result: &mut [[f64; 3]; N],
) {
    let (mut moved_u, mut moved_q, mut moved_volume) = ([[0.0; 3]; N], [[0.0; 3]; N], [[0.0; 3]; N]);
    let (mut dilatation_u, mut dilatation_q, mut volume) = (0.0, 0.0, 0.0);
    for point in points {
        let (grad_u, grad_q) = (point.gradient(u), point.gradient(q));
        let (trace_u, trace_q) =
            (grad_u[0][0] + grad_u[1][1] + grad_u[2][2], grad_q[0][0] + grad_q[1][1] + grad_q[2][2]);
        volume += point.volume;
        dilatation_u += point.volume * trace_u;
        dilatation_q += point.volume * trace_q;
        for (v, g) in point.gradients.iter().enumerate() {
            for a in 0..3 {
                let along = |gradient: &[[f64; 3]; 3]| (0..3).map(|i| gradient[i][a] * g[i]).sum::<f64>();
                moved_u[v][a] += point.volume * (trace_u * g[a] - along(&grad_u));
                moved_q[v][a] += point.volume * (trace_q * g[a] - along(&grad_q));
                moved_volume[v][a] += point.volume * g[a];
            }
        }
    }
    let factor = bulk_modulus / volume;
    for (v, result) in result.iter_mut().enumerate() {
        for (a, result) in result.iter_mut().enumerate() {
            let products = moved_u[v][a] * dilatation_q + dilatation_u * moved_q[v][a];
            *result += factor * (products - dilatation_u * dilatation_q * moved_volume[v][a] / volume);
        }
    }
}

/// Adds the change of κ D(u) D/V while the nodes move with the velocities x′.
pub fn add_moved_forces<const N: usize>(
    points: &[GaussPoint<f64, N>],
    bulk_modulus: f64,
    u: &[f64],
    velocities: &[f64],
    forces: &mut [f64],
) {
    let (divergence, volume) = divergence(points);
    let (mut dilatation, mut moved_dilatation, mut moved_volume) = (0.0, 0.0, 0.0);
    let mut moved = [[0.0; 3]; N];
    for point in points {
        let (grad_u, grad_v) = (point.gradient(u), point.gradient(velocities));
        let trace = grad_u[0][0] + grad_u[1][1] + grad_u[2][2];
        let dilation = grad_v[0][0] + grad_v[1][1] + grad_v[2][2];
        let transported: f64 = (0..3).map(|i| (0..3).map(|a| grad_u[i][a] * grad_v[a][i]).sum::<f64>()).sum();
        dilatation += point.volume * trace;
        moved_dilatation += point.volume * (trace * dilation - transported);
        moved_volume += point.volume * dilation;
        for (moved, g) in moved.iter_mut().zip(&point.gradients) {
            for (k, moved) in moved.iter_mut().enumerate() {
                let turned: f64 = (0..3).map(|a| g[a] * grad_v[a][k]).sum();
                *moved += point.volume * (dilation * g[k] - turned);
            }
        }
    }
    let factor = bulk_modulus / volume;
    let own = moved_dilatation - dilatation * moved_volume / volume;
    for (force, (d, moved)) in forces.iter_mut().zip(divergence.as_flattened().iter().zip(moved.as_flattened())) {
        *force += factor * (own * d + dilatation * moved);
    }
}
