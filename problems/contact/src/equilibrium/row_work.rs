//! What displacements of contact nodes do in sums over the rows: the change of the rows in derivatives.
//!
//! ```text
//! jump of row r = Σ_sides w d_r·u:
//! by direction:   −Σ_r (λ_r Σ w p + η_r Σ w u),     by weight of a side:   −Σ_r (λ_r d_r·p + η_r d_r·u)
//! forward:        Σ w d_r′·u + Σ w′ d_r·u − gap′ in the rows,   −Σ_r λ_r (w d_r′ + w′ d_r) at the sides
//! ```

use crate::equilibrium::{ContactBoundary, ContactPoint, ContactRows, NodeRows, RowChange, RowSensitivities, Side};
use std::collections::HashMap;

/// Vectors at the nodes that take part in contact rows, by body.
#[derive(Debug, Clone, Default)]
pub(crate) struct NodeValues(pub Vec<HashMap<u32, [f64; 3]>>);

impl NodeValues {
    /// Vectors of zero for some bodies.
    pub(crate) fn zeros(bodies: usize) -> Self {
        Self(vec![HashMap::new(); bodies])
    }

    fn at(&self, side: &Side) -> [f64; 3] {
        self.of(side.body, side.node)
    }

    /// The vector at a node of a body.
    pub(crate) fn of(&self, body: usize, node: u32) -> [f64; 3] {
        self.0[body].get(&node).copied().unwrap_or_default()
    }

    /// Σ_sides weight · vector.
    pub(crate) fn jump(&self, point: &ContactPoint, weights: &[f64]) -> [f64; 3] {
        let mut sum = [0.0; 3];
        for (side, weight) in point.sides.iter().zip(weights).filter(|(_, weight)| **weight != 0.0) {
            let own = self.at(side);
            (0..3).for_each(|axis| sum[axis] += weight * own[axis]);
        }
        sum
    }

    fn add(&mut self, side: &Side, vector: [f64; 3]) {
        self.add_to(side.body, side.node, vector);
    }

    pub(crate) fn add_to(&mut self, body: usize, node: u32, vector: [f64; 3]) {
        let own = self.0[body].entry(node).or_insert([0.0; 3]);
        (0..3).for_each(|axis| own[axis] += vector[axis]);
    }
}

/// Sensitivities of the rows for forces λ, the adjoint η of the gaps, displacements u and their adjoint p.
pub(crate) fn row_sensitivities(
    (boundary, rows): (&ContactBoundary, &ContactRows),
    [lambda, eta]: [&[f64]; 2],
    displacements: Option<[&NodeValues; 2]>,
) -> Vec<RowSensitivities> {
    let of_node = |(point, node): (&ContactPoint, &NodeRows)| {
        let gap = eta[point.start];
        let Some([u, p]) = displacements else { return RowSensitivities { gap, ..RowSensitivities::default() } };
        let (jump, adjoint) = (u.jump(point, &node.weights), p.jump(point, &node.weights));
        let of_row = |row: usize| std::array::from_fn(|axis| -(lambda[row] * adjoint[axis] + eta[row] * jump[axis]));
        let of_side = |side: &Side| {
            let (u, p) = (u.at(side), p.at(side));
            let term = |(row, d): (usize, &[f64; 3])| lambda[row] * dot(d, p) + eta[row] * dot(d, u);
            -point.rows().zip(&node.directions).map(term).sum::<f64>()
        };
        let weights = if point.sides.len() > 1 { point.sides.iter().map(of_side).collect() } else { Vec::new() };
        let directions = point.rows().map(of_row).collect();
        RowSensitivities { directions, gap, weights, ..RowSensitivities::default() }
    };
    boundary.points.iter().zip(&rows.nodes).map(of_node).collect()
}

/// ∂B u − ∂gap over the rows of a node; `u`: displacements, where the rows turn or their weights change, and `moved`
/// what the changes of weighted displacements add to them.
pub(crate) fn row_approaches(
    (point, node): (&ContactPoint, &NodeRows),
    change: &RowChange,
    (u, moved): (Option<&NodeValues>, Option<&NodeValues>),
) -> Vec<f64> {
    let mut approaches = vec![0.0; point.row_count()];
    approaches[0] -= change.gap;
    if let Some(moved) = moved {
        let jump = moved.jump(point, &node.weights);
        approaches.iter_mut().zip(&node.directions).for_each(|(approach, d)| *approach += dot(d, jump));
    }
    if let Some(u) = u {
        let (jump, moved) = (u.jump(point, &node.weights), u.jump(point, &change.weights));
        for ((approach, turned), d) in approaches.iter_mut().zip(&change.directions).zip(&node.directions) {
            *approach += dot(turned, jump) + dot(d, moved);
        }
    }
    approaches
}

/// −Σ_r λ_r w d_r at the sides of all rows.
pub(crate) fn side_forces(
    (boundary, rows): (&ContactBoundary, &ContactRows),
    lambda: &[f64],
    bodies: usize,
) -> NodeValues {
    let mut forces = NodeValues::zeros(bodies);
    for (point, node) in boundary.points.iter().zip(&rows.nodes) {
        let sum = |axis: usize| -point.rows().zip(&node.directions).map(|(row, d)| lambda[row] * d[axis]).sum::<f64>();
        let force: [f64; 3] = std::array::from_fn(sum);
        for (side, weight) in point.sides.iter().zip(&node.weights).filter(|(_, weight)| **weight != 0.0) {
            forces.add(side, force.map(|f| weight * f));
        }
    }
    forces
}

/// −Σ_r λ_r ∂(w d_r) at the nodes of all rows.
pub(crate) fn changed_forces(
    (boundary, rows): (&ContactBoundary, &ContactRows),
    lambda: &[f64],
    changes: &[RowChange],
    bodies: usize,
) -> NodeValues {
    let mut forces = NodeValues::zeros(bodies);
    for ((point, node), change) in boundary.points.iter().zip(&rows.nodes).zip(changes) {
        let sum = |directions: &[[f64; 3]]| -> [f64; 3] {
            std::array::from_fn(|axis| -point.rows().zip(directions).map(|(row, d)| lambda[row] * d[axis]).sum::<f64>())
        };
        let turned = sum(&change.directions);
        let force = if change.weights.is_empty() { [0.0; 3] } else { sum(&node.directions) };
        for (number, side) in point.sides.iter().enumerate() {
            let (weight, moved) = (node.weights[number], change.weights.get(number).copied().unwrap_or(0.0));
            if weight != 0.0 || moved != 0.0 {
                forces.add(side, std::array::from_fn(|axis| weight * turned[axis] + moved * force[axis]));
            }
        }
    }
    forces
}

fn dot(a: &[f64; 3], b: [f64; 3]) -> f64 {
    (0..3).map(|axis| a[axis] * b[axis]).sum()
}
