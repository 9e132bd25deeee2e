//! From the positions of all nodes to the contact rows, contact by contact; areas with their derivatives.

use crate::body::{Body, TraceWeights};
use crate::equilibrium::contact_part::{ContactPart, Counter};
use crate::equilibrium::pair_rows::PairRows;
use crate::equilibrium::{ContactBoundary, ContactPoint, ContactRows, NodeRows};
use crate::error::ContactError;
use crate::scalar::{Dual, Scalar};
use crate::scene::{CounterSurface, NormalKind};
use crate::shape::Velocities;
use std::collections::BTreeMap;
use std::sync::Arc;

/// What the contact rows of a shape are computed from.
#[derive(Debug, Clone)]
pub struct ContactGeometry {
    /// The contacts, in the order of the scene.
    pub(crate) parts: Vec<ContactPart>,
    /// Whether the numbers in weighted displacements change with the shape.
    pub(crate) traces_change: bool,
}

impl ContactGeometry {
    /// Whether the rows have the same directions and weights for all shapes.
    pub fn is_fixed(&self) -> bool {
        !self.traces_change && self.parts.iter().all(|part| part.is_fixed)
    }

    /// Whether areas of contact nodes change with the shape.
    pub fn areas_change(&self) -> bool {
        self.parts.iter().any(|part| part.areas_change)
    }

    /// Unit normal of the counter surface of a contact at the point nearest to a place, or straight above it; none
    /// where there is none.
    pub(crate) fn counter_normal(&self, contact: usize, x: [f64; 3]) -> Option<[f64; 3]> {
        let part = &self.parts[contact];
        let Counter::Obstacle(surface) = &part.counter else { return None };
        let normal = match part.normal {
            NormalKind::Surface => surface.foot(x).ok()?.normal,
            NormalKind::X3 => {
                let slope = surface.foot_along_x3(x).gap_slope;
                let length = slope.iter().map(|x| x * x).sum::<f64>().sqrt();
                slope.map(|x| -x / length)
            }
        };
        normal.iter().all(|x| x.is_finite()).then_some(normal)
    }

    /// The rows at given positions of the nodes of all bodies.
    ///
    /// # Errors
    /// [`ContactError::NoFoot`] for a contact node without a unique nearest point on its obstacle,
    /// [`ContactError::LeftMaster`] for one that no longer lies opposite to its master.
    pub fn rows(
        &self,
        boundary: &ContactBoundary,
        bodies: &[Body],
        positions: &[Arc<Vec<[f64; 3]>>],
    ) -> Result<ContactRows, ContactError> {
        let traces: Vec<TraceWeights> =
            bodies.iter().zip(positions).map(|(body, positions)| body.trace.weights(positions)).collect();
        let (mut nodes, mut pairs) = (Vec::with_capacity(boundary.points.len()), vec![None; self.parts.len()]);
        for contact in boundary.contacts() {
            let part = &self.parts[contact];
            let points = &boundary.points[boundary.of_contact(contact)];
            match &part.counter {
                Counter::Obstacle(surface) => {
                    nodes.extend(on_obstacle(part, surface, &bodies[part.slave], points, &positions[part.slave])?);
                }
                Counter::Pair(pair) => {
                    let (pair, rows) = PairRows::new((part, pair), points, positions)?;
                    nodes.extend(rows);
                    pairs[contact] = Some(pair);
                }
            }
        }
        Ok(ContactRows { nodes, pairs, traces, contact_count: boundary.contact_points().len() })
    }

    /// Adds sensitivities of the areas of the nodes that may open to those of the positions of nodes that move:
    /// `add(body, node, sensitivity)`.
    pub fn pull_back_areas(
        &self,
        (boundary, rows): (&ContactBoundary, &ContactRows),
        bodies: &[Body],
        positions: &[Arc<Vec<[f64; 3]>>],
        sensitivities: &[f64],
        moves: impl Fn(usize, u32) -> bool + Sync,
        mut add: impl FnMut(usize, u32, [f64; 3]),
    ) {
        for (contact, part) in self.parts.iter().enumerate().filter(|(_, part)| part.areas_change) {
            let range = boundary.of_contact(contact);
            // Nobody asks for the areas of glued nodes, which come last.
            let Some(own) = sensitivities.get(range.clone()) else { continue };
            if let Some(pair) = &rows.pairs[contact] {
                pair.pull_back_areas(own, &moves, &mut add);
                continue;
            }
            let weights: BTreeMap<u32, f64> =
                boundary.points[range].iter().zip(own).map(|(point, own)| (point.node, *own)).collect();
            let moves = |node: u32| moves(part.slave, node);
            obstacle_areas(part, &bodies[part.slave], &positions[part.slave], &weights, moves, |node, sensitivity| {
                add(part.slave, node, sensitivity);
            });
        }
    }

    /// The changes of the areas of all nodes that may open along one field of velocities.
    pub fn area_changes(
        &self,
        (boundary, rows): (&ContactBoundary, &ContactRows),
        bodies: &[Body],
        positions: &[Arc<Vec<[f64; 3]>>],
        velocities: &Velocities<'_>,
        column: usize,
    ) -> Vec<f64> {
        let mut changes = Vec::with_capacity(boundary.points.len());
        for (contact, part) in boundary.contacts().map(|contact| (contact, &self.parts[contact])) {
            if part.is_tied {
                continue;
            }
            let points = &boundary.points[boundary.of_contact(contact)];
            if let Some(pair) = &rows.pairs[contact] {
                changes.extend(pair.area_changes(velocities, column));
                continue;
            }
            let mut areas: BTreeMap<u32, f64> = BTreeMap::new();
            let dual = |node: u32| {
                let (x, v) = (positions[part.slave][node as usize], velocities.at(part.slave, node, column));
                std::array::from_fn(|axis| Dual::new(x[axis], v[axis]))
            };
            part.tributary_areas(&bodies[part.slave], dual, |nodes, own| {
                nodes.iter().zip(own).for_each(|(node, area)| *areas.entry(*node).or_insert(0.0) += area.derivative);
            });
            changes.extend(points.iter().map(|point| areas.get(&point.node).copied().unwrap_or(0.0)));
        }
        changes
    }
}

/// The rows of the nodes of a contact with an obstacle.
fn on_obstacle(
    part: &ContactPart,
    surface: &CounterSurface,
    body: &Body,
    points: &[ContactPoint],
    positions: &[[f64; 3]],
) -> Result<Vec<NodeRows>, ContactError> {
    let areas = part.areas(body, positions);
    let rows = |point: &ContactPoint| {
        let x = positions[point.node as usize];
        let foot = match part.normal {
            NormalKind::X3 => surface.foot_along_x3(x),
            NormalKind::Surface => {
                surface.foot(x).map_err(|reason| ContactError::NoFoot { node: point.node, place: x, reason })?
            }
        };
        let area = areas.get(&point.node).copied().unwrap_or(0.0);
        Ok(NodeRows::of_obstacle(point, foot, part.interference, area))
    };
    points.iter().map(rows).collect()
}

/// Adds sensitivities of the areas on an obstacle to those of the nodes that move.
fn obstacle_areas(
    part: &ContactPart,
    body: &Body,
    positions: &[[f64; 3]],
    weights: &BTreeMap<u32, f64>,
    moves: impl Fn(u32) -> bool,
    mut add: impl FnMut(u32, [f64; 3]),
) {
    let weight = |node: &u32| weights.get(node).copied().unwrap_or(0.0);
    for &face in &part.faces {
        let nodes: Vec<u32> = body.mesh.face_nodes(face).collect();
        let mut x: Vec<[Dual; 3]> = nodes.iter().map(|&node| positions[node as usize].map(Dual::constant)).collect();
        for index in (0..nodes.len()).filter(|&index| moves(nodes[index])) {
            let mut sensitivity = [0.0; 3];
            for (axis, sum) in sensitivity.iter_mut().enumerate() {
                x[index][axis].derivative = 1.0;
                let areas = crate::body::elasticity::facet::tributary_areas(&x, part.area_kind());
                *sum = nodes.iter().zip(areas).map(|(node, area)| weight(node) * area.derivative).sum();
                x[index][axis].derivative = 0.0;
            }
            add(nodes[index], sensitivity);
        }
    }
}
