//! The largest or the smallest of many values of the displacements: stresses at integration points, displacements of
//! nodes. Every point is a smooth function of its own.

use crate::body::Body;
use crate::cost::field_piece::FieldPiece;
use crate::cost::region::RegionCells;
use crate::equilibrium::SolvedBody;
use crate::shape::ShapeMap;
use std::sync::Arc;

/// Distance of a value from the extreme one over the largest absolute value, up to which its point is a piece: what a
/// step of an optimizer changes.
const NEAR: f64 = 0.1;
/// Most pieces: a model with more of them costs more than it tells.
const MAX_PIECES: usize = 200;

/// The points whose values count.
#[derive(Debug, Clone)]
pub(super) enum Points {
    /// Von Mises stresses at the integration points of some cells, MPa.
    Stresses(RegionCells),
    /// Displacements of some nodes of every body, mm: along an axis, or their lengths.
    Displacements { nodes: Vec<Vec<u32>>, component: Option<usize> },
}

/// The largest value of some points, or the smallest.
#[derive(Debug, Clone)]
pub(super) struct Extreme {
    pub points: Points,
    pub least: bool,
    pub bodies: Arc<[Body]>,
    pub map: Arc<ShapeMap>,
}

/// A point: its body, the place of its cell among those of the region or its node, and its integration point.
#[derive(Debug, Clone, Copy)]
struct Place {
    body: usize,
    at: usize,
    point: usize,
}

impl Extreme {
    /// The extreme value of solved bodies, lower first.
    pub fn value(&self, solved: &[SolvedBody]) -> f64 {
        self.way() * self.values(solved).iter().fold(f64::NEG_INFINITY, |most, (value, _)| most.max(self.way() * value))
    }

    /// The points within [`NEAR`] of the extreme value, that of it first; of equal ones the first.
    pub fn pieces(&self, solved: &[SolvedBody]) -> Vec<FieldPiece> {
        self.pieces_within(solved, NEAR, MAX_PIECES)
    }

    /// The first point of extreme value.
    pub fn first(&self, solved: &[SolvedBody]) -> Option<FieldPiece> {
        self.pieces_within(solved, 0.0, 1).pop()
    }

    fn pieces_within(&self, solved: &[SolvedBody], near: f64, most: usize) -> Vec<FieldPiece> {
        let mut values = self.values(solved);
        let way = self.way();
        let best = values.iter().fold(f64::NEG_INFINITY, |best, (value, _)| best.max(way * value));
        let size = values.iter().fold(0.0, |size: f64, (value, _)| size.max(value.abs()));
        values.retain(|(value, _)| way * value >= best - near * size);
        // The sort is stable: points of equal value stay in their order.
        values.sort_by(|(a, _), (b, _)| (way * b).total_cmp(&(way * a)));
        values.truncate(most);
        values.into_iter().map(|(value, place)| self.piece(solved, value, place)).collect()
    }

    /// 1 where the largest value counts, else −1.
    fn way(&self) -> f64 {
        if self.least { -1.0 } else { 1.0 }
    }

    fn values(&self, solved: &[SolvedBody]) -> Vec<(f64, Place)> {
        match &self.points {
            Points::Stresses(cells) => {
                let stresses = cells.map(&self.bodies, solved, |cell, modulus, u| cell.point_stresses(modulus, u));
                let of_cell = |body: usize, (at, stresses): (usize, Vec<f64>)| {
                    let place = move |(point, stress)| (stress, Place { body, at, point });
                    stresses.into_iter().enumerate().map(place)
                };
                let bodies = stresses.into_iter().enumerate();
                bodies
                    .flat_map(|(body, cells)| cells.into_iter().enumerate().flat_map(move |cell| of_cell(body, cell)))
                    .collect()
            }
            Points::Displacements { nodes, component } => {
                let of_body = |(body, (nodes, solved)): (usize, (&Vec<u32>, &SolvedBody))| {
                    let of_node = |&node: &u32| {
                        let u = solved.displacement[node as usize];
                        let value = component.map_or_else(|| length(u), |axis| u[axis]);
                        (value, Place { body, at: node as usize, point: 0 })
                    };
                    nodes.iter().map(of_node).collect::<Vec<_>>()
                };
                nodes.iter().zip(solved).enumerate().flat_map(of_body).collect()
            }
        }
    }

    fn piece(&self, solved: &[SolvedBody], value: f64, place: Place) -> FieldPiece {
        let before: usize = solved[..place.body].iter().map(|body| body.mesh.node_count()).sum();
        let index = |node: usize, axis: usize| 3 * (before + node) + axis;
        match &self.points {
            Points::Stresses(cells) => {
                let (cell, solved, body) =
                    (cells.cells[place.body][place.at], &solved[place.body], &self.bodies[place.body]);
                let u = body.mesh.cell_values(cell, &solved.displacement);
                let shear_modulus = body.solid.material(cell).shear_modulus();
                let stressed = body.mesh.cell_nodes(cell, &solved.positions);
                let stressed = stressed.stressed_at(place.point, shear_modulus, &u);
                let nodes = body.mesh.cell(cell).nodes;
                let of_node = |(node, entries): (&u32, &[f64; 3])| {
                    let (node, entries) = (*node as usize, *entries);
                    (0..3).map(move |axis| (index(node, axis), entries[axis]))
                };
                let displacements = nodes.iter().zip(&stressed.by_displacement).flat_map(of_node).collect();
                let moving = nodes.iter().zip(stressed.by_position);
                let moving = moving.filter(|(node, _)| self.map.moves(place.body, **node));
                let positions = moving.map(|(node, entry)| (before + *node as usize, entry));
                FieldPiece { value, displacements, positions: positions.collect() }
            }
            Points::Displacements { component, .. } => {
                let u = solved[place.body].displacement[place.at];
                let displacements = match component {
                    Some(axis) => vec![(index(place.at, *axis), 1.0)],
                    // The length has no derivative at 0; 0 is one of its subgradients there.
                    None if value == 0.0 => Vec::new(),
                    None => (0..3).map(|axis| (index(place.at, axis), u[axis] / value)).collect(),
                };
                FieldPiece { value, displacements, positions: Vec::new() }
            }
        }
    }
}

fn length(u: [f64; 3]) -> f64 {
    u.iter().map(|entry| entry * entry).sum::<f64>().sqrt()
}
