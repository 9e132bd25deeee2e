//! Stress of a cell from the displacements of its nodes, and its von Mises stress with derivatives; method.md (5.6).
//!
//! ```text
//! standard:         σ = λ tr(ε) I + 2μ ε                          at the point
//! mean dilatation:  σ = κ θ̄ I + 2μ (ε − ⅓ tr(ε) I),  θ̄ = D(u)/V  over the cell, in hexahedra
//!                   σ = λ θ̄ I + 2μ ε                  in tetrahedra                        (mean_dilatation.rs)
//! σ_vM = √( ½[(σ₁₁ − σ₂₂)² + (σ₂₂ − σ₃₃)² + (σ₃₃ − σ₁₁)²] + 3(σ₁₂² + σ₂₃² + σ₁₃²) )              [Mises1913]
//! s = 2μ dev ε,   P = ∂σ_vM/∂σ = 3/2 s/σ_vM:   ∂σ_vM/∂u_vi = 2μ Σ_j P_ij G_jᵥ,   ∂σ_vM/∂x_aᵛ = −2μ Σ_ij P_ij ∂_a u_i G_jᵥ
//! ```
//! P has no trace: the volumetric part of the stress, and with it the formulation, does not matter for σ_vM. At the
//! centre of a trilinear brick the stress converges one order faster than elsewhere \[Barlow1976\], so that is where it
//! is taken for pictures. Tensors are six numbers in the order 11, 22, 33, 12, 23, 13.

use crate::body::elasticity::Material;
use crate::body::elasticity::gauss::GaussPoint;
use crate::body::elasticity::mean_dilatation::{self, VolumeModuli};
use crate::body::elasticity::stiffness::{Tensor, stress};

/// A symmetric tensor as its components 11, 22, 33, 12, 23, 13.
pub type SymmetricTensor = [f64; 6];

/// Row and column of each of the six components.
pub const COMPONENTS: [(usize, usize); 6] = [(0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (0, 2)];

/// Stress at a point of a cell with the integration points `points` and nodal displacements u (mm), MPa; consistent
/// with its stiffness matrix: the forces of the cell are Σ V σ ∇N over its integration points.
pub fn stress_at<const N: usize>(
    point: &GaussPoint<f64, N>,
    points: &[GaussPoint<f64, N>],
    material: &Material,
    u: &[f64],
) -> SymmetricTensor {
    let moduli = VolumeModuli::of::<N>(material);
    let full = stress(&point.gradient(u), (moduli.pointwise, material.shear_modulus()));
    let mean_pressure = moduli.mean.map_or(0.0, |modulus| modulus * mean_dilatation::mean(points, u));
    COMPONENTS.map(|(row, column)| full[row][column] + if row == column { mean_pressure } else { 0.0 })
}

/// Von Mises stress, in the unit of the tensor.
pub fn von_mises(stress: &SymmetricTensor) -> f64 {
    let [s11, s22, s33, s12, s23, s13] = *stress;
    let normal = (s11 - s22).powi(2) + (s22 - s33).powi(2) + (s33 - s11).powi(2);
    let shear = s12.powi(2) + s23.powi(2) + s13.powi(2);
    (0.5 * normal + 3.0 * shear).sqrt()
}

/// σ_vM at a point of a cell with nodal displacements u, MPa.
pub fn von_mises_at<const N: usize>(point: &GaussPoint<f64, N>, shear_modulus: f64, u: &[f64]) -> f64 {
    norm(&deviator(&point.gradient(u), shear_modulus))
}

/// Von Mises stress at a point of a cell, with its derivatives.
#[derive(Debug, Clone, Copy)]
pub struct StressedPoint<const N: usize> {
    /// σ_vM, MPa.
    pub stress: f64,
    /// ∂σ_vM/∂u per node and component, MPa/mm; 0 where there is no stress.
    pub by_displacement: [[f64; 3]; N],
    /// ∂σ_vM/∂x per node and component at fixed displacements, MPa/mm.
    pub by_position: [[f64; 3]; N],
}

impl<const N: usize> StressedPoint<N> {
    /// At a point of a cell with nodal displacements u (mm).
    pub fn new(point: &GaussPoint<f64, N>, shear_modulus: f64, u: &[f64]) -> Self {
        let gradient = point.gradient(u);
        let deviator = deviator(&gradient, shear_modulus);
        let stress = norm(&deviator);
        // 2μ P, zero where the direction of the stress has no meaning.
        let factor = if stress > 0.0 { 3.0 * shear_modulus / stress } else { 0.0 };
        let slope = deviator.map(|row| row.map(|entry| factor * entry));
        let by_displacement = point.gradients.map(|g| slope.map(|row| row[0] * g[0] + row[1] * g[1] + row[2] * g[2]));
        let along = |forces: [f64; 3], a: usize| -(0..3).map(|i| gradient[i][a] * forces[i]).sum::<f64>();
        let by_position = by_displacement.map(|forces| std::array::from_fn(|a| along(forces, a)));
        Self { stress, by_displacement, by_position }
    }
}

/// s = 2μ dev ε of a displacement gradient.
fn deviator(gradient: &Tensor, shear_modulus: f64) -> Tensor {
    let mean = (gradient[0][0] + gradient[1][1] + gradient[2][2]) / 3.0;
    std::array::from_fn(|i| {
        std::array::from_fn(|j| {
            shear_modulus * (gradient[i][j] + gradient[j][i] - if i == j { 2.0 * mean } else { 0.0 })
        })
    })
}

/// √(3/2 s:s).
fn norm(deviator: &Tensor) -> f64 {
    (1.5 * deviator.iter().flatten().map(|entry| entry * entry).sum::<f64>()).sqrt()
}
