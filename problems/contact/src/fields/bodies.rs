//! Displacements and stresses of one body.

use crate::body::elasticity::Material;
use crate::body::elasticity::brick::{self, DOFS};
use crate::body::elasticity::stress::{BrickStress, SymmetricTensor, von_mises};
use crate::body::mesh::Block;
use crate::equilibrium::SolvedBody;
use rayon::prelude::*;

/// Fields of one body. Nodes and bricks are numbered as in [`crate::body::mesh::Grid`].
#[derive(Debug, Clone, PartialEq)]
pub struct BodyFields {
    /// Grid and undeformed coordinates, mm.
    pub block: Block,
    /// Displacement per node, mm.
    pub displacement: Vec<[f64; 3]>,
    /// How far the torn copies of a node are from their mean, mm; see [`SolvedBody::gluing_defect`].
    pub gluing_defect: f64,
    /// Stress per brick at its centre, MPa; components 11, 22, 33, 12, 23, 13.
    pub stress: Vec<SymmetricTensor>,
    /// Von Mises stress per brick at its centre, MPa.
    pub von_mises: Vec<f64>,
    /// Von Mises stress per node: mean over the adjoining bricks, weighted by their volumes, MPa. On the boundary of
    /// the body, where the bricks lie on one side, it is of first order only.
    pub nodal_von_mises: Vec<f64>,
    /// Subdomain per brick, counted through all bodies, lower body first.
    pub subdomain: Vec<usize>,
}

impl BodyFields {
    /// From the displacements of a body.
    pub fn new(body: SolvedBody, material: &Material) -> Self {
        let SolvedBody { block, displacement, gluing_defect, subdomains } = body;
        let grid = block.grid;
        let bricks: Vec<[usize; 3]> = grid.bricks().collect();
        let values: Vec<(SymmetricTensor, f64)> = bricks
            .par_iter()
            .map(|&brick| {
                let (coordinates, corners) = (block.brick(brick), grid.brick_nodes(brick));
                let u: [f64; DOFS] = std::array::from_fn(|dof| displacement[corners[dof / 3]][dof % 3]);
                (BrickStress::new(&coordinates, material, &u).at_centre(), brick::volume(&coordinates))
            })
            .collect();
        let stress: Vec<SymmetricTensor> = values.iter().map(|(stress, _)| *stress).collect();
        let von_mises: Vec<f64> = stress.iter().map(von_mises).collect();
        let mut sums = vec![[0.0; 2]; grid.node_count()];
        for ((&brick, (_, volume)), value) in bricks.iter().zip(&values).zip(&von_mises) {
            for node in grid.brick_nodes(brick) {
                sums[node][0] += volume * value;
                sums[node][1] += volume;
            }
        }
        let nodal_von_mises = sums.into_iter().map(|[value, volume]| value / volume).collect();
        Self { block, displacement, gluing_defect, stress, von_mises, nodal_von_mises, subdomain: subdomains }
    }
}
