//! Displacements and stresses of one body.

use crate::body::Body;
use crate::body::elasticity::stress::{SymmetricTensor, von_mises};
use crate::body::mesh::Mesh;
use crate::equilibrium::SolvedBody;
use crate::linear::parallel;
use std::sync::Arc;

/// Fields of one body over the nodes and cells of its mesh.
#[derive(Debug, Clone, PartialEq)]
pub struct BodyFields {
    /// Nodes, cells and names.
    pub mesh: Arc<Mesh>,
    /// Undeformed positions of the nodes, mm.
    pub positions: Arc<Vec<[f64; 3]>>,
    /// Displacement per node, mm.
    pub displacement: Vec<[f64; 3]>,
    /// How far the torn copies of a node are from their mean, mm; see [`SolvedBody::gluing_defect`].
    pub gluing_defect: f64,
    /// Stress per cell at its centre, MPa; components 11, 22, 33, 12, 23, 13.
    pub stress: Vec<SymmetricTensor>,
    /// Von Mises stress per cell at its centre, MPa.
    pub von_mises: Vec<f64>,
    /// Von Mises stress per node: mean over the adjoining cells, weighted by their volumes, MPa. On the boundary of the
    /// body, where the cells lie on one side, it is of first order only.
    pub nodal_von_mises: Vec<f64>,
    /// Subdomain per cell, counted through all bodies, lower body first.
    pub subdomain: Vec<usize>,
}

impl BodyFields {
    /// From the displacements of a body.
    pub fn new(solved: SolvedBody, body: &Body) -> Self {
        let SolvedBody { mesh, positions, displacement, gluing_defect, subdomains } = solved;
        let values: Vec<(SymmetricTensor, f64)> = parallel::map(mesh.cell_count(), &|cell| {
            let nodes = mesh.cell_nodes(cell, &positions);
            (nodes.stress(body.solid.material(cell), &mesh.cell_values(cell, &displacement)), nodes.volume())
        });
        let stress: Vec<SymmetricTensor> = values.iter().map(|(stress, _)| *stress).collect();
        let von_mises: Vec<f64> = stress.iter().map(von_mises).collect();
        let mut sums = vec![[0.0; 2]; mesh.node_count()];
        for (cell, ((_, volume), value)) in mesh.cells().zip(values.iter().zip(&von_mises)) {
            for &node in cell.nodes {
                sums[node as usize][0] += volume * value;
                sums[node as usize][1] += volume;
            }
        }
        let nodal_von_mises = sums.into_iter().map(|[value, volume]| value / volume).collect();
        Self { mesh, positions, displacement, gluing_defect, stress, von_mises, nodal_von_mises, subdomain: subdomains }
    }
}
