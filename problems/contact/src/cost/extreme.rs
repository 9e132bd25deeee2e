//! The largest or the smallest of many values of a contact state: stresses at integration points, displacements of
//! nodes, slips. Every point is a smooth function of its own.

use crate::body::Body;
use crate::cost::contact_work::{ContactNodes, component, direction};
use crate::cost::piece::StatePiece;
use crate::cost::region::RegionCells;
use crate::cost::row_terms::RowTerms;
use crate::equilibrium::ContactProblem;
use crate::equilibrium::row_work::NodeValues;
use crate::mortar::vector::plus;
use std::collections::BTreeMap;

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
    /// Displacements of some nodes of every body, mm, less their mean over others: along an axis, or their lengths.
    Displacements { nodes: Vec<Vec<u32>>, base: MeanNodes, axis: Option<usize> },
    /// Lengths of the slips of some contact nodes, mm.
    Slips(ContactNodes),
}

/// Nodes of some bodies with weights of sum 1, or none.
pub(super) type MeanNodes = Vec<(usize, u32, f64)>;

/// The largest value of some points, or the smallest.
#[derive(Debug, Clone)]
pub(super) struct Extreme {
    pub points: Points,
    pub least: bool,
}

/// A point: its body, the place of its cell among those of the region or its node, and its integration point. Of slips,
/// the place of the contact node.
#[derive(Debug, Clone, Copy)]
struct Place {
    body: usize,
    at: usize,
    point: usize,
}

impl Extreme {
    /// The extreme value at a state.
    pub fn value(&self, terms: RowTerms<'_>) -> f64 {
        self.way() * self.values(terms).iter().fold(f64::NEG_INFINITY, |most, (value, _)| most.max(self.way() * value))
    }

    /// The points within [`NEAR`] of the extreme value, that of it first; of equal ones the first.
    pub fn pieces(&self, terms: RowTerms<'_>) -> Vec<StatePiece> {
        self.pieces_within(terms, NEAR, MAX_PIECES)
    }

    /// The first point of extreme value.
    pub fn first(&self, terms: RowTerms<'_>) -> Option<StatePiece> {
        self.pieces_within(terms, 0.0, 1).pop()
    }

    fn pieces_within(&self, terms: RowTerms<'_>, near: f64, most: usize) -> Vec<StatePiece> {
        let mut values = self.values(terms);
        let way = self.way();
        let best = values.iter().fold(f64::NEG_INFINITY, |best, (value, _)| best.max(way * value));
        let size = values.iter().fold(0.0, |size: f64, (value, _)| size.max(value.abs()));
        values.retain(|(value, _)| way * value >= best - near * size);
        // The sort is stable: points of equal value stay in their order.
        values.sort_by(|(a, _), (b, _)| (way * b).total_cmp(&(way * a)));
        values.truncate(most);
        let u = self.slipping(terms);
        values.into_iter().map(|(value, place)| self.piece((terms, &u), value, place)).collect()
    }

    /// 1 where the largest value counts, else −1.
    fn way(&self) -> f64 {
        if self.least { -1.0 } else { 1.0 }
    }

    fn values(&self, terms: RowTerms<'_>) -> Vec<(f64, Place)> {
        let (bodies, at) = (&terms.problem.bodies, terms.at);
        match &self.points {
            Points::Stresses(cells) => {
                let stresses = cells.map(bodies, at.bodies, |cell, modulus, u| cell.point_stresses(modulus, u));
                let of_cell = |body: usize, (at, stresses): (usize, Vec<f64>)| {
                    let place = move |(point, stress)| (stress, Place { body, at, point });
                    stresses.into_iter().enumerate().map(place)
                };
                let bodies = stresses.into_iter().enumerate();
                bodies
                    .flat_map(|(body, cells)| cells.into_iter().enumerate().flat_map(move |cell| of_cell(body, cell)))
                    .collect()
            }
            Points::Displacements { nodes, base, axis } => {
                let mean = mean(terms, base);
                let of_body = |(body, nodes): (usize, &Vec<u32>)| {
                    let of_node = |&node: &u32| {
                        let moved = plus(at.displacement(body, node), -1.0, mean);
                        (component(moved, *axis), Place { body, at: node as usize, point: 0 })
                    };
                    nodes.iter().map(of_node).collect::<Vec<_>>()
                };
                nodes.iter().enumerate().flat_map(of_body).collect()
            }
            Points::Slips(nodes) => {
                let u = self.slipping(terms);
                let slip = |index: usize| (terms.slip(index, &u).0, Place { body: 0, at: index, point: 0 });
                nodes.0.clone().map(slip).collect()
            }
        }
    }

    /// The weighted displacements of the nodes of the contact rows, where slips need them.
    fn slipping(&self, terms: RowTerms<'_>) -> NodeValues {
        match self.points {
            Points::Slips(_) => terms.weighted(&|body, node| terms.at.displacement(body, node)),
            Points::Stresses(_) | Points::Displacements { .. } => NodeValues::zeros(0),
        }
    }

    fn piece(&self, (terms, u): (RowTerms<'_>, &NodeValues), value: f64, place: Place) -> StatePiece {
        match &self.points {
            Points::Stresses(cells) => {
                stress_piece(terms, value, (place.body, cells.cells[place.body][place.at], place.point))
            }
            Points::Displacements { base, axis, .. } => {
                let problem = terms.problem;
                let moved = plus(terms.at.displacement(place.body, place.at as u32), -1.0, mean(terms, base));
                let along = direction(moved, *axis);
                let own = std::iter::once((place.body, place.at as u32, 1.0));
                let weighted = own.chain(base.iter().map(|&(body, node, weight)| (body, node, -weight)));
                StatePiece { value, displacements: entries(problem, weighted, along), positions: Vec::new() }
            }
            Points::Slips(_) => slip_piece((terms, u), value, place.at),
        }
    }
}

/// Nonzero derivatives of Σ weights · e·u by the displacements.
fn entries(
    problem: &ContactProblem,
    weighted: impl Iterator<Item = (usize, u32, f64)>,
    along: [f64; 3],
) -> Vec<(usize, f64)> {
    let of_node = |(body, node, weight): (usize, u32, f64)| {
        let first = 3 * problem.map.number(body, node);
        (0..3).map(move |axis| (first + axis, weight * along[axis]))
    };
    weighted.flat_map(of_node).filter(|(_, entry)| *entry != 0.0).collect()
}

/// The stress at an integration point of a cell.
fn stress_piece(terms: RowTerms<'_>, value: f64, (number, cell, point): (usize, usize, usize)) -> StatePiece {
    let (problem, solved): (_, _) = (terms.problem, &terms.at.bodies[number]);
    let body: &Body = &problem.bodies[number];
    let u = body.mesh.cell_values(cell, &solved.displacement);
    let shear_modulus = body.solid.material(cell).shear_modulus();
    let stressed = body.mesh.cell_nodes(cell, &solved.positions).stressed_at(point, shear_modulus, &u);
    let nodes = body.mesh.cell(cell).nodes;
    let of_node = |(node, entries): (&u32, &[f64; 3])| {
        let (first, entries) = (3 * problem.map.number(number, *node), *entries);
        (0..3).map(move |axis| (first + axis, entries[axis]))
    };
    let displacements = nodes.iter().zip(&stressed.by_displacement).flat_map(of_node).collect();
    let moving = nodes.iter().zip(stressed.by_position).filter(|(node, _)| problem.map.moves(number, **node));
    let positions = moving.map(|(node, entry)| (problem.node_number(number, *node), entry)).collect();
    StatePiece { value, displacements, positions }
}

/// The length of the slip of a contact node.
fn slip_piece((terms, u): (RowTerms<'_>, &NodeValues), value: f64, index: usize) -> StatePiece {
    let problem = terms.problem;
    let mut displacements = BTreeMap::new();
    let positions = terms.slip_gradient(index, u, |body, node, share| {
        let first = 3 * problem.map.number(body, node);
        (0..3).for_each(|axis| *displacements.entry(first + axis).or_insert(0.0) += share[axis]);
    });
    displacements.retain(|_, entry| *entry != 0.0);
    let positions = positions.into_iter().enumerate().filter(|(_, entry)| *entry != [0.0; 3]).collect();
    StatePiece { value, displacements: displacements.into_iter().collect(), positions }
}

/// Σ weights · u over some nodes, mm.
fn mean(terms: RowTerms<'_>, nodes: &MeanNodes) -> [f64; 3] {
    nodes.iter().fold([0.0; 3], |sum, &(body, node, weight)| plus(sum, weight, terms.at.displacement(body, node)))
}
