//! One body of a solved shape, whatever solver found it.

use crate::body::Body;
use crate::body::elasticity::packed::lower_start;
use crate::body::mesh::Mesh;
use std::sync::Arc;

/// Geometry and displacement of a body, and how the solver had torn it.
#[derive(Debug, Clone, PartialEq)]
pub struct SolvedBody {
    /// Nodes, cells and names.
    pub mesh: Arc<Mesh>,
    /// Undeformed positions of the nodes, mm.
    pub positions: Arc<Vec<[f64; 3]>>,
    /// Displacement per node, mm; the mean over the torn copies of a node.
    pub displacement: Vec<[f64; 3]>,
    /// Largest over the nodes of √(Σ |copy − mean|²) over the copies, mm: how far the gluing is from being exact. Zero
    /// for a body that was not torn.
    pub gluing_defect: f64,
    /// Subdomain per cell, counted through all bodies, lower body first.
    pub subdomains: Vec<usize>,
}

impl SolvedBody {
    /// Strain energy ½ uᵀK u, N·mm.
    pub fn strain_energy(&self, body: &Body) -> f64 {
        let energy = |cell: usize| {
            let u = self.mesh.cell_values(cell, &self.displacement);
            let stiffness = self.mesh.cell_nodes(cell, &self.positions).stiffness(body.solid.material(cell));
            let row = |row: usize| {
                let entries = &stiffness[lower_start(row)..=lower_start(row) + row];
                let product: f64 = entries.iter().zip(&u).map(|(k, u)| k * u).sum();
                // The entries above the diagonal are those below it.
                u[row] * (product - 0.5 * entries[row] * u[row])
            };
            (0..u.len()).map(row).sum::<f64>()
        };
        (0..self.mesh.cell_count()).map(energy).sum()
    }
}
