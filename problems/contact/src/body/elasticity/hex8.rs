//! Trilinear brick: stiffness and its derivative with respect to the heights of its nodes.
//!
//! ```text
//! K_ab = ∫ λ ∇N_a ∇N_bᵀ + μ ∇N_b ∇N_aᵀ + μ (∇N_a·∇N_b) I                                    (2×2×2 Gauss points)
//! ∂(qᵀK u)/∂x₃ᵛ = Σ det [ (σ(u):∇q) G₃ᵥ − Σ σ(u)_ji ∂₃q_j G_iᵥ − Σ σ(q)_ji ∂₃u_j G_iᵥ ]       method.md (5.2)
//! ```
//! With [`Formulation::MeanDilatation`] the Gauss points carry the deviatoric part only (λ = −⅔μ) and
//! `mean_dilatation` adds the volumetric one.

use crate::body::elasticity::brick::{DOFS, Nodes, displacement_gradient, gauss_points};
use crate::body::elasticity::{Formulation, Material, mean_dilatation};
use crate::scalar::Scalar;

/// λ at the Gauss points: of the whole material, or of its deviatoric part.
pub(crate) fn pointwise_lambda(material: &Material) -> f64 {
    match material.formulation() {
        Formulation::Standard => material.lame_lambda(),
        Formulation::MeanDilatation => -2.0 / 3.0 * material.shear_modulus(),
    }
}

/// Stiffness matrix of a brick, 24 × 24 row major (symmetric), N/mm.
pub fn stiffness<T: Scalar>(nodes: &Nodes<T>, material: &Material) -> [[T; DOFS]; DOFS] {
    let (lambda, mu) = (T::constant(pointwise_lambda(material)), T::constant(material.shear_modulus()));
    let mut matrix = [[T::constant(0.0); DOFS]; DOFS];
    let points = gauss_points(nodes);
    for point in &points {
        let g = &point.gradients;
        for a in 0..8 {
            for b in 0..=a {
                let dot = (g[a][0] * g[b][0] + g[a][1] * g[b][1] + g[a][2] * g[b][2]) * mu * point.volume;
                for i in 0..3 {
                    for j in 0..3 {
                        let entry = (lambda * g[a][i] * g[b][j] + mu * g[a][j] * g[b][i]) * point.volume;
                        matrix[3 * a + i][3 * b + j] += entry;
                    }
                    matrix[3 * a + i][3 * b + i] += dot;
                }
            }
        }
    }
    if material.formulation() == Formulation::MeanDilatation {
        mean_dilatation::add_stiffness(&points, material.bulk_modulus(), &mut matrix);
    }
    for row in 0..DOFS {
        for column in row + 1..DOFS {
            matrix[row][column] = matrix[column][row];
        }
    }
    matrix
}

/// ∂(qᵀK u)/∂x₃ of each of the eight nodes; method.md (5.2). `u`, `q`: 24 dofs each.
pub fn height_derivative(nodes: &Nodes<f64>, material: &Material, u: &[f64; DOFS], q: &[f64; DOFS]) -> [f64; 8] {
    let mut result = [0.0; 8];
    let lame = (pointwise_lambda(material), material.shear_modulus());
    let points = gauss_points(nodes);
    for point in &points {
        let (grad_u, grad_q) = (displacement_gradient(point, u), displacement_gradient(point, q));
        let (stress_u, stress_q) = (stress(&grad_u, lame), stress(&grad_q, lame));
        let energy: f64 = (0..3).map(|i| (0..3).map(|j| stress_u[i][j] * grad_q[i][j]).sum::<f64>()).sum();
        let mut flux = [0.0; 3];
        for (i, flux) in flux.iter_mut().enumerate() {
            for j in 0..3 {
                *flux += stress_u[j][i] * grad_q[j][2] + stress_q[j][i] * grad_u[j][2];
            }
        }
        for (node, gradient) in result.iter_mut().zip(&point.gradients) {
            let moved = flux[0] * gradient[0] + flux[1] * gradient[1] + flux[2] * gradient[2];
            *node += point.volume * (energy * gradient[2] - moved);
        }
    }
    if material.formulation() == Formulation::MeanDilatation {
        mean_dilatation::add_height_derivative(&points, material.bulk_modulus(), u, q, &mut result);
    }
    result
}

/// ∂(K u)/∂x₃ of each of the eight nodes: one row of 24 nodal forces per node that moves, N per mm; the same derivative
/// as [`height_derivative`], for all q at once.
pub(crate) fn height_forces(nodes: &Nodes<f64>, material: &Material, u: &[f64; DOFS]) -> [[f64; DOFS]; 8] {
    let mut result = [[0.0; DOFS]; 8];
    let (lambda, mu) = (pointwise_lambda(material), material.shear_modulus());
    let points = gauss_points(nodes);
    for point in &points {
        let grad_u = displacement_gradient(point, u);
        let stress_u = stress(&grad_u, (lambda, mu));
        let along = grad_u.map(|row| row[2]);
        for (b, g) in point.gradients.iter().enumerate() {
            let work = g[0] * along[0] + g[1] * along[1] + g[2] * along[2];
            for k in 0..3 {
                // q is the unit vector of component k of node b: ∇q = e_k ⊗ g.
                let energy: f64 = (0..3).map(|j| stress_u[k][j] * g[j]).sum();
                let mut flux: [f64; 3] =
                    std::array::from_fn(|i| stress_u[k][i] * g[2] + lambda * g[k] * along[i] + mu * g[i] * along[k]);
                flux[k] += mu * work;
                for (row, moved) in result.iter_mut().zip(&point.gradients) {
                    let transported = flux[0] * moved[0] + flux[1] * moved[1] + flux[2] * moved[2];
                    row[3 * b + k] += point.volume * (energy * moved[2] - transported);
                }
            }
        }
    }
    if material.formulation() == Formulation::MeanDilatation {
        for dof in 0..DOFS {
            let unit: [f64; DOFS] = std::array::from_fn(|other| f64::from(u8::from(other == dof)));
            let mut column = [0.0; 8];
            mean_dilatation::add_height_derivative(&points, material.bulk_modulus(), u, &unit, &mut column);
            for (row, entry) in result.iter_mut().zip(column) {
                row[dof] += entry;
            }
        }
    }
    result
}

/// Stress λ tr(ε) I + 2 μ ε of a displacement gradient and (λ, μ) at a Gauss point, MPa.
pub fn stress(gradient: &[[f64; 3]; 3], (lambda, mu): (f64, f64)) -> [[f64; 3]; 3] {
    let volumetric = lambda * (gradient[0][0] + gradient[1][1] + gradient[2][2]);
    std::array::from_fn(|i| {
        std::array::from_fn(|j| mu * (gradient[i][j] + gradient[j][i]) + if i == j { volumetric } else { 0.0 })
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scalar::Dual;

    fn distorted() -> Nodes<f64> {
        std::array::from_fn(|a| {
            let (i, j, k) = ((a >> 2 & 1) as f64, (a >> 1 & 1) as f64, (a & 1) as f64);
            [2.0 * i, 1.5 * j, k * (1.0 + 0.2 * i - 0.1 * j + 0.15 * i * j) + 0.1 * i]
        })
    }

    /// Both formulations of one material.
    fn materials() -> [Material; 2] {
        let material = Material::new(1.1e5, 0.33).expect("valid material");
        [material, material.with_formulation(Formulation::MeanDilatation)]
    }

    fn vector(seed: f64) -> [f64; DOFS] {
        std::array::from_fn(|i| (seed * (i as f64 + 1.0)).sin())
    }

    /// The product K u.
    fn product(matrix: &[[f64; DOFS]; DOFS], u: &[f64; DOFS]) -> [f64; DOFS] {
        std::array::from_fn(|i| matrix[i].iter().zip(u).map(|(k, u)| k * u).sum())
    }

    #[test]
    fn rigid_motions_carry_no_force() {
        for material in materials() {
            let (nodes, matrix) = (distorted(), stiffness(&distorted(), &material));
            for axis in 0..3 {
                let mut rotation = [0.0; DOFS];
                for (a, x) in nodes.iter().enumerate() {
                    rotation[3 * a + (axis + 1) % 3] = -x[(axis + 2) % 3];
                    rotation[3 * a + (axis + 2) % 3] = x[(axis + 1) % 3];
                }
                let translation: [f64; DOFS] = std::array::from_fn(|dof| f64::from(u8::from(dof % 3 == axis)));
                for force in product(&matrix, &rotation).into_iter().chain(product(&matrix, &translation)) {
                    assert!(force.abs() < 1e-13 * material.young_modulus() * 6.0, "{force}");
                }
            }
        }
    }

    #[test]
    fn rigid_motions_are_the_whole_kernel() {
        for material in materials() {
            let matrix = stiffness(&distorted(), &material);
            let dense = nalgebra::DMatrix::from_fn(DOFS, DOFS, |i, j| matrix[i][j]);
            let mut values: Vec<f64> = dense.symmetric_eigen().eigenvalues.iter().copied().collect();
            values.sort_by(f64::total_cmp);
            assert!(values[5].abs() < 1e-12 * values[23] && values[6] > 1e-4 * values[23], "{values:?}");
        }
    }

    #[test]
    fn constant_strain_gives_the_forces_of_its_constant_stress() {
        // u = H x: nodal forces ∫ σ ∇N_a dV, the same in both formulations.
        let h = [[1e-3, 2e-4, -3e-4], [5e-4, -7e-4, 1e-4], [0.0, 6e-4, 4e-4]];
        let nodes = distorted();
        let u: [f64; DOFS] = std::array::from_fn(|dof| (0..3).map(|j| h[dof % 3][j] * nodes[dof / 3][j]).sum());
        let [standard, mean] = materials().map(|material| product(&stiffness(&nodes, &material), &u));
        let sigma = stress(&h, (materials()[0].lame_lambda(), materials()[0].shear_modulus()));
        for dof in 0..DOFS {
            let exact: f64 = gauss_points(&nodes)
                .iter()
                .map(|point| {
                    point.volume * (0..3).map(|j| sigma[dof % 3][j] * point.gradients[dof / 3][j]).sum::<f64>()
                })
                .sum();
            for force in [standard[dof], mean[dof]] {
                assert!((force - exact).abs() < 1e-12 * 150.0, "{force} {exact}");
            }
        }
    }

    #[test]
    fn forces_of_moved_nodes_do_the_work_of_the_height_derivative() {
        let (nodes, u, q) = (distorted(), vector(0.7), vector(1.3));
        for material in materials() {
            let forces = height_forces(&nodes, &material, &u);
            for (row, derivative) in forces.iter().zip(height_derivative(&nodes, &material, &u, &q)) {
                let work: f64 = row.iter().zip(&q).map(|(force, q)| force * q).sum();
                assert!((work - derivative).abs() < 1e-12 * derivative.abs().max(1e5), "{work} {derivative}");
            }
        }
    }

    #[test]
    fn height_derivative_equals_that_of_dual_numbers() {
        let (nodes, u, q) = (distorted(), vector(0.7), vector(1.3));
        for material in materials() {
            let closed = height_derivative(&nodes, &material, &u, &q);
            for (node, closed) in closed.iter().enumerate() {
                let mut moved = nodes.map(|x| x.map(Dual::constant));
                moved[node][2].derivative = 1.0;
                let matrix = stiffness(&moved, &material);
                let mut exact = 0.0;
                for (i, row) in matrix.iter().enumerate() {
                    for (j, entry) in row.iter().enumerate() {
                        exact += q[i] * entry.derivative * u[j];
                    }
                }
                assert!((closed - exact).abs() < 1e-12 * exact.abs().max(1e5), "{closed} {exact}");
            }
        }
    }
}
