//! What changes of weighted displacements do in sums over the rows, where shapes change the areas of facets with middle
//! nodes.
//!
//! ```text
//! w_j′ = P_j Σ_m d_jm′ û_m  in the jumps,      −Σ_r λ_r w d_r·w_j′  as forces on û_m
//! ∂J/∂d_jm = F_j(λ)·P_j û_m(p) + F_j(η)·P_j û_m(u),       F_j(λ) = −Σ_r λ_r w d_r over the rows of side j
//! ```

use crate::body::{Body, TraceWeights};
use crate::equilibrium::row_work::NodeValues;
use crate::equilibrium::{ContactProblem, ContactRows, Positions};
use crate::shape::Velocities;

/// The bodies of a shape whose weighted displacements change with it.
#[derive(Debug, Clone, Copy)]
pub(crate) struct TraceWork<'a> {
    problem: &'a ContactProblem,
    rows: &'a ContactRows,
    positions: &'a Positions,
}

impl<'a> TraceWork<'a> {
    /// The bodies of a problem at a shape; none if no weighted displacement changes.
    pub fn new(problem: &'a ContactProblem, rows: &'a ContactRows, positions: &'a Positions) -> Option<Self> {
        problem.geometry.traces_change.then_some(Self { problem, rows, positions })
    }

    fn bodies(self) -> impl Iterator<Item = (usize, &'a Body, &'a TraceWeights)> {
        let bodies = self.problem.bodies.iter().zip(&self.rows.traces).enumerate();
        let moving =
            bodies.filter(move |(number, (body, _))| self.problem.map.shapes(*number) && !body.trace.is_empty());
        moving.map(|(number, (body, weights))| (number, body, weights))
    }

    /// The changes of the numbers d along one field of velocities, by body.
    pub fn changes(self, velocities: &Velocities<'_>, column: usize) -> Vec<TraceWeights> {
        let mut changes = vec![TraceWeights::default(); self.rows.traces.len()];
        for (number, body, weights) in self.bodies() {
            let velocity = |node: u32| velocities.at(number, node, column);
            changes[number] = body.trace.changes(weights, &self.positions[number], velocity);
        }
        changes
    }

    /// w′ of the corners for the displacements of all nodes, mm.
    pub fn moved(self, changes: &[TraceWeights], u: &NodeValues) -> NodeValues {
        let mut moved = NodeValues::zeros(changes.len());
        for (number, body, _) in self.bodies() {
            for corner in body.trace.corners() {
                let mut sum = [0.0; 3];
                for (middle, change) in body.trace.terms(&changes[number], corner) {
                    let own = middle.value(&|node| u.of(number, node));
                    (0..3).for_each(|axis| sum[axis] += change * own[axis]);
                }
                moved.0[number].insert(corner, body.trace.projected(corner, sum));
            }
        }
        moved
    }

    /// The forces on the nodes that forces on weighted displacements become by their changes.
    pub fn forces(self, changes: &[TraceWeights], forces: &NodeValues) -> NodeValues {
        let mut nodal = NodeValues::zeros(changes.len());
        for (number, body, _) in self.bodies() {
            for corner in body.trace.corners() {
                let force = body.trace.projected(corner, forces.of(number, corner));
                for (middle, change) in body.trace.terms(&changes[number], corner) {
                    let mut add = |node: u32, force: [f64; 3]| nodal.add_to(number, node, force);
                    middle.spread(force.map(|f| change * f), &mut add);
                }
            }
        }
        nodal
    }

    /// Adds the sensitivities of the positions of nodes by way of d, from forces F of λ and η, and the fields u and p.
    pub fn pull_back(
        self,
        [of_lambda, of_eta]: [&NodeValues; 2],
        [u, p]: [&NodeValues; 2],
        mut add: impl FnMut(usize, u32, [f64; 3]),
    ) {
        for (number, body, weights) in self.bodies() {
            let by_weights = body.trace.map(|corner, middle| {
                let work = |forces: &NodeValues, field: &NodeValues| {
                    let force = body.trace.projected(corner, forces.of(number, corner));
                    let own = middle.value(&|node| field.of(number, node));
                    (0..3).map(|axis| force[axis] * own[axis]).sum::<f64>()
                };
                work(of_lambda, p) + work(of_eta, u)
            });
            body.trace.pull_back(weights, &self.positions[number], &by_weights, |node, sensitivity| {
                add(number, node, sensitivity);
            });
        }
    }

    /// The displacements of the nodes of all traces, from those of the nodes of a body.
    pub fn nodal(self, displacement: impl Fn(usize, u32) -> [f64; 3]) -> NodeValues {
        let mut values = NodeValues::zeros(self.rows.traces.len());
        for (number, body, _) in self.bodies() {
            for node in body.trace.corners().flat_map(|corner| body.trace.support(corner)) {
                values.0[number].entry(node).or_insert_with(|| displacement(number, node));
            }
        }
        values
    }
}
