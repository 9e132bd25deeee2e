//! The nodes of one cell of either kind, and what the kernels make of them.

use crate::body::elasticity::packed::lower_start;
use crate::body::elasticity::stress::{StressedPoint, SymmetricTensor, stress_at, von_mises_at};
use crate::body::elasticity::{GaussPoint, Material, hex8, stiffness, tet10};
use crate::scalar::Scalar;

/// Positions of the nodes of a cell, mm.
#[derive(Debug, Clone, Copy)]
pub enum CellNodes<T> {
    /// Trilinear hexahedron.
    Hex8([[T; 3]; 8]),
    /// Tetrahedron of second order.
    Tet10([[T; 3]; 10]),
}

/// Von Mises stress at the centre of a cell and its volume, with their derivatives per node and component.
#[derive(Debug, Clone)]
pub struct StressedCell {
    /// σ_vM at the centre, MPa.
    pub stress: f64,
    /// ∂σ_vM/∂u, MPa/mm.
    pub by_displacement: Vec<[f64; 3]>,
    /// ∂σ_vM/∂x at fixed displacements, MPa/mm.
    pub by_position: Vec<[f64; 3]>,
    /// V, mm³.
    pub volume: f64,
    /// ∂V/∂x, mm².
    pub volume_by_position: Vec<[f64; 3]>,
}

/// Von Mises stress at a point of a cell, with its derivatives per node and component.
#[derive(Debug, Clone)]
pub struct PointStress {
    /// σ_vM, MPa.
    pub stress: f64,
    /// ∂σ_vM/∂u, MPa/mm.
    pub by_displacement: Vec<[f64; 3]>,
    /// ∂σ_vM/∂x at fixed displacements, MPa/mm.
    pub by_position: Vec<[f64; 3]>,
}

/// Evaluates an expression for the integration points of a cell of either kind.
macro_rules! with_points {
    ($cell:expr, |$points:ident| $value:expr) => {
        match $cell {
            CellNodes::Hex8(nodes) => {
                let $points = &hex8::gauss_points(nodes);
                $value
            }
            CellNodes::Tet10(nodes) => {
                let $points = &tet10::gauss_points(nodes);
                $value
            }
        }
    };
}

impl<T: Scalar> CellNodes<T> {
    /// Stiffness matrix as its lower triangle by rows, N/mm; dof 3v + component.
    pub fn stiffness(&self, material: &Material) -> Vec<T> {
        with_points!(self, |points| stiffness::stiffness(points, material))
    }

    /// Volume, mm³.
    pub fn volume(&self) -> T {
        let mut volume = T::constant(0.0);
        with_points!(self, |points| points.iter().for_each(|point| volume += point.volume));
        volume
    }

    /// ∫N_v dV per node, mm³.
    pub fn node_volumes(&self) -> Vec<T> {
        fn sums<T: Scalar, const N: usize>(points: &[GaussPoint<T, N>], values: impl Fn(usize) -> [f64; N]) -> Vec<T> {
            let mut sums = vec![T::constant(0.0); N];
            for (index, point) in points.iter().enumerate() {
                for (sum, value) in sums.iter_mut().zip(values(index)) {
                    *sum += point.volume * T::constant(value);
                }
            }
            sums
        }
        match self {
            Self::Hex8(nodes) => sums(&hex8::gauss_points(nodes), hex8::values),
            Self::Tet10(nodes) => sums(&tet10::gauss_points(nodes), tet10::values),
        }
    }

    /// The positions.
    pub fn positions(&self) -> &[[T; 3]] {
        match self {
            Self::Hex8(nodes) => nodes,
            Self::Tet10(nodes) => nodes,
        }
    }
}

impl CellNodes<f64> {
    /// The smallest det(∂x/∂ξ) at the integration points, and at the corners of a hexahedron, where it folds first; mm³
    /// from the reference cell, not finite for bad positions.
    pub fn smallest_determinant(&self) -> f64 {
        let smallest = |volumes: &mut dyn Iterator<Item = f64>| {
            volumes.fold(
                f64::INFINITY,
                |smallest, volume| if volume < smallest || volume.is_nan() { volume } else { smallest },
            )
        };
        match self {
            Self::Hex8(nodes) => {
                let points = hex8::gauss_points(nodes).into_iter().chain(hex8::corners(nodes));
                smallest(&mut points.map(|point| point.volume))
            }
            Self::Tet10(nodes) => 24.0 * smallest(&mut tet10::gauss_points(nodes).iter().map(|point| point.volume)),
        }
    }

    /// ∫|∇N_v|² dV per node, mm: its share in the stiffness of the body, for materials of shear modulus 1.
    pub fn node_stiffness(&self) -> Vec<f64> {
        with_points!(self, |points| {
            let mut sums = vec![0.0; self.positions().len()];
            for point in points {
                for (sum, gradient) in sums.iter_mut().zip(&point.gradients) {
                    *sum += point.volume * gradient.iter().map(|g| g * g).sum::<f64>();
                }
            }
            sums
        })
    }

    /// ∂V/∂x per node, mm².
    pub fn volume_derivative(&self) -> Vec<[f64; 3]> {
        with_points!(self, |points| {
            let mut result = vec![[0.0; 3]; self.positions().len()];
            for point in points {
                for (entry, gradient) in result.iter_mut().zip(&point.gradients) {
                    entry.iter_mut().zip(gradient).for_each(|(entry, g)| *entry += point.volume * g);
                }
            }
            result
        })
    }

    /// ∂(qᵀK u)/∂x per node; method.md (5.2).
    pub fn position_derivative(&self, material: &Material, u: &[f64], q: &[f64]) -> Vec<[f64; 3]> {
        with_points!(self, |points| stiffness::position_derivative(points, material, u, q).to_vec())
    }

    /// Adds ∂(K u)[x′] for each of several fields of nodal velocities x′ to its forces.
    pub fn add_moved_forces<'a>(
        &self,
        material: &Material,
        u: &[f64],
        fields: impl Iterator<Item = (&'a [f64], &'a mut [f64])>,
    ) {
        with_points!(self, |points| {
            for (velocities, forces) in fields {
                stiffness::add_moved_forces(points, material, u, velocities, forces);
            }
        });
    }

    /// Stress at the centre, MPa.
    pub fn stress(&self, material: &Material, u: &[f64]) -> SymmetricTensor {
        match self {
            Self::Hex8(nodes) => stress_at(&hex8::centre(nodes), &hex8::gauss_points(nodes), material, u),
            Self::Tet10(nodes) => stress_at(&tet10::centre(nodes), &tet10::gauss_points(nodes), material, u),
        }
    }

    /// σ_vM at the centre, MPa.
    pub fn von_mises(&self, shear_modulus: f64, u: &[f64]) -> f64 {
        match self {
            Self::Hex8(nodes) => von_mises_at(&hex8::centre(nodes), shear_modulus, u),
            Self::Tet10(nodes) => von_mises_at(&tet10::centre(nodes), shear_modulus, u),
        }
    }

    /// σ_vM at the integration points, MPa.
    pub fn point_stresses(&self, shear_modulus: f64, u: &[f64]) -> Vec<f64> {
        with_points!(self, |points| points.iter().map(|point| von_mises_at(point, shear_modulus, u)).collect())
    }

    /// Von Mises stress at an integration point, by its number, with its derivatives.
    pub fn stressed_at(&self, point: usize, shear_modulus: f64, u: &[f64]) -> PointStress {
        with_points!(self, |points| {
            let found = StressedPoint::new(&points[point], shear_modulus, u);
            let (by_displacement, by_position) = (found.by_displacement.to_vec(), found.by_position.to_vec());
            PointStress { stress: found.stress, by_displacement, by_position }
        })
    }

    /// The largest σ_vM over the integration points, MPa, and where it is, mm.
    pub fn largest_von_mises(&self, shear_modulus: f64, u: &[f64]) -> (f64, [f64; 3]) {
        let values = |point: usize| match self {
            Self::Hex8(_) => hex8::values(point).to_vec(),
            Self::Tet10(_) => tet10::values(point).to_vec(),
        };
        let place = |point: usize| -> [f64; 3] {
            let shares = values(point);
            std::array::from_fn(|axis| shares.iter().zip(self.positions()).map(|(share, x)| share * x[axis]).sum())
        };
        let stresses = self.point_stresses(shear_modulus, u);
        let largest = (0..stresses.len()).max_by(|a, b| stresses[*a].total_cmp(&stresses[*b])).unwrap_or(0);
        (stresses[largest], place(largest))
    }

    /// K u of the nodes, N; three entries per node.
    pub fn forces(&self, material: &Material, u: &[f64]) -> Vec<f64> {
        let (stiffness, mut forces) = (self.stiffness(material), vec![0.0; u.len()]);
        for row in 0..u.len() {
            for column in 0..=row {
                let entry = stiffness[lower_start(row) + column];
                forces[row] += entry * u[column];
                forces[column] += if column == row { 0.0 } else { entry * u[row] };
            }
        }
        forces
    }

    /// Von Mises stress at the centre and volume, with their derivatives.
    pub fn stressed(&self, shear_modulus: f64, u: &[f64]) -> StressedCell {
        let with = |stress, by_displacement: &[[f64; 3]], by_position: &[[f64; 3]]| StressedCell {
            stress,
            by_displacement: by_displacement.to_vec(),
            by_position: by_position.to_vec(),
            volume: self.volume(),
            volume_by_position: self.volume_derivative(),
        };
        match self {
            Self::Hex8(nodes) => {
                let StressedPoint { stress, by_displacement, by_position } =
                    StressedPoint::new(&hex8::centre(nodes), shear_modulus, u);
                with(stress, &by_displacement, &by_position)
            }
            Self::Tet10(nodes) => {
                let StressedPoint { stress, by_displacement, by_position } =
                    StressedPoint::new(&tet10::centre(nodes), shear_modulus, u);
                with(stress, &by_displacement, &by_position)
            }
        }
    }

    /// ∂u_j/∂x_i as `[j][i]` at the centre.
    pub fn gradient(&self, u: &[f64]) -> [[f64; 3]; 3] {
        match self {
            Self::Hex8(nodes) => hex8::centre(nodes).gradient(u),
            Self::Tet10(nodes) => tet10::centre(nodes).gradient(u),
        }
    }

    /// Smallest over the corners of det(edges)/Π|edges|, scaled to 1 for a cube and for a regular tetrahedron.
    pub fn scaled_jacobian(&self) -> f64 {
        let corner = |nodes: &[[f64; 3]], at: usize, ends: [usize; 3]| {
            let edges = ends.map(|end| nalgebra::Vector3::from_fn(|i, _| nodes[end][i] - nodes[at][i]));
            nalgebra::Matrix3::from_columns(&edges).determinant()
                / edges.iter().map(|edge| edge.norm()).product::<f64>()
        };
        match self {
            Self::Hex8(nodes) => {
                let neighbours =
                    [[1, 3, 4], [2, 0, 5], [3, 1, 6], [0, 2, 7], [7, 5, 0], [4, 6, 1], [5, 7, 2], [6, 4, 3]];
                (0..8).map(|at| corner(nodes, at, neighbours[at])).fold(f64::INFINITY, f64::min)
            }
            Self::Tet10(nodes) => {
                let others = [[1, 2, 3], [2, 0, 3], [0, 1, 3], [2, 1, 0]];
                (0..4).map(|at| corner(nodes, at, others[at])).fold(f64::INFINITY, f64::min) * 2.0_f64.sqrt()
            }
        }
    }
}
