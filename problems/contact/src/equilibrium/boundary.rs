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

/// Part of a prescribed jump, relative to the displacements that it is the difference of, that is rounding.
const ROUNDING: f64 = 1e-13;

/// A node of a body in the rows of a contact node.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Side {
    /// The body.
    pub body: usize,
    /// The node of its mesh.
    pub node: u32,
    /// Its weight in jumps: 1 for the contact node itself, −1 for its partner.
    pub weight: f64,
    /// The displacement that supports prescribe to it along its held directions, mm.
    pub prescribed: [f64; 3],
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
    /// The part of its prescribed jump along directions in which all its nodes are held, mm: no row has it.
    pub imposed: [f64; 3],
}

impl ContactPoint {
    /// Number of rows of this node.
    pub fn row_count(&self) -> usize {
        1 + self.tangents
    }

    /// Σ weight · prescribed displacement of its nodes, mm: the jump where nothing else moves.
    pub fn prescribed_jump(&self) -> [f64; 3] {
        prescribed_jump(&self.sides)
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
            let side = |body: usize, node: u32, weight: f64| {
                let prescribed = bodies[body].prescribed(node);
                Side { body, node, weight, prescribed }
            };
            let sides = std::iter::once(side(0, node, 1.0));
            let sides: Vec<Side> = sides.chain(partner(node).map(|node| side(1, node, -1.0))).collect();
            let free = free_directions(bodies, &sides);
            let across = free.len().checked_sub(1)?;
            let named = friction_of.iter().rev().find(|(nodes, _)| nodes.contains(&node));
            let friction = named.map_or(scene.friction, |(_, friction)| *friction);
            let tangents = if has_friction { across } else { 0 };
            let (start, can_slide, imposed) = (row_count, across > 0, imposed(&sides, &free));
            let point = ContactPoint { node, sides, start, tangents, can_slide, friction, free, imposed };
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

fn prescribed_jump(sides: &[Side]) -> [f64; 3] {
    std::array::from_fn(|axis| sides.iter().map(|side| side.weight * side.prescribed[axis]).sum())
}

/// The part of the prescribed jump of some nodes across the directions in which one of them is free.
fn imposed(sides: &[Side], free: &[[f64; 3]]) -> [f64; 3] {
    let mut jump = prescribed_jump(sides);
    let size = |vector: [f64; 3]| vector.iter().fold(0.0, |size: f64, x| size.max(x.abs()));
    let largest = sides.iter().map(|side| size(side.prescribed)).fold(0.0, f64::max);
    for direction in free {
        let share: f64 = (0..3).map(|axis| direction[axis] * jump[axis]).sum();
        (0..3).for_each(|axis| jump[axis] -= share * direction[axis]);
    }
    if size(jump) > ROUNDING * largest { jump } else { [0.0; 3] }
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
