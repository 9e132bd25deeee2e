//! What the numbers of the nodes of two faces in contact change with at a shape.
//!
//! ```text
//! facets of second degree:  g′ of the integrals,       flat facets:  g′ = n′·v + n·v′,  v = Σ_j m_ij x_j − x_i
//! ```

use crate::equilibrium::contact_point::{ContactPoint, Side};
use crate::equilibrium::node_rows::{NodeRows, dot};
use crate::equilibrium::numbers::Numbers;
use crate::equilibrium::opposite::{Facing, Moves, Nodes};
use crate::mortar::{Mortar, NodeSensitivity};
use crate::shape::Velocities;
use std::sync::Arc;

/// Two faces in contact at a shape.
#[derive(Debug)]
pub(crate) struct PairAt {
    pub mortar: Arc<Mortar>,
    /// Slave body and master body, and the positions of their nodes.
    pub bodies: [usize; 2],
    pub positions: [Arc<Vec<[f64; 3]>>; 2],
    /// The contact nodes among those of the mortar integrals, and the sides that its weights belong to; none where the
    /// master does not lie opposite.
    pub nodes: Vec<(usize, Vec<usize>)>,
    /// Whether normals and weights are the same for all shapes.
    pub is_fixed: bool,
}

impl PairAt {
    /// The derivative of the gap by the normal at given weights.
    fn by_normal(&self, point: &ContactPoint, row: &NodeRows) -> [f64; 3] {
        if self.mortar.is_quadratic() { [0.0; 3] } else { distance(point, &row.weights, &self.positions) }
    }

    /// The derivatives of the gap by the weights of all sides at a given normal.
    fn by_weights(&self, point: &ContactPoint, row: &NodeRows) -> Vec<f64> {
        let place = |number: usize, side: &Side| self.positions[usize::from(number > 0)][side.node as usize];
        let slope = |(number, side): (usize, &Side)| match self.mortar.is_quadratic() {
            true => 0.0,
            false => -dot(row.normal, place(number, side)),
        };
        point.sides.iter().enumerate().map(slope).collect()
    }
}

impl Facing for PairAt {
    fn changes(&self, (points, rows): Nodes<'_>, velocities: &Velocities<'_>, column: usize) -> Vec<Numbers> {
        let changes =
            (!self.is_fixed).then(|| self.mortar.changes(&|side, node| velocities.at(self.bodies[side], node, column)));
        let of_node = |((point, row), (index, sides)): ((&ContactPoint, &NodeRows), &(usize, Vec<usize>))| {
            let mut change = Numbers::default();
            if !self.mortar.is_quadratic() {
                let weighted = point.sides.iter().zip(&row.weights).filter(|(_, weight)| **weight != 0.0);
                let moved = |side: &Side| velocities.at(side.body, side.node, column);
                change.gap = weighted.map(|(side, weight)| -weight * dot(row.normal, moved(side))).sum();
            }
            let Some(own) = changes.as_ref().map(|changes| &changes[*index]) else { return change };
            change.weights = vec![0.0; point.sides.len()];
            for (&side, weight) in sides.iter().zip(&own.weights).filter(|(side, _)| **side > 0) {
                change.weights[side] = -weight;
            }
            change.gap += own.gap + dot(own.normal, self.by_normal(point, row));
            change.gap += self.by_weights(point, row).iter().zip(&change.weights).map(|(s, w)| s * w).sum::<f64>();
            Numbers { normal: own.normal, area: own.area, ..change }
        };
        points.iter().zip(rows).zip(&self.nodes).map(of_node).collect()
    }

    fn pull_back(
        &self,
        (points, rows): Nodes<'_>,
        sensitivities: &[Numbers],
        moves: Moves<'_>,
        add: &mut dyn FnMut(usize, u32, [f64; 3]),
    ) {
        let covered =
            || points.iter().zip(rows).zip(sensitivities).zip(&self.nodes).filter(|(((_, row), _), _)| row.is_covered);
        if !self.mortar.is_quadratic() {
            for (((point, row), own), _) in covered().filter(|((_, own), _)| own.gap != 0.0) {
                for (side, weight) in point.sides.iter().zip(&row.weights).filter(|(_, weight)| **weight != 0.0) {
                    add(side.body, side.node, row.normal.map(|n| -own.gap * weight * n));
                }
            }
        }
        if self.is_fixed {
            return;
        }
        let mut of_nodes = vec![NodeSensitivity::default(); self.mortar.nodes.len()];
        for (((point, row), own), (index, sides)) in covered() {
            let turned = self.by_normal(point, row);
            let normal = std::array::from_fn(|axis| own.normal[axis] + own.gap * turned[axis]);
            let slopes = self.by_weights(point, row);
            // The weights of the master nodes are those of the sides with the opposite sign.
            let by_side = |side: usize| if side > 0 { -(own.weights[side] + own.gap * slopes[side]) } else { 0.0 };
            let weights = sides.iter().map(|&side| by_side(side)).collect();
            let gap = if self.mortar.is_quadratic() { own.gap } else { 0.0 };
            of_nodes[*index] = NodeSensitivity { area: own.area, weights, normal, gap };
        }
        let [slave, master] = self.bodies;
        let moving: [&(dyn Fn(u32) -> bool + Sync); 2] = [&|node| moves(slave, node), &|node| moves(master, node)];
        self.mortar
            .pull_back(&of_nodes, moving, &mut |side, node, sensitivity| add(self.bodies[side], node, sensitivity));
    }
}

/// Σ_j m_ij x_j − x_i.
pub(crate) fn distance(point: &ContactPoint, weights: &[f64], positions: &[Arc<Vec<[f64; 3]>>; 2]) -> [f64; 3] {
    let mut sum = positions[0][point.node as usize].map(|x| -x);
    for (side, weight) in point.sides.iter().zip(weights).skip(1).filter(|(_, weight)| **weight != 0.0) {
        let x = positions[1][side.node as usize];
        (0..3).for_each(|axis| sum[axis] -= weight * x[axis]);
    }
    sum
}
