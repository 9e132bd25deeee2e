//! How a shape enters a condensed state: sums over cells, and the contact rows.
//!
//! ```text
//! ∂J/∂x = −pᵀ (∂K u − ∂f)/∂x − Σ_rows (λ_r p + η_r u)·∂d_r/∂x + Σ_nodes η_N ∂gap/∂x
//! r = −∂(K u − f),   −Σ_rows λ_r ∂d_r at the contact nodes;     ∂d_r·u − ∂gap over the rows
//! ```
//! In sums over rows, u and p are the displacements of a contact node less those of its partner.

use crate::body::shape_force::shape_forces;
use crate::body::shape_sensitivity::position_sensitivities;
use crate::direct::adjoint::CondensedAdjoint;
use crate::direct::compliant_contact::CompliantContact;
use crate::direct::solver::{DirectSolver, DirectState};
use crate::direct::tangents::ShapeLoads;
use crate::equilibrium::{RowChange, RowSensitivities};
use crate::linear::vector::add_scaled;
use crate::shape::Velocities;
use faer::Mat;

impl DirectSolver {
    /// ∂J/∂x per node of the lower body, from its displacements u and their adjoint p.
    pub(super) fn shape_derivative(
        &self,
        state: &DirectState,
        displacements: [&[f64]; 2],
        adjoint: &CondensedAdjoint,
    ) -> Vec<[f64; 3]> {
        let (problem, contact) = (&self.problem, &state.contact);
        let (body, piece) = (&problem.bodies[0], &self.patterns[0].piece);
        let mut result = vec![[0.0; 3]; body.mesh.node_count()];
        let moves = |node| problem.map.moves(node);
        for (node, value) in position_sensitivities(body, piece, &state.positions[0], displacements, moves) {
            (0..3).for_each(|axis| result[node as usize][axis] += value[axis]);
        }
        let eta = &adjoint.multipliers;
        let points = problem.boundary.points.iter();
        let mut rows: Vec<RowSensitivities> =
            points.map(|point| RowSensitivities { gap: eta[point.start], ..RowSensitivities::default() }).collect();
        if !problem.geometry.is_fixed() {
            let lambda = &state.solution.forces;
            let u = contact_values(contact, &state.contact_displacements());
            let p = contact_values(contact, &adjoint.displacements);
            for (index, (own, point)) in rows.iter_mut().zip(&problem.boundary.points).enumerate() {
                let of_row = |row: usize| {
                    std::array::from_fn(|axis| -(lambda[row] * p[index][axis] + eta[row] * u[index][axis]))
                };
                own.directions = point.rows().map(of_row).collect();
            }
        }
        contact.rows.pull_back(&problem.boundary, &rows, &mut result);
        result
    }

    /// −∂(K u − f) over the lower body in the coordinates of its nodes, 0 at held dofs, N, one column per field of
    /// velocities.
    pub(super) fn shape_forces(&self, state: &DirectState, velocities: &Velocities<'_>) -> Mat<f64> {
        let (body, piece) = (&self.problem.bodies[0], &self.patterns[0].piece);
        let mut forces = shape_forces(body, piece, &state.positions[0], state.displacement(0), velocities);
        let axes = &self.patterns[0].axes;
        forces.iter_mut().for_each(|forces| axes.free_forces(forces));
        Mat::from_fn(piece.dof_count(), forces.len(), |dof, column| forces[column][dof])
    }

    /// What fields of velocities do to the contact problem, given their [`shape_forces`](Self::shape_forces).
    pub(super) fn shape_loads(&self, state: &DirectState, velocities: &Velocities<'_>, forces: Mat<f64>) -> ShapeLoads {
        let (problem, contact) = (&self.problem, &state.contact);
        let of_column = |column| contact.rows.changes(&problem.boundary, velocities, column);
        let changes: Vec<Vec<RowChange>> = (0..velocities.count()).map(of_column).collect();
        let sizes = contact.bodies.iter().map(|body| body.load.free.len());
        let mut turned: Vec<Mat<f64>> = sizes.map(|size| Mat::zeros(size, velocities.count())).collect();
        let turns = !problem.geometry.is_fixed();
        let u = if turns { contact_values(contact, &state.contact_displacements()) } else { Vec::new() };
        let mut approaches = Vec::with_capacity(changes.len());
        for (column, changes) in changes.iter().enumerate() {
            let mut approach = vec![0.0; problem.boundary.row_count];
            for (index, (point, change)) in problem.boundary.points.iter().zip(changes).enumerate() {
                approach[point.start] -= change.gap;
                if turns {
                    let rows = point.rows().zip(&change.directions);
                    rows.for_each(|(row, d)| approach[row] += (0..3).map(|axis| d[axis] * u[index][axis]).sum::<f64>());
                }
            }
            approaches.push(approach);
            if turns {
                add_turned_forces(contact, &state.solution.forces, changes, &mut turned, column);
            }
        }
        let mut on_contact = turned.clone();
        on_contact[0] += contact.bodies[0].stiff().condensed.condense_loads(forces);
        ShapeLoads { contact: on_contact, turned, approaches }
    }
}

/// Σ_sides weight · (contact displacements of the bodies) at every contact node, along the axes.
fn contact_values(contact: &CompliantContact, displacements: &[Vec<f64>]) -> Vec<[f64; 3]> {
    let mut places = vec![0; contact.bodies.len()];
    let value = |point: &crate::equilibrium::ContactPoint| {
        let mut sum = [0.0; 3];
        for side in &point.sides {
            let pattern = &contact.bodies[side.body].stiff().condensed.pattern;
            let place = places[side.body];
            places[side.body] += 1;
            let own = &displacements[side.body][3 * place..];
            let own = pattern.axes.turn_back_at(pattern.contact[place], [own[0], own[1], own[2]]);
            (0..3).for_each(|axis| sum[axis] += side.weight * own[axis]);
        }
        sum
    };
    contact.problem.boundary.points.iter().map(value).collect()
}

/// Adds −Σ_rows λ_r ∂d_r at the contact nodes to a column of the loads on the contact dofs.
fn add_turned_forces(
    contact: &CompliantContact,
    lambda: &[f64],
    changes: &[RowChange],
    loads: &mut [Mat<f64>],
    column: usize,
) {
    let mut places = vec![0; contact.bodies.len()];
    for (point, change) in contact.problem.boundary.points.iter().zip(changes) {
        let rows = || point.rows().zip(&change.directions);
        let force: [f64; 3] =
            std::array::from_fn(|axis| -rows().map(|(row, turned)| lambda[row] * turned[axis]).sum::<f64>());
        for side in &point.sides {
            let pattern = &contact.bodies[side.body].stiff().condensed.pattern;
            let place = places[side.body];
            places[side.body] += 1;
            let turned = pattern.axes.turn_at(pattern.contact[place], force);
            for axis in (0..3).filter(|axis| !pattern.holds(3 * place + axis)) {
                loads[side.body][(3 * place + axis, column)] += side.weight * turned[axis];
            }
        }
    }
}

impl DirectState {
    /// Displacements of the contact dofs of every body, the prescribed ones included.
    fn contact_displacements(&self) -> Vec<Vec<f64>> {
        let mut rest = self.solution.displacement.as_slice();
        let of_body = |body: &crate::direct::compliant_body::ContactBody| {
            let (own, others) = rest.split_at(body.load.free.len());
            rest = others;
            let pattern = &body.stiff().condensed.pattern;
            let mut u = pattern.contact_part(&body.load.lift);
            add_scaled(&mut u, 1.0, own);
            u
        };
        self.contact.bodies.iter().map(of_body).collect()
    }
}
