//! The contact rows at one shape, and their derivatives; those of a node stand in [`node_rows`](super::node_rows).

use crate::body::{Body, TraceWeights};
use crate::equilibrium::node_rows::{NodeRows, RowChange, RowSensitivities, dot};
use crate::equilibrium::opposite::Facing;
use crate::equilibrium::{ContactBoundary, ContactPoint, ContactStatus};
use crate::shape::Velocities;
use std::sync::Arc;

/// The rows of all contact nodes at a shape, in the order of [`ContactBoundary::points`].
#[derive(Debug, Clone, Default)]
pub struct ContactRows {
    /// The rows of every node.
    pub nodes: Vec<NodeRows>,
    /// What the numbers of the nodes change with, in the order of [`ContactBoundary::contacts`].
    pub(crate) facing: Vec<Arc<dyn Facing>>,
    /// The weights in the weighted displacements of every body.
    pub(crate) traces: Vec<TraceWeights>,
    /// Number of nodes that may open, which come first.
    pub(crate) contact_count: usize,
}

impl ContactRows {
    /// Adds sensitivities with respect to directions, weights, gaps and areas to those of the positions of nodes:
    /// `add(body, node, sensitivity)`. `moves`: whether a node of a body moves with the shape.
    pub fn pull_back(
        &self,
        boundary: &ContactBoundary,
        sensitivities: &[RowSensitivities],
        moves: impl Fn(usize, u32) -> bool + Sync,
        mut add: impl FnMut(usize, u32, [f64; 3]),
    ) {
        let of_node =
            |((point, node), own): ((&ContactPoint, &NodeRows), &RowSensitivities)| node.pull_back(point, own);
        let numbers: Vec<_> = boundary.points.iter().zip(&self.nodes).zip(sensitivities).map(of_node).collect();
        for (contact, facing) in boundary.contacts().zip(&self.facing) {
            let range = boundary.of_contact(contact);
            let nodes = (&boundary.points[range.clone()], &self.nodes[range.clone()]);
            facing.pull_back(nodes, &numbers[range], &moves, &mut add);
        }
    }

    /// The changes of the rows of all nodes along one field of velocities.
    pub fn changes(&self, boundary: &ContactBoundary, velocities: &Velocities<'_>, column: usize) -> Vec<RowChange> {
        let mut changes = Vec::with_capacity(self.nodes.len());
        for (contact, facing) in boundary.contacts().zip(&self.facing) {
            let range = boundary.of_contact(contact);
            let (points, nodes) = (&boundary.points[range.clone()], &self.nodes[range]);
            let numbers = facing.changes((points, nodes), velocities, column);
            changes.extend(points.iter().zip(nodes).zip(numbers).map(|((point, node), own)| node.change(point, own)));
        }
        changes
    }

    /// The changes of the areas of the nodes that may open, mm², among those of all rows.
    pub(crate) fn area_changes(&self, changes: &[RowChange]) -> Vec<f64> {
        changes[..self.contact_count].iter().map(|change| change.area).collect()
    }

    /// σ = λ_N/A per contact node that may open, MPa, of normal forces in N.
    pub fn pressures(&self, normal: &[f64]) -> Vec<f64> {
        normal.iter().zip(&self.nodes).map(|(force, node)| force / node.area).collect()
    }

    /// Derivatives with respect to the packed rows from those with respect to the normal forces and to the tangential
    /// forces along the axes (as [`ContactForces`](crate::equilibrium::ContactForces) has them), at fixed directions; 0
    /// by the forces of glued nodes.
    pub fn pack(&self, normal: &[f64], tangential: &[[f64; 3]]) -> Vec<f64> {
        let mut packed = Vec::new();
        for (index, node) in self.nodes.iter().enumerate() {
            let Some(normal) = normal.get(index) else {
                packed.extend(vec![0.0; node.directions.len()]);
                continue;
            };
            packed.push(*normal);
            let along =
                |direction: &[f64; 3]| (0..3).map(|axis| direction[axis] * tangential[index][axis]).sum::<f64>();
            packed.extend(node.directions.iter().skip(1).map(along));
        }
        packed
    }

    /// Jumps less gaps of all packed rows where free directions are at rest and held ones where supports put them, mm.
    pub fn prescribed_approaches(&self, boundary: &ContactBoundary, bodies: &[Body]) -> Vec<f64> {
        let mut approaches = Vec::with_capacity(boundary.row_count);
        for (point, node) in boundary.points.iter().zip(&self.nodes) {
            let (own, by_trace) =
                (point.prescribed_jump(&node.weights), self.prescribed_by_trace((point, node), bodies));
            let jump: [f64; 3] = std::array::from_fn(|axis| own[axis] + by_trace[axis]);
            approaches.extend(node.directions.iter().map(|direction| dot(*direction, jump)));
            approaches[point.start] -= node.gap;
        }
        approaches
    }

    /// The jump of a contact node by what supports prescribe to the middle nodes in its weighted displacements, mm.
    pub(crate) fn prescribed_by_trace(&self, (point, node): (&ContactPoint, &NodeRows), bodies: &[Body]) -> [f64; 3] {
        let mut jump = [0.0; 3];
        let sides = point.sides.iter().zip(&node.weights);
        for (side, weight) in sides.filter(|(side, _)| !bodies[side.body].trace.is_nodal(side.node)) {
            let (body, prescribed) = (&bodies[side.body], |node: u32| bodies[side.body].prescribed(node));
            let moved = body.trace.value(&self.traces[side.body], side.node, &prescribed);
            (0..3).for_each(|axis| jump[axis] += weight * (moved[axis] - side.prescribed[axis]));
        }
        jump
    }

    /// Initial gaps of all nodes, mm; 0 where they are glued.
    pub fn gaps(&self) -> impl Iterator<Item = f64> + '_ {
        self.nodes.iter().map(|node| node.gap)
    }

    /// The rows of the nodes that may open.
    pub fn contact_nodes(&self) -> &[NodeRows] {
        &self.nodes[..self.contact_count]
    }

    /// Area of the contact surface, mm².
    pub fn area(&self) -> f64 {
        self.contact_nodes().iter().map(|node| node.area).sum()
    }

    /// Area of the closed nodes, Σ A over the nodes that stick or slip, mm²; one status per node.
    pub fn closed_area(&self, status: &[ContactStatus]) -> f64 {
        let nodes = self.nodes.iter().zip(status).filter(|(_, status)| **status != ContactStatus::Open);
        nodes.map(|(node, _)| node.area).fold(0.0, |sum, area| sum + area)
    }

    /// Tributary areas of the nodes that may open, mm².
    pub fn areas(&self) -> Vec<f64> {
        self.contact_nodes().iter().map(|node| node.area).collect()
    }

    /// The directions of all packed rows.
    pub fn directions(&self) -> impl Iterator<Item = [f64; 3]> + '_ {
        self.nodes.iter().flat_map(|node| node.directions.iter().copied())
    }
}
