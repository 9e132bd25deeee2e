//! One body of a solved shape, whatever solver found it.

use crate::body::elasticity::Material;
use crate::body::elasticity::hex8;
use crate::body::mesh::Block;
use crate::lattice;
use crate::linear::vector::dot;

/// Geometry and displacement of a body, and how the solver had torn it.
#[derive(Debug, Clone, PartialEq)]
pub struct SolvedBody {
    /// Grid and undeformed coordinates.
    pub block: Block,
    /// Displacement per node of the grid, mm; the mean over the torn copies of a node.
    pub displacement: Vec<[f64; 3]>,
    /// Largest over the nodes of √(Σ |copy − mean|²) over the copies, mm: how far the gluing is from being exact. Zero
    /// for a body that was not torn.
    pub gluing_defect: f64,
    /// Subdomain per brick, counted through all bodies, lower body first.
    pub subdomains: Vec<usize>,
}

impl SolvedBody {
    /// Strain energy ½ uᵀK u, N·mm.
    pub fn strain_energy(&self, material: &Material) -> f64 {
        let grid = &self.block.grid;
        let bricks = lattice::points([0; 3], grid.cells).map(|brick| {
            let corners = lattice::corners(brick).map(|corner| self.displacement[grid.node(corner)]);
            let u = corners.as_flattened();
            let stiffness = hex8::stiffness(&self.block.brick(brick), material);
            0.5 * stiffness.iter().zip(u).map(|(row, entry)| entry * dot(row, u)).sum::<f64>()
        });
        bricks.sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::body::mesh::Grid;

    /// ε₁₁ = 1e-3 everywhere: ½ (λ + 2μ) ε₁₁² times the volume.
    #[test]
    fn energy_of_a_uniform_strain() {
        let grid = Grid { cells: [3, 2, 2], size: [2.0, 3.0] };
        let columns = grid.column_count();
        let block = Block { grid, lower: vec![0.0; columns], upper: vec![5.0; columns] };
        let displacement =
            lattice::points([0; 3], grid.nodes()).map(|[i, j, _]| [1e-3 * grid.position(i, j)[0], 0.0, 0.0]).collect();
        let body = SolvedBody { subdomains: vec![0; grid.brick_count()], block, displacement, gluing_defect: 0.0 };
        let material = Material::new(2e5, 0.3).expect("a material");
        let modulus = material.lame_lambda() + 2.0 * material.shear_modulus();
        assert!((body.strain_energy(&material) / (0.5 * modulus * 1e-6 * 30.0) - 1.0).abs() < 1e-12);
    }
}
