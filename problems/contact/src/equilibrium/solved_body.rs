//! One body of a solved shape, whatever solver found it.

use crate::body::mesh::Block;

/// Geometry and displacement of a body, and how the solver had torn it.
#[derive(Debug, Clone, PartialEq)]
pub struct SolvedBody {
    /// Grid and undeformed coordinates.
    pub block: Block,
    /// Displacement per node of the grid, mm; the mean over the torn copies of a node.
    pub displacement: Vec<[f64; 3]>,
    /// Largest over the nodes of √(Σ |copy − mean|²) over the copies, mm: how far the gluing is from being exact. Zero for a
    /// body that was not torn.
    pub gluing_defect: f64,
    /// Subdomain per brick, counted through all bodies, lower body first.
    pub subdomains: Vec<usize>,
}
