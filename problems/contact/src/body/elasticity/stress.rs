//! Stress of a brick from the displacements of its eight nodes.
//!
//! ```text
//! standard:         σ = λ tr(ε) I + 2μ ε                          at the point
//! mean dilatation:  σ = κ θ̄ I + 2μ (ε − ⅓ tr(ε) I),  θ̄ = D(u)/V  over the brick      (mean_dilatation.rs)
//! σ_vM = √( ½[(σ₁₁ − σ₂₂)² + (σ₂₂ − σ₃₃)² + (σ₃₃ − σ₁₁)²] + 3(σ₁₂² + σ₂₃² + σ₁₃²) )              [Mises1913]
//! ```
//! At the centre of a trilinear brick the stress converges one order faster than elsewhere \[Barlow1976\], so that is
//! where it is taken for pictures. Tensors are six numbers in the order 11, 22, 33, 12, 23, 13.

use crate::body::elasticity::brick::{DOFS, GaussPoint, Nodes, displacement_gradient, gauss_points, sample};
use crate::body::elasticity::{Formulation, Material, hex8, mean_dilatation};

/// A symmetric tensor as its components 11, 22, 33, 12, 23, 13.
pub type SymmetricTensor = [f64; 6];

/// Row and column of each of the six components.
pub const COMPONENTS: [(usize, usize); 6] = [(0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (0, 2)];

/// Stress of one brick, consistent with its stiffness matrix.
#[derive(Debug, Clone, Copy)]
pub struct BrickStress<'a> {
    nodes: &'a Nodes<f64>,
    u: &'a [f64; DOFS],
    lame: (f64, f64),
    /// κ θ̄ for bricks whose volumetric part is a mean, MPa.
    mean_pressure: f64,
}

impl<'a> BrickStress<'a> {
    /// Of a brick with the given nodes (mm) and nodal displacements (mm), dof 3a + component.
    pub fn new(nodes: &'a Nodes<f64>, material: &Material, u: &'a [f64; DOFS]) -> Self {
        let mean_pressure = match material.formulation() {
            Formulation::Standard => 0.0,
            Formulation::MeanDilatation => material.bulk_modulus() * mean_dilatation::mean(&gauss_points(nodes), u),
        };
        Self { nodes, u, lame: (hex8::pointwise_lambda(material), material.shear_modulus()), mean_pressure }
    }

    /// Stress at the centre, MPa.
    pub(crate) fn at_centre(&self) -> SymmetricTensor {
        self.at(&sample(self.nodes, [0.0; 3]))
    }

    /// Stress at the eight Gauss points and their volumes: MPa, mm³. Forces of the brick are Σ V σ ∇N_a over them.
    pub fn at_gauss_points(&self) -> [(SymmetricTensor, GaussPoint<f64>); 8] {
        gauss_points(self.nodes).map(|point| (self.at(&point), point))
    }

    fn at(&self, point: &GaussPoint<f64>) -> SymmetricTensor {
        let full = hex8::stress(&displacement_gradient(point, self.u), self.lame);
        COMPONENTS.map(|(row, column)| full[row][column] + if row == column { self.mean_pressure } else { 0.0 })
    }
}

/// Von Mises stress, in the unit of the tensor.
pub fn von_mises(stress: &SymmetricTensor) -> f64 {
    let [s11, s22, s33, s12, s23, s13] = *stress;
    let normal = (s11 - s22).powi(2) + (s22 - s33).powi(2) + (s33 - s11).powi(2);
    let shear = s12.powi(2) + s23.powi(2) + s13.powi(2);
    (0.5 * normal + 3.0 * shear).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    type Matrix = nalgebra::Matrix3<f64>;

    /// A brick without a right angle, all eight nodes moved.
    fn distorted() -> Nodes<f64> {
        std::array::from_fn(|a| {
            let (i, j, k) = ((a >> 2 & 1) as f64, (a >> 1 & 1) as f64, (a & 1) as f64);
            let moved = |seed: f64| 0.12 * (seed * (a as f64 + 1.0)).sin();
            [2.0 * i + moved(1.1), 1.5 * j + moved(2.3), k + moved(0.7)]
        })
    }

    fn materials() -> [Material; 2] {
        let material = Material::new(1.1e5, 0.33).expect("valid material");
        [material, material.with_formulation(Formulation::MeanDilatation)]
    }

    /// u = H x + t.
    fn linear(nodes: &Nodes<f64>, h: &Matrix, t: [f64; 3]) -> [f64; DOFS] {
        std::array::from_fn(|dof| t[dof % 3] + (0..3).map(|j| h[(dof % 3, j)] * nodes[dof / 3][j]).sum::<f64>())
    }

    fn full(stress: &SymmetricTensor) -> Matrix {
        let mut matrix = Matrix::zeros();
        for (value, (row, column)) in stress.iter().zip(COMPONENTS) {
            (matrix[(row, column)], matrix[(column, row)]) = (*value, *value);
        }
        matrix
    }

    fn six(matrix: &Matrix) -> SymmetricTensor {
        COMPONENTS.map(|index| matrix[index])
    }

    #[test]
    fn von_mises_of_pure_states() {
        assert_eq!(von_mises(&[7.0, 7.0, 7.0, 0.0, 0.0, 0.0]), 0.0);
        for axis in 0..3 {
            let (mut pull, mut shear) = ([0.0; 6], [0.0; 6]);
            (pull[axis], shear[3 + axis]) = (-40.0, 40.0);
            assert!((von_mises(&pull) - 40.0).abs() < 1e-13);
            assert!((von_mises(&shear) - 40.0 * 3.0_f64.sqrt()).abs() < 1e-13);
        }
    }

    #[test]
    fn linear_displacement_has_its_constant_stress_everywhere() {
        let h = Matrix::new(1e-3, 2e-4, -3e-4, 5e-4, -7e-4, 1e-4, 0.0, 6e-4, 4e-4);
        let nodes = distorted();
        let u = linear(&nodes, &h, [0.3, -0.2, 0.1]);
        for material in materials() {
            let strain = 0.5 * (h + h.transpose());
            let exact = six(&(Matrix::identity() * (material.lame_lambda() * h.trace())
                + strain * (2.0 * material.shear_modulus())));
            let stress = BrickStress::new(&nodes, &material, &u);
            let found = stress.at_gauss_points().map(|(stress, _)| stress);
            for stress in found.iter().chain([&stress.at_centre()]) {
                for (found, exact) in stress.iter().zip(exact) {
                    // Rounding of displacements of size 0.3 over lengths of size 1.
                    assert!((found - exact).abs() < 1e-14 * material.young_modulus() * 10.0, "{found} {exact}");
                }
            }
        }
    }

    #[test]
    fn energy_of_the_stress_is_that_of_the_stiffness_matrix() {
        let nodes = distorted();
        let u: [f64; DOFS] = std::array::from_fn(|dof| (1.7 * (dof as f64 + 1.0)).sin());
        for material in materials() {
            let matrix = hex8::stiffness(&nodes, &material);
            let quadratic: f64 =
                (0..DOFS).map(|i| (0..DOFS).map(|j| 0.5 * u[i] * matrix[i][j] * u[j]).sum::<f64>()).sum();
            let mut sum = 0.0;
            for (stress, point) in BrickStress::new(&nodes, &material, &u).at_gauss_points() {
                let gradient = displacement_gradient(&point, &u);
                let stress = full(&stress);
                let density: f64 =
                    (0..9).map(|entry| stress[(entry / 3, entry % 3)] * gradient[entry / 3][entry % 3]).sum();
                sum += 0.5 * point.volume * density;
            }
            assert!((sum / quadratic - 1.0).abs() < 1e-12, "{sum} {quadratic}");
        }
    }

    #[test]
    fn nodal_forces_of_the_stress_are_those_of_the_stiffness_matrix() {
        let nodes = distorted();
        let u: [f64; DOFS] = std::array::from_fn(|dof| (0.9 * (dof as f64 + 2.0)).cos());
        for material in materials() {
            let matrix = hex8::stiffness(&nodes, &material);
            let points = BrickStress::new(&nodes, &material, &u).at_gauss_points();
            let largest = matrix.iter().flatten().fold(0.0, |largest: f64, entry| largest.max(entry.abs()));
            for dof in 0..DOFS {
                let product: f64 = matrix[dof].iter().zip(&u).map(|(k, u)| k * u).sum();
                let force = |(stress, point): &(SymmetricTensor, GaussPoint<f64>)| {
                    let stress = full(stress);
                    point.volume * (0..3).map(|j| stress[(dof % 3, j)] * point.gradients[dof / 3][j]).sum::<f64>()
                };
                let sum: f64 = points.iter().map(force).sum();
                assert!((sum - product).abs() < 1e-13 * largest * 24.0, "{dof}: {sum} {product}");
            }
        }
    }

    proptest! {
        #[test]
        fn rigid_motions_carry_no_stress(
            spin in prop::array::uniform3(-1.0_f64..1.0), shift in prop::array::uniform3(-5.0_f64..5.0),
        ) {
            let h = Matrix::new(0.0, -spin[2], spin[1], spin[2], 0.0, -spin[0], -spin[1], spin[0], 0.0);
            let nodes = distorted();
            let u = linear(&nodes, &h, shift);
            for material in materials() {
                for value in BrickStress::new(&nodes, &material, &u).at_centre() {
                    // Rounding of displacements up to 8 over lengths of size 1.
                    prop_assert!(value.abs() < 1e-14 * material.young_modulus() * 40.0, "{value}");
                }
            }
        }

        #[test]
        fn von_mises_does_not_see_rotations(
            stress in prop::array::uniform6(-1e3_f64..1e3), angles in prop::array::uniform3(-3.0_f64..3.0),
        ) {
            let rotation = nalgebra::Rotation3::from_euler_angles(angles[0], angles[1], angles[2]);
            let turned = rotation.matrix() * full(&stress) * rotation.matrix().transpose();
            prop_assert!((von_mises(&six(&turned)) - von_mises(&stress)).abs() < 1e-10);
        }

        #[test]
        fn the_field_turns_with_the_brick(
            angles in prop::array::uniform3(-3.0_f64..3.0), seed in 0.1_f64..3.0,
        ) {
            let rotation = nalgebra::Rotation3::from_euler_angles(angles[0], angles[1], angles[2]);
            let (nodes, material) = (distorted(), materials()[1]);
            let u: [f64; DOFS] = std::array::from_fn(|dof| (seed * (dof as f64 + 1.0)).sin());
            let turn = |x: [f64; 3]| <[f64; 3]>::from(rotation * nalgebra::Vector3::from(x));
            let turned_nodes = nodes.map(turn);
            let parts: Vec<[f64; 3]> = (0..8).map(|a| turn([u[3 * a], u[3 * a + 1], u[3 * a + 2]])).collect();
            let turned_u: [f64; DOFS] = std::array::from_fn(|dof| parts[dof / 3][dof % 3]);
            let before = full(&BrickStress::new(&nodes, &material, &u).at_centre());
            let after = full(&BrickStress::new(&turned_nodes, &material, &turned_u).at_centre());
            let expected = rotation.matrix() * before * rotation.matrix().transpose();
            prop_assert!((after - expected).abs().max() < 1e-12 * 1e6, "{after} {expected}");
        }
    }
}
