//! The rows of a contact between two bodies, from its mortar integrals.
//!
//! ```text
//! gap = g − (interference) − n·(I − P) Σ w v̂      v̂: displacements that supports prescribe
//! facets of second degree:  g = ∫ ψ_i ν·(Y_m − Y_s)/D_i,       flat facets:  g = n·v,  v = Σ_j m_ij x_j − x_i
//! gap′ = g′ − n′·(I − P) Σ w v̂ + n·(I − P) Σ_j m_ij′ v̂_j
//! ```

use crate::equilibrium::ContactPoint;
use crate::equilibrium::contact_part::{COVERED, ContactPart, NO_WEIGHT, Pair};
use crate::equilibrium::node_rows::{NodeRows, RowChange, RowSensitivities, dot};
use crate::error::ContactError;
use crate::mortar::{Mortar, NodeSensitivity};
use crate::shape::Velocities;
use std::sync::Arc;

/// What the rows of a contact between two bodies are computed from at a shape.
#[derive(Debug, Clone)]
pub(crate) struct PairRows {
    mortar: Arc<Mortar>,
    /// Slave body and master body, and the positions of their nodes.
    bodies: [usize; 2],
    positions: [Arc<Vec<[f64; 3]>>; 2],
    /// The contact nodes among those of the mortar integrals, and the sides that its weights belong to; none where the
    /// master does not lie opposite.
    nodes: Vec<(usize, Vec<usize>)>,
    /// Whether directions and weights are the same for all shapes.
    is_fixed: bool,
    is_tied: bool,
}

/// Points of a contact with their rows.
type Points<'a> = (&'a [ContactPoint], &'a [NodeRows]);

impl PairRows {
    /// The integrals of a shape, and the rows of its contact nodes.
    ///
    /// # Errors
    /// [`ContactError::LeftMaster`] for a glued node that no longer lies opposite to the master, and for one that slid
    /// past the master nodes in its rows.
    pub(crate) fn new(
        (part, pair): (&ContactPart, &Pair),
        points: &[ContactPoint],
        positions: &[Arc<Vec<[f64; 3]>>],
    ) -> Result<(Self, Vec<NodeRows>), ContactError> {
        let bodies = [part.slave, pair.body];
        let positions = bodies.map(|body| Arc::clone(&positions[body]));
        let mortar = pair.mortar([&positions[0], &positions[1]], part.is_fixed);
        let (mut nodes, mut rows) = (Vec::with_capacity(points.len()), Vec::with_capacity(points.len()));
        for point in points {
            let left = || ContactError::LeftMaster { node: point.node, place: positions[0][point.node as usize] };
            let index = mortar.nodes.binary_search_by_key(&point.node, |node| node.node).map_err(|_| left())?;
            let node = &mortar.nodes[index];
            let mut weights = vec![0.0; point.sides.len()];
            weights[0] = 1.0;
            if node.covered.is_nan() || node.covered < COVERED {
                if part.is_tied {
                    return Err(left());
                }
                let normal = pair.outward(node.normal);
                rows.push(NodeRows::away(point, normal, weights, pair.away, COVERED * node.whole));
                nodes.push((index, Vec::new()));
                continue;
            }
            let mut sides = Vec::with_capacity(node.weights.len());
            for &(master, weight) in &node.weights {
                let side = point.sides[1..].binary_search_by_key(&master, |side| side.node);
                match side {
                    _ if weight.abs() <= NO_WEIGHT => {}
                    Ok(side) => weights[1 + side] = -weight,
                    Err(_) => return Err(left()),
                }
                sides.push(side.map_or(0, |side| 1 + side));
            }
            let normal = pair.outward(node.normal);
            let gap = if part.is_tied {
                0.0
            } else {
                let imposed = point.imposed(&weights);
                let offset = pair.offsets.get(index).copied().unwrap_or(0.0) - part.interference;
                if mortar.is_quadratic() {
                    node.gap - dot(normal, imposed) + offset
                } else {
                    let distance = distance(point, &weights, &positions);
                    let less: [f64; 3] = std::array::from_fn(|axis| distance[axis] - imposed[axis]);
                    dot(normal, less) + offset
                }
            };
            rows.push(NodeRows::of_pair(point, normal, weights, gap, node.area));
            nodes.push((index, sides));
        }
        let (is_fixed, is_tied) = (part.is_fixed, part.is_tied);
        Ok((Self { mortar, bodies, positions, nodes, is_fixed, is_tied }, rows))
    }

    /// Adds sensitivities to those of the positions of nodes: `add(body, node, sensitivity)`.
    pub(crate) fn pull_back(
        &self,
        (points, rows): Points<'_>,
        sensitivities: &[RowSensitivities],
        moves: &(impl Fn(usize, u32) -> bool + Sync),
        add: &mut impl FnMut(usize, u32, [f64; 3]),
    ) {
        for ((point, row), own) in points.iter().zip(rows).zip(sensitivities) {
            if self.is_tied || own.gap == 0.0 || !row.is_covered || self.mortar.is_quadratic() {
                continue;
            }
            for (side, weight) in point.sides.iter().zip(&row.weights).filter(|(_, weight)| **weight != 0.0) {
                add(side.body, side.node, row.normal.map(|n| -own.gap * weight * n));
            }
        }
        if self.is_fixed {
            return;
        }
        let mut of_nodes = vec![NodeSensitivity::default(); self.mortar.nodes.len()];
        for (((point, row), own), (index, sides)) in points.iter().zip(rows).zip(sensitivities).zip(&self.nodes) {
            if !row.is_covered {
                continue;
            }
            let mut normal = row.normal_sensitivity(&point.free, &own.directions);
            let mut by_side = own.weights.clone();
            by_side.resize(point.sides.len(), 0.0);
            if !self.is_tied && own.gap != 0.0 {
                let turned = self.by_normal(point, row);
                (0..3).for_each(|axis| normal[axis] += own.gap * turned[axis]);
                for (sum, slope) in by_side.iter_mut().zip(self.gap_slopes(point, row)) {
                    *sum += own.gap * slope;
                }
            }
            // The weights of the master nodes are those of the sides with the opposite sign.
            let weights = sides.iter().map(|&side| if side > 0 { -by_side[side] } else { 0.0 }).collect();
            let gap = if self.is_tied || !self.mortar.is_quadratic() { 0.0 } else { own.gap };
            of_nodes[*index] = NodeSensitivity { area: 0.0, weights, normal, gap };
        }
        self.add_mortar(&of_nodes, moves, add);
    }

    /// Adds sensitivities of the areas of the contact nodes.
    pub(crate) fn pull_back_areas(
        &self,
        areas: &[f64],
        moves: &(impl Fn(usize, u32) -> bool + Sync),
        add: &mut impl FnMut(usize, u32, [f64; 3]),
    ) {
        if self.is_fixed {
            return;
        }
        let mut of_nodes = vec![NodeSensitivity::default(); self.mortar.nodes.len()];
        let covered = self.nodes.iter().zip(areas).filter(|((_, sides), _)| !sides.is_empty());
        covered.for_each(|((index, _), area)| of_nodes[*index].area = *area);
        self.add_mortar(&of_nodes, moves, add);
    }

    fn add_mortar(
        &self,
        of_nodes: &[NodeSensitivity],
        moves: &(impl Fn(usize, u32) -> bool + Sync),
        add: &mut impl FnMut(usize, u32, [f64; 3]),
    ) {
        let [slave, master] = self.bodies;
        let moving: [&(dyn Fn(u32) -> bool + Sync); 2] = [&|node| moves(slave, node), &|node| moves(master, node)];
        self.mortar
            .pull_back(of_nodes, moving, &mut |side, node, sensitivity| add(self.bodies[side], node, sensitivity));
    }

    /// The derivative of the gap by the normal, but for what it does in facets of second degree.
    fn by_normal(&self, point: &ContactPoint, row: &NodeRows) -> [f64; 3] {
        let imposed = point.imposed(&row.weights);
        let distance =
            if self.mortar.is_quadratic() { [0.0; 3] } else { distance(point, &row.weights, &self.positions) };
        std::array::from_fn(|axis| distance[axis] - imposed[axis])
    }

    /// The derivatives of the gap by the weights of all sides.
    fn gap_slopes(&self, point: &ContactPoint, row: &NodeRows) -> Vec<f64> {
        // n − P n: what of the normal no row has.
        let rest: [f64; 3] = std::array::from_fn(|axis| row.normal[axis] - row.directions[0][axis]);
        let place = |which: usize, node: u32| self.positions[which][node as usize];
        let of_side = |(number, side): (usize, &crate::equilibrium::Side)| {
            let moved = -dot(rest, side.prescribed);
            match self.mortar.is_quadratic() {
                true => moved,
                false => moved - dot(row.normal, place(usize::from(number > 0), side.node)),
            }
        };
        point.sides.iter().enumerate().map(of_side).collect()
    }

    /// The changes of the rows along one field of velocities.
    pub(crate) fn changes(
        &self,
        (points, rows): Points<'_>,
        velocities: &Velocities<'_>,
        column: usize,
    ) -> Vec<RowChange> {
        let changes =
            (!self.is_fixed).then(|| self.mortar.changes(&|side, node| velocities.at(self.bodies[side], node, column)));
        let of_node = |((point, row), (index, sides)): ((&ContactPoint, &NodeRows), &(usize, Vec<usize>))| {
            let moved = |side: &crate::equilibrium::Side| velocities.at(side.body, side.node, column);
            let sides_with_weights = point.sides.iter().zip(&row.weights).filter(|(_, weight)| **weight != 0.0);
            let mut gap: f64 = sides_with_weights.map(|(side, weight)| -weight * dot(row.normal, moved(side))).sum();
            if self.mortar.is_quadratic() {
                gap = 0.0;
            }
            let mut change =
                RowChange { directions: vec![[0.0; 3]; row.directions.len()], gap: 0.0, weights: Vec::new() };
            if !row.is_covered {
                return change;
            }
            if let Some(own) = changes.as_ref().map(|changes| &changes[*index]) {
                change.directions = row.turned(&point.free, own.normal);
                change.weights = vec![0.0; point.sides.len()];
                for (&side, weight) in sides.iter().zip(&own.weights).filter(|(side, _)| **side > 0) {
                    change.weights[side] = -weight;
                }
                gap += own.gap + dot(own.normal, self.by_normal(point, row));
                gap += self.gap_slopes(point, row).iter().zip(&change.weights).map(|(s, w)| s * w).sum::<f64>();
            }
            RowChange { gap: if self.is_tied { 0.0 } else { gap }, ..change }
        };
        points.iter().zip(rows).zip(&self.nodes).map(of_node).collect()
    }

    /// The changes of the areas of the contact nodes along one field of velocities.
    pub(crate) fn area_changes(&self, velocities: &Velocities<'_>, column: usize) -> Vec<f64> {
        if self.is_fixed {
            return vec![0.0; self.nodes.len()];
        }
        let changes = self.mortar.changes(&|side, node| velocities.at(self.bodies[side], node, column));
        let area = |(index, sides): &(usize, Vec<usize>)| if sides.is_empty() { 0.0 } else { changes[*index].area };
        self.nodes.iter().map(area).collect()
    }
}

/// Σ_j m_ij x_j − x_i.
fn distance(point: &ContactPoint, weights: &[f64], positions: &[Arc<Vec<[f64; 3]>>; 2]) -> [f64; 3] {
    let mut sum = positions[0][point.node as usize].map(|x| -x);
    for (side, weight) in point.sides.iter().zip(weights).skip(1).filter(|(_, weight)| **weight != 0.0) {
        let x = positions[1][side.node as usize];
        (0..3).for_each(|axis| sum[axis] -= weight * x[axis]);
    }
    sum
}
