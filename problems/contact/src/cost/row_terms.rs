//! Sums Σ_r c_r (B w)_r over the contact rows with their derivatives: resultants, reactions and work of contact forces.
//!
//! ```text
//! (B w)_r = Σ_sides weight d_r·w          w: weighted values of a field at the nodes of the sides
//! ```
//! On an obstacle the normal force acts along the whole normal n, not only along its free part d₀ = P n: supports take
//! the rest. Between bodies, what supports hold of a normal acts on neither side.

use crate::body::onto;
use crate::cost::state_view::StateView;
use crate::equilibrium::problem::add_at;
use crate::equilibrium::row_work::{NodeValues, row_sensitivities, side_forces};
use crate::equilibrium::trace_work::TraceWork;
use crate::equilibrium::{ContactPoint, ContactProblem, NodeRows, RowSensitivities, Side};
use crate::mortar::vector::{dot, length, plus};

/// The contact rows of a state, for sums over them.
#[derive(Debug, Clone, Copy)]
pub(super) struct RowTerms<'a> {
    pub problem: &'a ContactProblem,
    pub at: StateView<'a>,
}

impl<'a> RowTerms<'a> {
    fn nodes(self) -> impl Iterator<Item = (&'a ContactPoint, &'a NodeRows)> {
        self.problem.boundary.points.iter().zip(&self.at.rows.nodes)
    }

    /// λ of all packed rows, N.
    pub fn forces(self) -> Vec<f64> {
        let (mut packed, forces) = (Vec::with_capacity(self.problem.boundary.row_count), self.at.forces);
        for (index, (_, node)) in self.nodes().enumerate() {
            let along = |vector: [f64; 3]| move |d: &[f64; 3]| dot(*d, vector);
            match forces.normal.get(index) {
                Some(normal) => {
                    packed.push(*normal);
                    let tangential = forces.tangential.get(index).copied().unwrap_or_default();
                    packed.extend(node.directions[1..].iter().map(along(tangential)));
                }
                None => {
                    // The directions of a glued node span its free directions, but are not of unit length.
                    let vector = forces.ties[index - forces.normal.len()];
                    let square = |d: &[f64; 3]| dot(*d, *d);
                    packed.extend(node.directions.iter().map(|d| dot(*d, vector) / square(d)));
                }
            }
        }
        packed
    }

    /// The force of a node on what lies opposite, N, for forces of its rows.
    pub fn force(self, index: usize, packed: &[f64]) -> [f64; 3] {
        let (point, node) = (&self.problem.boundary.points[index], &self.at.rows.nodes[index]);
        let rows = point.rows().zip(directions(point, node));
        rows.fold([0.0; 3], |sum, (row, d)| plus(sum, packed[row], d))
    }

    /// Weighted values of a field at the nodes of the sides of all rows.
    pub fn weighted(self, field: &impl Fn(usize, u32) -> [f64; 3]) -> NodeValues {
        let mut values = NodeValues::zeros(self.problem.bodies.len());
        for side in self.problem.boundary.points.iter().flat_map(|point| &point.sides) {
            let (trace, weights) = (&self.problem.bodies[side.body].trace, &self.at.rows.traces[side.body]);
            let value = || trace.value(weights, side.node, &|node| field(side.body, node));
            values.0[side.body].entry(side.node).or_insert_with(value);
        }
        values
    }

    /// B w of all packed rows.
    pub fn products(self, w: &NodeValues) -> Vec<f64> {
        let mut products = Vec::with_capacity(self.problem.boundary.row_count);
        for (point, node) in self.nodes() {
            let jump = w.jump(point, &node.weights);
            products.extend(directions(point, node).map(|d| dot(d, jump)));
        }
        products
    }

    /// The derivative of Σ c_r (B w)_r by the field at fixed c: `add(body, node, derivative)`. For c without normal
    /// rows.
    pub fn by_field(self, c: &[f64], mut add: impl FnMut(usize, u32, [f64; 3])) {
        let rows = (&self.problem.boundary, self.at.rows);
        for (body, values) in side_forces(rows, c, self.problem.bodies.len()).0.into_iter().enumerate() {
            let (trace, weights) = (&self.problem.bodies[body].trace, &self.at.rows.traces[body]);
            let mut nodes: Vec<_> = values.into_iter().collect();
            nodes.sort_unstable_by_key(|(node, _)| *node);
            for (node, force) in nodes {
                trace.spread(weights, node, force.map(|f| -f), &mut |node, share| add(body, node, share));
            }
        }
    }

    /// The derivative of Σ c_r (B w)_r by the positions of all points at fixed c, for a field with its weighted values
    /// w that does not depend on them.
    pub fn by_positions(self, c: &[f64], w: &NodeValues, field: impl Fn(usize, u32) -> [f64; 3]) -> Vec<[f64; 3]> {
        let Self { problem, at } = self;
        let (minus, zeros): (Vec<f64>, Vec<f64>) = c.iter().map(|c| (-c, 0.0)).unzip();
        let (own, nothing) = ((&problem.boundary, at.rows), NodeValues::zeros(problem.bodies.len()));
        let mut rows = row_sensitivities(own, [&zeros, &minus], Some([w, &nothing]));
        for (sensitivity, point) in rows.iter_mut().zip(&problem.boundary.points) {
            sensitivity.gap = 0.0;
            if let Some(first) = sensitivity.directions.first_mut().filter(|_| acts_along_normal(point)) {
                sensitivity.normal = std::mem::take(first);
            }
        }
        self.pulled(&rows, &side_forces(own, &minus, problem.bodies.len()), field)
    }

    /// The length of the slip of a node, mm, and its direction; 0 and no direction where it sticks.
    ///
    /// ```text
    /// j = P Σ_sides weight·w,   m = P n/c,   s = j − m (m·j)
    /// ```
    pub fn slip(self, index: usize, u: &NodeValues) -> (f64, [f64; 3]) {
        let (point, node) = (&self.problem.boundary.points[index], &self.at.rows.nodes[index]);
        let jump = onto(&point.free, u.jump(point, &node.weights));
        let d = node.directions[0];
        let slip = plus(jump, -dot(d, jump) / dot(d, d), d);
        let size = length(slip);
        (size, if size > 0.0 { slip.map(|s| s / size) } else { [0.0; 3] })
    }

    /// The derivatives of the length of the slip of a node: by displacements, `add(body, node, derivative)`, and by the
    /// positions of all points.
    pub fn slip_gradient(
        self,
        index: usize,
        u: &NodeValues,
        mut add: impl FnMut(usize, u32, [f64; 3]),
    ) -> Vec<[f64; 3]> {
        let Self { problem, at } = self;
        let (point, node) = (&problem.boundary.points[index], &at.rows.nodes[index]);
        let (_, along) = self.slip(index, u);
        let mut forces = NodeValues::zeros(problem.bodies.len());
        for (side, weight) in point.sides.iter().zip(&node.weights).filter(|(_, weight)| **weight != 0.0) {
            let share = along.map(|t| weight * t);
            forces.add_to(side.body, side.node, share);
            let (trace, weights) = (&problem.bodies[side.body].trace, &at.rows.traces[side.body]);
            trace.spread(weights, side.node, share, &mut |node, share| add(side.body, node, share));
        }
        let d = node.directions[0];
        let share = dot(d, u.jump(point, &node.weights)) / dot(d, d);
        let mut rows = vec![RowSensitivities::default(); problem.boundary.points.len()];
        let by_weight = |side: &Side| dot(along, u.of(side.body, side.node));
        let weights = if point.sides.len() > 1 { point.sides.iter().map(by_weight).collect() } else { Vec::new() };
        rows[index] = RowSensitivities { normal: along.map(|t| -share * t), weights, ..RowSensitivities::default() };
        self.pulled(&rows, &forces, |body, node| at.displacement(body, node))
    }

    /// Sensitivities of the positions of all points from those of the rows and, by way of the weights of middle nodes,
    /// from forces on the weighted values of a field.
    fn pulled(
        self,
        rows: &[RowSensitivities],
        forces: &NodeValues,
        field: impl Fn(usize, u32) -> [f64; 3],
    ) -> Vec<[f64; 3]> {
        let Self { problem, at } = self;
        let mut result = problem.no_sensitivities();
        let moves = |body: usize, node: u32| problem.map.moves(body, node);
        at.rows.pull_back(&problem.boundary, rows, moves, |body, node, sensitivity| {
            add_at(&mut result, problem.node_number(body, node), sensitivity);
        });
        let positions = at.positions();
        if let Some(work) = TraceWork::new(problem, at.rows, &positions) {
            let nothing = NodeValues::zeros(problem.bodies.len());
            let fields = [&work.nodal(field), &nothing];
            work.pull_back([&nothing, forces], fields, |body, node, sensitivity| {
                add_at(&mut result, problem.node_number(body, node), sensitivity);
            });
        }
        result
    }
}

/// Whether the normal force of a node acts along its whole normal.
fn acts_along_normal(point: &ContactPoint) -> bool {
    point.sides.len() == 1
}

/// The directions along which the forces of the rows of a node act.
fn directions<'a>(point: &ContactPoint, node: &'a NodeRows) -> impl Iterator<Item = [f64; 3]> + 'a {
    let first = if acts_along_normal(point) { node.normal } else { node.directions[0] };
    std::iter::once(first).chain(node.directions[1..].iter().copied())
}
