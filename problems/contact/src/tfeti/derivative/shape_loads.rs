//! The forces that changes of the shape cause on the torn bodies.
//!
//! ```text
//! r = −∂(K u − f) per subdomain of shaped bodies, −Σ_rows λ_r ∂(w d_r) at the nodes of the rows,     δe = Rᵀ r
//! ```
//! The adjoint counterpart is [`shape_derivative`](super::shape_derivative()).

use crate::body::MOTIONS;
use crate::body::shape_force::shape_forces;
use crate::equilibrium::RowChange;
use crate::equilibrium::row_work::{changed_forces, side_forces};
use crate::equilibrium::trace_work::TraceChanges;
use crate::linear::entry::{Entry, LANES, Row, vectorized};
use crate::linear::parallel::for_parts;
use crate::linear::real::Real;
use crate::shape::Velocities;
use crate::tfeti::derivative::shape_derivative::SolvedShape;
use crate::tfeti::torn::{TornModel, TornSystem, parts_mut};

/// Torn forces and their resultants along the rigid motions, one column per change of the shape.
pub struct ShapeLoads<E, const N: usize> {
    /// r over the torn dofs of this process, N.
    pub forces: Vec<Row<E, N>>,
    /// δe of all clusters, N.
    pub resultants: Vec<Row<E, N>>,
}

impl<E: Real, const N: usize> ShapeLoads<E, N> {
    /// The loads of at most 8N fields of velocities, with the changes of the contact rows along them.
    pub fn new(
        model: &TornModel,
        system: &TornSystem,
        shape: SolvedShape<'_>,
        (velocities, traces): (&Velocities<'_>, Option<&TraceChanges<'_>>),
        changes: &[Vec<RowChange>],
    ) -> Self {
        debug_assert!(velocities.count() <= LANES * N);
        let mut forces = vec![Row::<E, N>::ZERO; model.interface.owned_count()];
        for_parts(parts_mut(&mut forces, &system.starts), &|index, forces| {
            let number = model.subdomains[index].body;
            if !model.problem.map.shapes(number) {
                return;
            }
            let (body, piece) = model.piece(index);
            let u = &shape.displacement.0[system.dofs(index)];
            let columns = shape_forces((number, body), piece, &shape.positions[number], u, velocities);
            for (dof, force) in forces.iter_mut().enumerate() {
                columns.iter().enumerate().for_each(|(column, values)| force.set(column, values[dof]));
            }
        });
        if !model.problem.geometry.is_fixed() {
            let scales = model.constraints.contact_scales(&model.problem.boundary);
            let lambda: Vec<f64> = shape.multipliers.contact().iter().zip(scales).map(|(row, nu)| row / nu).collect();
            let (rows, bodies) = ((&model.problem.boundary, shape.rows), model.problem.bodies.len());
            let sides = traces.map(|traces| (traces, side_forces(rows, &lambda, bodies)));
            for (column, changes) in changes.iter().enumerate() {
                let changed = changed_forces(rows, &lambda, changes, bodies);
                let mut add = |dof: usize, force: f64| {
                    let sum = forces[dof].get(column) + force;
                    forces[dof].set(column, sum);
                };
                model.spread_contact(&model.nodal_forces(shape.rows, &changed), &mut add);
                if let Some((traces, sides)) = &sides {
                    model.spread_contact(&traces.forces(column, sides), &mut add);
                }
            }
        }
        let mut resultants = vec![Row::<E, N>::ZERO; MOTIONS * system.parts.len()];
        for_parts(resultants.chunks_mut(MOTIONS), &|index, resultants| {
            let part = &system.parts[index];
            let forces = &forces[system.dofs(index)];
            vectorized(
                #[inline(always)]
                || {
                    for (resultant, mode) in resultants.iter_mut().zip(&part.modes) {
                        for (value, force) in mode.iter().zip(forces) {
                            resultant.accumulate(*value, force);
                        }
                    }
                },
            );
        });
        let resultants = model.clusters.gather(&system.cluster_resultants(resultants), MOTIONS);
        Self { forces, resultants }
    }
}
