//! The contact nodes and the layout of their multipliers.
//!
//! A *packed* contact vector holds, node by node, the normal row and the tangential rows that exist: none without
//! friction, and as many as there are free directions beside the normal (method.md section 3).

use crate::body::mesh::CellFace;
use crate::body::{Body, beyond};
use crate::error::SceneError;
use crate::names::nodes_of;
use crate::scene::ContactScene;
use std::collections::BTreeSet;

/// A node of a body in the rows of a contact node.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Side {
    /// The body.
    pub body: usize,
    /// The node of its mesh.
    pub node: u32,
    /// Its weight in jumps: 1 for the contact node itself, −1 for its partner.
    pub weight: f64,
}

/// A node of the contact surface with its rows.
#[derive(Debug, Clone, PartialEq)]
pub struct ContactPoint {
    /// The node of the lower body.
    pub node: u32,
    /// The nodes in its rows, its own first.
    pub sides: Vec<Side>,
    /// Position of its normal row in a packed contact vector.
    pub start: usize,
    /// Number of its tangential rows.
    pub tangents: usize,
    /// Whether any tangential direction is free, with or without a row.
    pub can_slide: bool,
    /// Friction coefficient 𝓕.
    pub friction: f64,
    /// Orthonormal directions in which one of its nodes is free.
    pub free: Vec<[f64; 3]>,
}

impl ContactPoint {
    /// Number of rows of this node.
    pub fn row_count(&self) -> usize {
        1 + self.tangents
    }

    /// Its rows in a packed contact vector.
    pub fn rows(&self) -> std::ops::Range<usize> {
        self.start..self.start + self.row_count()
    }
}

/// All contact nodes of a scene.
#[derive(Debug, Clone)]
pub struct ContactBoundary {
    /// The nodes, ascending.
    pub points: Vec<ContactPoint>,
    /// Length of a packed contact vector.
    pub row_count: usize,
    has_friction: bool,
}

impl ContactBoundary {
    /// The corners of some faces of the lower body, each with its partner on the upper body where there is one.
    ///
    /// # Errors
    /// [`SceneError::OutOfRange`] for names of regions that the mesh does not have.
    pub(crate) fn new(
        scene: &ContactScene,
        bodies: &[Body],
        faces: &[CellFace],
        partner: impl Fn(u32) -> Option<u32>,
    ) -> Result<Self, SceneError> {
        let lower = &bodies[0];
        let mut friction_of: Vec<(BTreeSet<u32>, f64)> = Vec::new();
        for (name, friction) in &scene.friction_by_region {
            friction_of
                .push((nodes_of("contact.friction_by_region", name, &lower.mesh)?.into_iter().collect(), *friction));
        }
        let has_friction = scene.has_friction();
        let nodes: BTreeSet<u32> = faces.iter().flat_map(|face| corners(lower, *face)).collect();
        let mut row_count = 0;
        let point = |node: u32| {
            let sides = std::iter::once(Side { body: 0, node, weight: 1.0 });
            let sides = sides.chain(partner(node).map(|node| Side { body: 1, node, weight: -1.0 }));
            let sides: Vec<Side> = sides.collect();
            let free = free_directions(bodies, &sides);
            let across = free.len().checked_sub(1)?;
            let named = friction_of.iter().rev().find(|(nodes, _)| nodes.contains(&node));
            let friction = named.map_or(scene.friction, |(_, friction)| *friction);
            let tangents = if has_friction { across } else { 0 };
            let point = ContactPoint { node, sides, start: row_count, tangents, can_slide: across > 0, friction, free };
            row_count += point.row_count();
            Some(point)
        };
        // A node that supports hold altogether has no contact row.
        let points: Vec<ContactPoint> = nodes.into_iter().filter_map(point).collect();
        Ok(Self { points, row_count, has_friction })
    }

    /// Leaves out nodes whose normals supports hold.
    pub(crate) fn retain(&mut self, keeps: impl Fn(usize) -> bool) {
        let mut index = 0;
        self.points.retain(|_| {
            index += 1;
            keeps(index - 1)
        });
        self.row_count = 0;
        for point in &mut self.points {
            point.start = self.row_count;
            self.row_count += point.row_count();
        }
    }

    /// Whether the scene has friction, and with it tangential multipliers.
    pub fn has_friction(&self) -> bool {
        self.has_friction
    }
}

/// Corners of a face of a body.
pub(crate) fn corners(body: &Body, face: CellFace) -> impl Iterator<Item = u32> + '_ {
    let corners = body.mesh.cell(face.cell as usize).kind.corner_count();
    body.mesh.face_nodes(face).take(corners)
}

/// Orthonormal directions in which one of some nodes is free: those that not all of them are held in.
fn free_directions(bodies: &[Body], sides: &[Side]) -> Vec<[f64; 3]> {
    let mut free: Vec<[f64; 3]> = Vec::new();
    for direction in sides.iter().flat_map(|side| bodies[side.body].free(side.node)) {
        free.extend(beyond(&free, direction));
    }
    free
}
