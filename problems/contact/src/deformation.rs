//! How far bodies are deformed, and how well shaped their cells are: the largest values over all nodes and cells.

use crate::body::mesh::{Mesh, smallest_extent};
use nalgebra::{Matrix3, SymmetricEigen};

/// Extreme values over some bodies.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Deformation {
    /// Largest length of a nodal displacement, mm.
    pub displacement: f64,
    /// Largest rotation at the centre of a cell, radians.
    pub rotation: f64,
    /// Largest modulus of a principal strain at the centre of a cell.
    pub strain: f64,
    /// Smallest scaled Jacobian of a cell, det(edges)/Π|edges| at its worst corner: 1 for a box and for a regular
    /// tetrahedron, 0 for a flat corner.
    pub scaled_jacobian: f64,
    /// Smallest side of the boxes around the bodies, mm.
    pub extent: f64,
}

impl Deformation {
    /// The deformation of no body.
    pub const NONE: Self =
        Self { displacement: 0.0, rotation: 0.0, strain: 0.0, scaled_jacobian: f64::INFINITY, extent: f64::INFINITY };

    /// The deformation of a body with given positions and displacements of its nodes, mm.
    pub fn of(mesh: &Mesh, positions: &[[f64; 3]], displacement: &[[f64; 3]]) -> Self {
        let lengths = displacement.iter().map(|u| u[0].hypot(u[1]).hypot(u[2]));
        let mut found =
            Self { displacement: lengths.fold(0.0, f64::max), extent: smallest_extent(positions), ..Self::NONE };
        for cell in 0..mesh.cell_count() {
            let nodes = mesh.cell_nodes(cell, positions);
            let gradient = nodes.gradient(&mesh.cell_values(cell, displacement));
            let gradient = Matrix3::from_fn(|i, j| gradient[i][j]);
            let skew = (gradient - gradient.transpose()) * 0.5;
            let strain = SymmetricEigen::new((gradient + gradient.transpose()) * 0.5).eigenvalues.amax();
            found.rotation = found.rotation.max(skew[(2, 1)].hypot(skew[(0, 2)]).hypot(skew[(1, 0)]));
            found.strain = found.strain.max(strain);
            found.scaled_jacobian = found.scaled_jacobian.min(nodes.scaled_jacobian());
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
            extent: self.extent.min(other.extent),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::body::mesh::{Grid, block};

    #[test]
    fn a_uniform_strain_is_found_as_it_is() {
        let grid = Grid { cells: [2, 3, 2], corner: [0.0; 2], size: [4.0, 6.0] };
        let columns = grid.column_count();
        let mesh = block(&grid, [1; 3], &vec![1.0; columns], &vec![6.0; columns]).expect("a block");
        // Compressed along x₃ by 3 %, stretched along x₁ by 2 %.
        let displacement: Vec<[f64; 3]> = mesh.nodes().iter().map(|[x1, _, x3]| [0.02 * x1, 0.0, -0.03 * x3]).collect();
        let found = Deformation::NONE.and(Deformation::of(&mesh, mesh.nodes(), &displacement));
        // Rounding of numbers near one.
        assert!((found.strain - 0.03).abs() < 1e-14 && found.rotation < 1e-14, "{found:?}");
        assert!((found.displacement - 0.08_f64.hypot(0.18)).abs() < 1e-14, "{found:?}");
        assert_eq!(found.extent, 4.0);
        assert!((found.scaled_jacobian - 1.0).abs() < 1e-14);
    }
}
