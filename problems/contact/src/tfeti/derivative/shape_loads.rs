//! The forces that changes of the column heights cause on the torn lower body.
//!
//! ```text
//! r = −∂(K u − f) per subdomain of the lower body,   δe = Rᵀ r
//! ```
//! The adjoint counterpart is [`height_sensitivities`](super::height_sensitivities).

use crate::body::mesh::Block;
use crate::body::shape_force::shape_forces;
use crate::linear::entry::{Entry, LANES, Row, vectorized};
use crate::linear::real::Real;
use crate::tfeti::torn::{TornModel, TornSystem, TornVector};
use rayon::prelude::*;

/// Torn forces and their resultants along the rigid motions, one column per change of the heights.
pub struct ShapeLoads<E, const N: usize> {
    /// r over the torn dofs of this process, N.
    pub forces: Vec<Row<E, N>>,
    /// δe of all clusters, N.
    pub resultants: Vec<Row<E, N>>,
}

impl<E: Real, const N: usize> ShapeLoads<E, N> {
    /// The loads of at most 8N changes (mm, all columns of the body); `lower` is the lower body, `displacement` is u.
    pub fn new(
        model: &TornModel,
        system: &TornSystem,
        lower: &Block,
        displacement: &TornVector,
        changes: &[Vec<f64>],
    ) -> Self {
        debug_assert!(changes.len() <= LANES * N);
        let scene = &model.problem.scene.lower;
        let mut forces = vec![Row::ZERO; model.interface.owned_count()];
        let mut resultants = vec![Row::ZERO; 6 * system.parts.len()];
        let parts = forces.par_chunks_mut(model.pattern.pattern.dimension()).zip(resultants.par_chunks_mut(6));
        parts.zip(model.subdomains.par_iter().zip(&system.parts)).for_each(
            |((forces, resultants), (subdomain, part))| {
                if subdomain.body != 0 {
                    return;
                }
                let u = &displacement.0[subdomain.first_dof..subdomain.first_dof + forces.len()];
                let columns = shape_forces(lower, &subdomain.place, &scene.material, &scene.loads, u, changes);
                for (dof, force) in forces.iter_mut().enumerate() {
                    columns.iter().enumerate().for_each(|(column, values)| force.set(column, values[dof]));
                }
                vectorized(
                    #[inline(always)]
                    || {
                        for (resultant, mode) in resultants.iter_mut().zip(&part.modes) {
                            for (value, force) in mode.iter().zip(&*forces) {
                                resultant.accumulate(*value, force);
                            }
                        }
                    },
                );
            },
        );
        let resultants = model.clusters.gather(&system.cluster_resultants(resultants), 6);
        Self { forces, resultants }
    }
}
