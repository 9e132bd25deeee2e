//! Von Mises stress at the centre of a brick, with derivatives by displacements and heights of nodes; method.md (5.6).
//!
//! ```text
//! s = 2μ dev ε,   σ_vM = √(3/2 s:s),   P = ∂σ_vM/∂σ = 3/2 s/σ_vM,   g_a = ∇N_a at the centre
//! ∂σ_vM/∂u_ai = 2μ Σ_j P_ij g_aj,     ∂σ_vM/∂x₃ᵛ = −2μ Σ_ij P_ij ∂₃u_i g_vj  (at fixed u),     ∂V/∂x₃ᵛ = Σ det G₃ᵥ
//! ```
//! P has no trace: the volumetric part of the stress, and with it the formulation of the brick, does not matter.

use crate::body::elasticity::brick::{DOFS, Nodes, displacement_gradient, gauss_points, sample};

/// Von Mises stress and volume of a brick, with their derivatives.
#[derive(Debug, Clone, Copy)]
pub struct StressedBrick {
    /// σ_vM at the centre, MPa.
    pub stress: f64,
    /// ∂σ_vM/∂u, dof 3a + component, MPa/mm; 0 where there is no stress.
    pub by_displacement: [f64; DOFS],
    /// ∂σ_vM/∂x₃ of the eight nodes at fixed displacements, MPa/mm.
    pub by_height: [f64; 8],
    /// V, mm³.
    pub volume: f64,
    /// ∂V/∂x₃ of the eight nodes, mm².
    pub volume_by_height: [f64; 8],
}

/// σ_vM at the centre and V of a brick.
pub fn stress_and_volume(nodes: &Nodes<f64>, shear_modulus: f64, u: &[f64; DOFS]) -> (f64, f64) {
    let (deviator, _) = deviator(&displacement_gradient(&sample(nodes, [0.0; 3]), u), shear_modulus);
    (von_mises(&deviator), gauss_points(nodes).iter().map(|point| point.volume).sum())
}

impl StressedBrick {
    /// Of a brick with the given nodes (mm) and nodal displacements (mm).
    pub fn new(nodes: &Nodes<f64>, shear_modulus: f64, u: &[f64; DOFS]) -> Self {
        let centre = sample(nodes, [0.0; 3]);
        let gradient = displacement_gradient(&centre, u);
        let (deviator, along) = deviator(&gradient, shear_modulus);
        let stress = von_mises(&deviator);
        // 2μ P, zero where the direction of the stress has no meaning.
        let factor = if stress > 0.0 { 3.0 * shear_modulus / stress } else { 0.0 };
        let slope = deviator.map(|row| row.map(|entry| factor * entry));
        let g = &centre.gradients;
        let traction = |i: usize, a: usize| (0..3).map(|j| slope[i][j] * g[a][j]).sum::<f64>();
        let (mut volume, mut volume_by_height) = (0.0, [0.0; 8]);
        for point in gauss_points(nodes) {
            volume += point.volume;
            for (entry, gradient) in volume_by_height.iter_mut().zip(&point.gradients) {
                *entry += point.volume * gradient[2];
            }
        }
        Self {
            stress,
            by_displacement: std::array::from_fn(|dof| traction(dof % 3, dof / 3)),
            by_height: std::array::from_fn(|v| -(0..3).map(|i| along[i] * traction(i, v)).sum::<f64>()),
            volume,
            volume_by_height,
        }
    }
}

/// s = 2μ dev ε of a displacement gradient `[i][j]` = ∂u_i/∂x_j, and ∂₃u.
fn deviator(gradient: &[[f64; 3]; 3], shear_modulus: f64) -> ([[f64; 3]; 3], [f64; 3]) {
    let mean = (gradient[0][0] + gradient[1][1] + gradient[2][2]) / 3.0;
    let deviator = std::array::from_fn(|i| {
        std::array::from_fn(|j| {
            shear_modulus * (gradient[i][j] + gradient[j][i] - if i == j { 2.0 * mean } else { 0.0 })
        })
    });
    (deviator, gradient.map(|row| row[2]))
}

fn von_mises(deviator: &[[f64; 3]; 3]) -> f64 {
    (1.5 * deviator.iter().flatten().map(|entry| entry * entry).sum::<f64>()).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::body::elasticity::stress::BrickStress;
    use crate::body::elasticity::{Formulation, Material, stress};
    use crate::scalar::{Dual, Scalar};

    const MU: f64 = 4.1e4;

    fn distorted() -> Nodes<f64> {
        std::array::from_fn(|a| {
            let (i, j, k) = ((a >> 2 & 1) as f64, (a >> 1 & 1) as f64, (a & 1) as f64);
            [2.0 * i, 1.5 * j, k * (1.0 + 0.2 * i - 0.1 * j + 0.15 * i * j) + 0.1 * i]
        })
    }

    fn displacements() -> [f64; DOFS] {
        std::array::from_fn(|dof| 1e-3 * (1.7 * (dof as f64 + 1.0)).sin())
    }

    /// Stress and volume in numbers with derivatives, by the definition of the stress.
    fn dual(nodes: &Nodes<Dual>, u: &[Dual; DOFS]) -> [Dual; 2] {
        let centre = sample(nodes, [0.0; 3]);
        let c = Dual::constant;
        let mut gradient = [[c(0.0); 3]; 3];
        for (a, g) in centre.gradients.iter().enumerate() {
            for i in 0..3 {
                for j in 0..3 {
                    gradient[i][j] += u[3 * a + i] * g[j];
                }
            }
        }
        let s = |i: usize, j: usize| c(MU) * (gradient[i][j] + gradient[j][i]);
        let square = |x: Dual| x * x;
        let normal = square(s(0, 0) - s(1, 1)) + square(s(1, 1) - s(2, 2)) + square(s(2, 2) - s(0, 0));
        let shear = square(s(0, 1)) + square(s(1, 2)) + square(s(0, 2));
        let mut volume = c(0.0);
        gauss_points(nodes).iter().for_each(|point| volume += point.volume);
        [(c(0.5) * normal + c(3.0) * shear).sqrt(), volume]
    }

    #[test]
    fn derivatives_are_those_of_dual_numbers() {
        let (nodes, u) = (distorted(), displacements());
        let brick = StressedBrick::new(&nodes, MU, &u);
        let (constant_nodes, constant_u) = (nodes.map(|x| x.map(Dual::constant)), u.map(Dual::constant));
        let close =
            |found: f64, exact: f64, size: f64| assert!((found - exact).abs() < 1e-13 * size, "{found} {exact}");
        for dof in 0..DOFS {
            let mut moved = constant_u;
            moved[dof].derivative = 1.0;
            let [stress, _] = dual(&constant_nodes, &moved);
            close(brick.stress, stress.value, stress.value);
            close(brick.by_displacement[dof], stress.derivative, MU);
        }
        for node in 0..8 {
            let mut moved = constant_nodes;
            moved[node][2].derivative = 1.0;
            let [stress, volume] = dual(&moved, &constant_u);
            close(brick.by_height[node], stress.derivative, brick.stress);
            close(brick.volume, volume.value, volume.value);
            close(brick.volume_by_height[node], volume.derivative, volume.value);
        }
        assert_eq!(stress_and_volume(&nodes, MU, &u), (brick.stress, brick.volume));
    }

    #[test]
    fn it_is_the_stress_of_the_pictures_in_both_formulations() {
        let (nodes, u) = (distorted(), displacements());
        let material = Material::new(2.0 * MU * 1.33, 0.33).expect("valid material");
        for material in [material, material.with_formulation(Formulation::MeanDilatation)] {
            let shown = stress::von_mises(&BrickStress::new(&nodes, &material, &u).at_centre());
            let found = stress_and_volume(&nodes, material.shear_modulus(), &u).0;
            assert!((found / shown - 1.0).abs() < 1e-12, "{found} {shown}");
        }
    }

    #[test]
    fn a_brick_without_stress_has_no_slope() {
        let brick = StressedBrick::new(&distorted(), MU, &[0.0; DOFS]);
        assert!(
            brick.stress == 0.0 && brick.by_displacement == [0.0; DOFS] && brick.by_height.iter().all(|x| *x == 0.0)
        );
    }
}
