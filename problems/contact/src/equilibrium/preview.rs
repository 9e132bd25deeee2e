//! What is known of a scene before any solve: gaps, supports, free motions, loads.

use crate::body::MOTIONS;
use crate::body::loads::nodal_forces;
use crate::body::mesh::smallest_extent;
use crate::equilibrium::modes::OwnMotion;
use crate::equilibrium::{ContactProblem, ContactRows};
use crate::scene::Held;
use crate::shape::Positions;
use serde::Serialize;

/// What is known of a shape before a solve.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Preview {
    /// Number of contact nodes.
    pub contact_nodes: usize,
    /// Least and largest gap, mm; negative where the bodies overlap.
    pub gaps: [f64; 2],
    /// Number of contact nodes whose gaps are negative by more than rounding: 1e-9 of the smallest extent of a body.
    pub overlapping: usize,
    /// The bodies, lower first.
    pub bodies: Vec<BodyPreview>,
}

/// What is known of one body before a solve.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct BodyPreview {
    /// Its name.
    pub name: String,
    /// The faces that supports hold, in the order of the scene.
    pub held_faces: Vec<String>,
    /// Number of independent rigid motions that its supports leave free, 0 to 6.
    pub free_motions: usize,
    /// Whether its supports leave translations along x₁, x₂, x₃ free.
    pub free_translations: [bool; 3],
    /// Resultant of its loads along x₁, x₂, x₃, N.
    pub load: [f64; 3],
}

/// Part of a translation beyond the free motions that is rounding.
const FREE: f64 = 1e-9;
/// Part of the smallest extent of the bodies up to which a negative gap is rounding.
const CLOSED: f64 = 1e-9;

impl ContactProblem {
    /// What is known of the scene before a solve, at its start.
    pub fn preview(&self) -> Preview {
        self.preview_at(&self.start_positions(), self.start_rows())
    }

    /// What is known of a shape before its solve: `positions` of all nodes, mm, and the contact rows there.
    pub fn preview_at(&self, positions: &Positions, rows: &ContactRows) -> Preview {
        let rigid = self.rigid_scene(positions, rows);
        let of_body = |(number, scene): (usize, &crate::scene::BodyScene)| {
            let body = &self.bodies[number];
            let motions = rigid.own_motions(number);
            let mut held_faces: Vec<String> = Vec::new();
            for support in scene.supports.iter().filter(|support| support.held != Held::Components([None; 3])) {
                if !held_faces.contains(&support.face) {
                    held_faces.push(support.face.clone());
                }
            }
            let mut load = [0.0; 3];
            for (_, force) in nodal_forces(body, &positions[number]) {
                (0..3).for_each(|axis| load[axis] += force[axis]);
            }
            let free_translations = std::array::from_fn(|axis| is_free(&motions, axis));
            BodyPreview { name: body.name.clone(), held_faces, free_motions: motions.len(), free_translations, load }
        };
        let gaps = || rows.contact_nodes().iter().filter(|node| node.is_covered).map(|node| node.gap);
        let size = positions.iter().map(|nodes| smallest_extent(nodes)).fold(f64::INFINITY, f64::min);
        Preview {
            contact_nodes: gaps().count(),
            gaps: [gaps().fold(f64::INFINITY, f64::min), gaps().fold(f64::NEG_INFINITY, f64::max)],
            overlapping: gaps().filter(|gap| *gap < -CLOSED * size).count(),
            bodies: self.scene.bodies.iter().enumerate().map(of_body).collect(),
        }
    }
}

/// Whether a motion along one coefficient is a sum of free motions, which are orthonormal.
fn is_free(motions: &[OwnMotion], coefficient: usize) -> bool {
    debug_assert!(coefficient < MOTIONS);
    let inside: f64 = motions.iter().map(|motion| motion[coefficient].powi(2)).sum();
    1.0 - inside <= FREE
}
