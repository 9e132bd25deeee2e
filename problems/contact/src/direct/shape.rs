//! How a shape enters a condensed state: sums over cells, and the contact rows.
//!
//! ```text
//! ∂J/∂x = −pᵀ (∂K u − ∂f)/∂x − Σ_rows Σ_sides (λ_r p + η_r u)·∂(w d_r)/∂x + Σ_nodes η_N ∂gap/∂x
//! r = −∂(K u − f),   −Σ_rows λ_r ∂(w d_r) at the nodes of the rows;     ∂(w d_r)·u − ∂gap over the rows
//! ```

use crate::body::Body;
use crate::body::shape_force::shape_forces;
use crate::body::shape_sensitivity::position_sensitivities;
use crate::direct::adjoint::CondensedAdjoint;
use crate::direct::compliant_body::{ContactBody, Response};
use crate::direct::compliant_contact::CompliantContact;
use crate::direct::solver::{DirectSolver, DirectState};
use crate::direct::tangents::ShapeLoads;
use crate::equilibrium::RowChange;
use crate::equilibrium::problem::add_at;
use crate::equilibrium::row_work::{NodeValues, changed_forces, row_approaches, row_sensitivities, side_forces};
use crate::equilibrium::trace_work::{TraceChanges, TraceWork};
use crate::linear::vector::add_scaled;
use crate::shape::Velocities;
use faer::Mat;

impl DirectSolver {
    /// ∂J/∂x per node of all bodies, from the adjoint displacements p of the bodies that controls shape.
    pub(super) fn shape_derivative(
        &self,
        state: &DirectState,
        adjoint_displacements: &[(usize, Vec<f64>)],
        adjoint: &CondensedAdjoint,
    ) -> Vec<[f64; 3]> {
        let (problem, contact) = (&self.problem, &state.contact);
        let mut result = problem.no_sensitivities();
        for (number, p) in adjoint_displacements {
            let (body, piece, moves) =
                (&problem.bodies[*number], &self.patterns[*number].piece, |node| problem.map.moves(*number, node));
            let displacements = [state.displacement(*number), p];
            for (node, value) in position_sensitivities(body, piece, &state.positions[*number], displacements, moves) {
                add_at(&mut result, problem.node_number(*number, node), value);
            }
        }
        let changes = !problem.geometry.is_fixed();
        let displacements = changes.then(|| {
            [&state.contact_displacements(), &adjoint.displacements].map(|values| node_values(contact, values))
        });
        let displacements = displacements.as_ref().map(|[u, p]| [u, p]);
        let forces = [state.solution.forces.as_slice(), adjoint.multipliers.as_slice()];
        let rows = row_sensitivities((&problem.boundary, &contact.rows), forces, displacements);
        let moves = |body: usize, node: u32| problem.map.moves(body, node);
        contact.rows.pull_back(&problem.boundary, &rows, moves, |body, node, sensitivity| {
            add_at(&mut result, problem.node_number(body, node), sensitivity);
        });
        if let Some(work) = TraceWork::new(problem, &contact.rows, &state.positions) {
            let own = (&problem.boundary, &*contact.rows);
            let by_side = forces.map(|forces| side_forces(own, forces, problem.bodies.len()));
            let adjoint = |body: usize, node: u32| {
                let found = adjoint_displacements.iter().find(|(number, _)| *number == body);
                found.map_or([0.0; 3], |(_, p)| entry(p, node))
            };
            let fields = [work.nodal(|body, node| entry(state.displacement(body), node)), work.nodal(adjoint)];
            work.pull_back(by_side.each_ref(), fields.each_ref(), |body, node, sensitivity| {
                add_at(&mut result, problem.node_number(body, node), sensitivity);
            });
        }
        result
    }

    /// −∂(K u − f) over the bodies that controls shape, in the coordinates of the bodies, 0 at held dofs, N, one
    /// column per field of velocities.
    pub(super) fn shape_forces(
        &self,
        state: &DirectState,
        velocities: &Velocities<'_>,
        traces: Option<&TraceChanges<'_>>,
    ) -> Vec<(usize, Mat<f64>)> {
        let rows = (&self.problem.boundary, &*state.contact.rows);
        let changed = traces.map_or_else(Vec::new, |traces| {
            let sides = side_forces(rows, &state.solution.forces, self.problem.bodies.len());
            (0..velocities.count()).map(|column| traces.forces(column, &sides)).collect::<Vec<NodeValues>>()
        });
        let of_body = |number: usize| {
            let (body, piece) = (&self.problem.bodies[number], &self.patterns[number].piece);
            let (positions, u) = (&state.positions[number], state.displacement(number));
            let mut forces = shape_forces((number, body), piece, positions, u, velocities);
            for (forces, changed) in forces.iter_mut().zip(&changed) {
                for (&node, force) in &changed.0[number] {
                    add_scaled(&mut forces[3 * node as usize..][..3], 1.0, force);
                }
            }
            forces.iter_mut().for_each(|forces| self.patterns[number].free_forces(forces));
            (number, Mat::from_fn(piece.dof_count(), forces.len(), |dof, column| forces[column][dof]))
        };
        self.problem.map.shaped_bodies().map(of_body).collect()
    }

    /// What fields of velocities do to the contact problem, given their [`shape_forces`](Self::shape_forces).
    pub(super) fn shape_loads(
        &self,
        state: &DirectState,
        (velocities, traces): (&Velocities<'_>, Option<&TraceChanges<'_>>),
        forces: Vec<(usize, Mat<f64>)>,
    ) -> ShapeLoads {
        let (problem, contact) = (&self.problem, &state.contact);
        let of_column = |column| contact.rows.changes(&problem.boundary, velocities, column);
        let changes: Vec<Vec<RowChange>> = (0..velocities.count()).map(of_column).collect();
        let sizes = contact.bodies.iter().map(|body| body.load.free.len());
        let mut turned: Vec<Mat<f64>> = sizes.map(|size| Mat::zeros(size, velocities.count())).collect();
        let turns = !problem.geometry.is_fixed();
        let u = turns.then(|| node_values(contact, &state.contact_displacements()));
        let nodal = traces.map(|traces| traces.work.nodal(|body, node| entry(state.displacement(body), node)));
        let mut approaches = Vec::with_capacity(changes.len());
        for (column, changes) in changes.iter().enumerate() {
            let nodes = problem.boundary.points.iter().zip(&contact.rows.nodes).zip(changes);
            let moved = traces.zip(nodal.as_ref()).map(|(traces, u)| traces.moved(column, u));
            let values = (u.as_ref(), moved.as_ref());
            approaches.push(nodes.flat_map(|(node, change)| row_approaches(node, change, values)).collect());
            if turns {
                add_turned_forces(contact, &state.solution.forces, changes, &mut turned, column);
            }
        }
        let on_contact = |(body, turned): (&ContactBody, &Mat<f64>)| body.stiff().contact_response(turned);
        let mut responses: Vec<Response> = contact.bodies.iter().zip(&turned).map(on_contact).collect();
        for (number, forces) in forces {
            let own = contact.bodies[number].stiff().response(forces);
            responses[number].displacement += own.displacement;
            responses[number].resultants += own.resultants;
        }
        let areas = changes.iter().map(|changes| contact.rows.area_changes(changes)).collect();
        ShapeLoads { responses, turned, approaches, areas }
    }
}

/// The vector at a node of a body.
fn entry(values: &[f64], node: u32) -> [f64; 3] {
    std::array::from_fn(|axis| values[3 * node as usize + axis])
}

/// Vectors over the contact dofs of all bodies, along the axes at the nodes.
fn node_values(contact: &CompliantContact, values: &[Vec<f64>]) -> NodeValues {
    let of_body = |(body, values): (&ContactBody, &Vec<f64>)| {
        let pattern = &body.stiff().condensed.pattern;
        let nodes = pattern.contact_nodes().iter().zip(&pattern.contact).zip(values.as_chunks::<3>().0);
        nodes.map(|((&node, &place), own)| (node, pattern.axes.turn_back_at(place, *own))).collect()
    };
    NodeValues(contact.bodies.iter().zip(values).map(of_body).collect())
}

/// Adds −Σ_rows λ_r ∂(w d_r) at the nodes of the rows to a column of the loads on the contact dofs.
fn add_turned_forces(
    contact: &CompliantContact,
    lambda: &[f64],
    changes: &[RowChange],
    loads: &mut [Mat<f64>],
    column: usize,
) {
    let rows = (&contact.problem.boundary, &*contact.rows);
    let forces = changed_forces(rows, lambda, changes, contact.bodies.len());
    for ((body, load), forces) in contact.bodies.iter().zip(loads).zip(&forces.0) {
        let pattern = &body.stiff().condensed.pattern;
        for (place, node) in pattern.contact_nodes().iter().enumerate() {
            let Some(force) = forces.get(node) else { continue };
            let turned = pattern.axes.turn_at(pattern.contact[place], *force);
            for axis in (0..3).filter(|axis| !pattern.holds(3 * place + axis)) {
                load[(3 * place + axis, column)] += turned[axis];
            }
        }
    }
}

impl DirectState {
    /// Displacements of the contact dofs of every body, the prescribed ones included.
    fn contact_displacements(&self) -> Vec<Vec<f64>> {
        let (mut rest, problem) = (self.solution.displacement.as_slice(), &self.contact.problem);
        let of_body = |(body, own_body): (&ContactBody, &Body)| {
            let (own, others) = rest.split_at(body.load.free.len());
            rest = others;
            let condensed = &body.stiff().condensed;
            let pattern = &condensed.pattern;
            let prescribed = |node: u32| own_body.prescribed(node);
            let lifted = |(&node, &place): (&u32, &usize)| {
                pattern.axes.turn_at(place, own_body.trace.value(&condensed.weights, node, &prescribed))
            };
            let mut u: Vec<f64> = pattern.contact_nodes().iter().zip(&pattern.contact).flat_map(lifted).collect();
            add_scaled(&mut u, 1.0, own);
            u
        };
        self.contact.bodies.iter().zip(problem.bodies.iter()).map(of_body).collect()
    }
}
