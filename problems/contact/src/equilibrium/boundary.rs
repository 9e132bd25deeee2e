//! The contact nodes and the layout of their multipliers.
//!
//! A *packed* contact vector holds, node by node, the normal row and the tangential rows that exist: none without
//! friction, and as many as there are free directions beside the normal (method.md section 3). The nodes of the
//! contacts of a scene follow each other; those that are glued come last.

use crate::body::{Body, beyond};
use crate::equilibrium::contact_part::ContactPart;
use crate::equilibrium::contact_point::{ContactPoint, Side};
use crate::error::SceneError;
use crate::names::nodes_of;
use crate::scene::{ContactScene, Scene};
use std::collections::BTreeSet;
use std::ops::Range;

/// All contact nodes of a scene.
#[derive(Debug, Clone)]
pub struct ContactBoundary {
    /// The nodes, contact by contact, ascending within each: those that may open, then those that are glued.
    pub points: Vec<ContactPoint>,
    /// Length of a packed contact vector.
    pub row_count: usize,
    /// Whether any node may take a friction force.
    has_friction: bool,
    /// The contacts of the scene in the order of their nodes.
    order: Vec<usize>,
}

impl ContactBoundary {
    /// The slave nodes of all contacts with what they may touch.
    ///
    /// # Errors
    /// [`SceneError::OutOfRange`] for names of regions that a mesh does not have, and for nodes that two contacts have.
    pub(crate) fn new(scene: &Scene, bodies: &[Body], parts: &[ContactPart]) -> Result<Self, SceneError> {
        let has_friction = scene.has_friction();
        let mut order: Vec<usize> = (0..parts.len()).collect();
        order.sort_by_key(|&index| scene.contacts[index].is_tied());
        let mut points = Vec::new();
        for &index in &order {
            let (contact, part) = (&scene.contacts[index], &parts[index]);
            let friction_of = friction_by_node(scene, index, &bodies[part.slave])?;
            for (node, masters) in part.nodes() {
                let side = |body: usize, node: u32| Side { body, node, prescribed: bodies[body].prescribed(node) };
                let masters = masters.iter().map(|&master| side(part.opposite.master().unwrap_or(part.slave), master));
                let sides: Vec<Side> = std::iter::once(side(part.slave, node)).chain(masters).collect();
                let has_weight = |side: usize| part.opposite.has_weight(node, sides[side].node);
                let free = free_directions(bodies, &sides, has_weight);
                // A node that supports hold altogether has no contact row.
                let Some(across) = free.len().checked_sub(1) else { continue };
                let tangents = if has_friction || contact.is_tied() { across } else { 0 };
                points.push(ContactPoint {
                    contact: index,
                    body: part.slave,
                    node,
                    sides,
                    start: 0,
                    tangents,
                    can_slide: across > 0,
                    friction: friction_of(node),
                    is_tied: contact.is_tied(),
                    free,
                });
            }
        }
        let mut this = Self { points, row_count: 0, has_friction, order };
        this.refuse_common_nodes(scene, bodies)?;
        this.number();
        Ok(this)
    }

    /// Leaves out nodes whose normals supports hold.
    pub(crate) fn retain(&mut self, keeps: impl Fn(usize) -> bool) {
        let mut index = 0;
        self.points.retain(|_| {
            index += 1;
            keeps(index - 1)
        });
        self.number();
    }

    /// Numbers the rows.
    fn number(&mut self) {
        self.row_count = 0;
        for point in &mut self.points {
            point.start = self.row_count;
            self.row_count += point.row_count();
        }
    }

    /// Refuses a node on the slave faces of two contacts: its rows would depend on each other.
    fn refuse_common_nodes(&self, scene: &Scene, bodies: &[Body]) -> Result<(), SceneError> {
        let mut known = BTreeSet::new();
        for point in &self.points {
            if !known.insert((point.body, point.node)) {
                let [x1, x2, x3] = bodies[point.body].mesh.nodes()[point.node as usize];
                let field = format!("{}.slave", scene.contact_field(point.contact));
                let value = format!("a face with the node at ({x1:.4}, {x2:.4}, {x3:.4}) mm of another contact");
                let allowed = "slave faces without common nodes (let the other body be the slave, or leave out a row)";
                return Err(SceneError::out_of_range(field, value, allowed));
            }
        }
        Ok(())
    }

    /// The contacts of the scene in the order of their nodes.
    pub(crate) fn contacts(&self) -> impl Iterator<Item = usize> + '_ {
        self.order.iter().copied()
    }

    /// The nodes of a contact of the scene.
    pub fn of_contact(&self, contact: usize) -> Range<usize> {
        let first = self.points.iter().position(|point| point.contact == contact).unwrap_or(0);
        first..first + self.points.iter().filter(|point| point.contact == contact).count()
    }

    /// The nodes that may open: all but those that are glued.
    pub fn contact_points(&self) -> &[ContactPoint] {
        &self.points[..self.points.partition_point(|point| !point.is_tied)]
    }

    /// Whether the scene has friction, and with it tangential multipliers.
    pub fn has_friction(&self) -> bool {
        self.has_friction
    }

    /// Whether some nodes are glued to their master.
    pub fn has_ties(&self) -> bool {
        self.points.iter().any(|point| point.is_tied)
    }
}

/// The friction coefficient of every node of the slave face of a contact.
fn friction_by_node<'s>(scene: &'s Scene, index: usize, body: &Body) -> Result<impl Fn(u32) -> f64 + 's, SceneError> {
    let contact: &ContactScene = &scene.contacts[index];
    let field = format!("{}.friction_by_region", scene.contact_field(index));
    let mut regions: Vec<(BTreeSet<u32>, f64)> = Vec::new();
    for (name, friction) in &contact.friction_by_region {
        regions.push((nodes_of(&field, name, &body.mesh)?.into_iter().collect(), *friction));
    }
    Ok(move |node: u32| {
        let named = regions.iter().rev().find(|(nodes, _)| nodes.contains(&node));
        named.map_or(contact.friction, |(_, friction)| *friction)
    })
}

/// Share of a held direction from which a master node counts as held along it.
const HELD_ALONG: f64 = 1e-8;

/// Directions in which the first of some nodes is free, and those in which supports hold it but none of the others: its
/// jumps along them are unknown. In a plane of symmetry, supports hold nodes on both sides.
fn free_directions(bodies: &[Body], sides: &[Side], has_weight: impl Fn(usize) -> bool) -> Vec<[f64; 3]> {
    let own = &bodies[sides[0].body];
    let mut free = own.free(sides[0].node);
    let others: Vec<&Side> = (1..sides.len()).filter(|&side| has_weight(side)).map(|side| &sides[side]).collect();
    for direction in own.held(sides[0].node) {
        let is_held = |side: &&&Side| {
            let held = bodies[side.body].held(side.node).iter();
            let shares = held.map(|other| (0..3).map(|axis| other[axis] * direction[axis]).sum::<f64>());
            shares.map(|share| share * share).sum::<f64>().sqrt() > HELD_ALONG
        };
        if !others.is_empty() && !others.iter().any(|side| is_held(&side)) {
            free.extend(beyond(&free, *direction));
        }
    }
    free
}
