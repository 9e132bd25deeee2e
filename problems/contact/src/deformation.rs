//! How far bodies are deformed, and how well shaped their bricks are: the largest values over all nodes and bricks.

use crate::body::elasticity::brick::{self, DOFS, Nodes};
use crate::body::mesh::Block;
use nalgebra::{Matrix3, SymmetricEigen};

/// Extreme values over some bodies.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Deformation {
    /// Largest length of a nodal displacement, mm.
    pub displacement: f64,
    /// Largest rotation at the centre of a brick, radians.
    pub rotation: f64,
    /// Largest modulus of a principal strain at the centre of a brick.
    pub strain: f64,
    /// Smallest scaled Jacobian det(edges)/Π|edges| at a corner of a brick: 1 for a box, 0 for a flat corner.
    pub scaled_jacobian: f64,
    /// Smallest edge of the bodies, mm: sides of the base, heights of columns of nodes.
    pub edge: f64,
}

impl Deformation {
    /// The deformation of no body.
    pub const NONE: Self =
        Self { displacement: 0.0, rotation: 0.0, strain: 0.0, scaled_jacobian: f64::INFINITY, edge: f64::INFINITY };

    /// The deformation of a body with a displacement per node, mm.
    pub fn of(block: &Block, displacement: &[[f64; 3]]) -> Self {
        let heights = block.upper.iter().zip(&block.lower).map(|(upper, lower)| upper - lower);
        let mut found = Self {
            displacement: displacement.iter().map(|u| u[0].hypot(u[1]).hypot(u[2])).fold(0.0, f64::max),
            edge: heights.fold(block.grid.size[0].min(block.grid.size[1]), f64::min),
            ..Self::NONE
        };
        for position in block.grid.bricks() {
            let (nodes, corners) = (block.brick(position), block.grid.brick_nodes(position));
            let u: [f64; DOFS] = std::array::from_fn(|dof| displacement[corners[dof / 3]][dof % 3]);
            let gradient = brick::displacement_gradient(&brick::sample(&nodes, [0.0; 3]), &u);
            let gradient = Matrix3::from_fn(|i, j| gradient[i][j]);
            let skew = (gradient - gradient.transpose()) * 0.5;
            let strain = SymmetricEigen::new((gradient + gradient.transpose()) * 0.5).eigenvalues.amax();
            found.rotation = found.rotation.max(skew[(2, 1)].hypot(skew[(0, 2)]).hypot(skew[(1, 0)]));
            found.strain = found.strain.max(strain);
            found.scaled_jacobian = found.scaled_jacobian.min(scaled_jacobian(&nodes));
        }
        found
    }

    /// The deformation of two groups of bodies together.
    #[must_use]
    pub fn and(self, other: Self) -> Self {
        Self {
            displacement: self.displacement.max(other.displacement),
            rotation: self.rotation.max(other.rotation),
            strain: self.strain.max(other.strain),
            scaled_jacobian: self.scaled_jacobian.min(other.scaled_jacobian),
            edge: self.edge.min(other.edge),
        }
    }
}

/// Smallest over the corners of a brick of det(edges)/Π|edges|.
fn scaled_jacobian(nodes: &Nodes<f64>) -> f64 {
    let corner = |a: usize| {
        let edges = [4, 2, 1].map(|bit| {
            let (from, to) = (nodes[a & !bit], nodes[a | bit]);
            nalgebra::Vector3::from_fn(|i, _| to[i] - from[i])
        });
        Matrix3::from_columns(&edges).determinant() / edges.iter().map(|edge| edge.norm()).product::<f64>()
    };
    (0..8).map(corner).fold(f64::INFINITY, f64::min)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::body::mesh::Grid;

    #[test]
    fn the_scaled_jacobian_is_one_for_a_box_and_falls_with_shear() {
        let box_at = |shear: f64| -> Nodes<f64> {
            std::array::from_fn(|a| {
                let [x, y, z] = [a >> 2 & 1, a >> 1 & 1, a & 1].map(|bit| bit as f64);
                [3.0 * x + shear * z, 2.0 * y, z]
            })
        };
        assert!((scaled_jacobian(&box_at(0.0)) - 1.0).abs() < 1e-15);
        assert!((scaled_jacobian(&box_at(1.0)) - 0.5_f64.sqrt()).abs() < 1e-15);
    }

    #[test]
    fn a_uniform_strain_is_found_as_it_is() {
        let grid = Grid { cells: [2, 3, 2], size: [4.0, 6.0] };
        let columns = grid.column_count();
        let block = Block { grid, lower: vec![1.0; columns], upper: vec![6.0; columns] };
        let [n1, n2, n3] = grid.nodes();
        let nodes = (0..n1 * n2 * n3).map(|node| block.coordinates([node / (n2 * n3), node / n3 % n2, node % n3]));
        // Compressed along x₃ by 3 %, stretched along x₁ by 2 %.
        let displacement: Vec<[f64; 3]> = nodes.map(|[x1, _, x3]| [0.02 * x1, 0.0, -0.03 * x3]).collect();
        let found = Deformation::NONE.and(Deformation::of(&block, &displacement));
        // Rounding of numbers near one.
        assert!((found.strain - 0.03).abs() < 1e-14 && found.rotation < 1e-14, "{found:?}");
        assert!((found.displacement - 0.08_f64.hypot(0.18)).abs() < 1e-14, "{found:?}");
        assert_eq!(found.edge, 4.0);
        assert!((block.volume() - 120.0).abs() < 1e-12);
    }
}
