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
use crate::mortar::vector::{dot, plus};
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

    /// What fields of velocities change.
    pub fn along(self, velocities: &Velocities<'_>) -> TraceChanges<'a> {
        let change = |column: usize| {
            let mut changes = vec![TraceWeights::default(); self.rows.traces.len()];
            for (number, body, weights) in self.bodies() {
                let velocity = |node: u32| velocities.at(number, node, column);
                changes[number] = body.trace.changes(weights, &self.positions[number], velocity);
            }
            changes
        };
        TraceChanges { work: self, columns: (0..velocities.count()).map(change).collect() }
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
                    dot(force, own)
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

/// The changes of weighted displacements along fields of velocities.
#[derive(Debug)]
pub(crate) struct TraceChanges<'a> {
    pub work: TraceWork<'a>,
    /// d′ by field and body.
    columns: Vec<Vec<TraceWeights>>,
}

impl TraceChanges<'_> {
    /// w′ of the corners along a field for the displacements of all nodes, mm.
    pub fn moved(&self, column: usize, u: &NodeValues) -> NodeValues {
        let changes = &self.columns[column];
        let mut moved = NodeValues::zeros(changes.len());
        for (number, body, _) in self.work.bodies() {
            for corner in body.trace.corners() {
                let terms = body.trace.terms(&changes[number], corner);
                let sum = terms.fold([0.0; 3], |sum, (middle, change)| {
                    plus(sum, change, middle.value(&|node| u.of(number, node)))
                });
                moved.0[number].insert(corner, body.trace.projected(corner, sum));
            }
        }
        moved
    }

    /// The forces on the nodes that forces on weighted displacements become by their changes along a field.
    pub fn forces(&self, column: usize, forces: &NodeValues) -> NodeValues {
        let changes = &self.columns[column];
        let mut nodal = NodeValues::zeros(changes.len());
        for (number, body, _) in self.work.bodies() {
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
}
