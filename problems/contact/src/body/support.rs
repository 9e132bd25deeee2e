//! Supports: the directions in which nodes are held.

use crate::body::elasticity::facet::integrate;
use crate::body::mesh::{CellFace, Mesh};
use crate::error::SceneError;
use crate::names::find_face;
use crate::scene::{Held, Support};
use std::collections::HashMap;

/// Orthonormal directions in which a node is held; the axes among them come first, in their order.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Directions {
    axes: [bool; 3],
    /// Those across the axes, without their parts along the held axes.
    oblique: Vec<[f64; 3]>,
    all: Vec<[f64; 3]>,
}

/// Length of the new part of a direction that counts as none: others hold it already.
const DEPENDENT: f64 = 1e-8;

impl Directions {
    fn add_axes(&mut self, axes: [bool; 3]) {
        (0..3).for_each(|axis| self.axes[axis] |= axes[axis]);
        let oblique = std::mem::take(&mut self.oblique);
        self.update();
        oblique.into_iter().for_each(|direction| self.add(direction));
    }

    fn add(&mut self, direction: [f64; 3]) {
        if let Some(rest) = beyond(&self.all, direction) {
            self.oblique.push(rest);
        }
        self.update();
    }

    fn update(&mut self) {
        let axes = (0..3).filter(|&axis| self.axes[axis]).map(unit);
        self.all = axes.chain(self.oblique.iter().copied()).collect();
    }

    /// The held directions.
    pub fn held(&self) -> &[[f64; 3]] {
        &self.all
    }

    /// Orthonormal directions across them: the free axes, where all held directions are axes.
    pub fn free(&self) -> Vec<[f64; 3]> {
        let mut known = self.all.clone();
        let mut free = Vec::new();
        // Axes that are not held, those across the oblique directions first.
        let mut axes: Vec<usize> = (0..3).filter(|&axis| !self.axes[axis]).collect();
        let along = |axis: usize| self.oblique.iter().map(|direction| direction[axis].abs()).fold(0.0, f64::max);
        axes.sort_by(|&a, &b| along(a).total_cmp(&along(b)));
        for axis in axes {
            if let Some(rest) = beyond(&known, unit(axis)).filter(|_| known.len() < 3) {
                known.push(rest);
                free.push(rest);
            }
        }
        free
    }
}

fn unit(axis: usize) -> [f64; 3] {
    std::array::from_fn(|other| if other == axis { 1.0 } else { 0.0 })
}

/// The part of a unit vector beyond orthonormal ones, at length one; none if there is none.
pub(crate) fn beyond(known: &[[f64; 3]], direction: [f64; 3]) -> Option<[f64; 3]> {
    let mut rest = direction;
    for known in known {
        let share: f64 = (0..3).map(|axis| known[axis] * rest[axis]).sum();
        (0..3).for_each(|axis| rest[axis] -= share * known[axis]);
    }
    let length = rest.iter().map(|x| x * x).sum::<f64>().sqrt();
    (length > DEPENDENT).then(|| rest.map(|x| x / length))
}

/// The held directions of all nodes that supports hold.
///
/// # Errors
/// [`SceneError::OutOfRange`] for faces that the mesh does not have, and for a support that holds nothing.
pub fn held_directions(body: &str, mesh: &Mesh, supports: &[Support]) -> Result<HashMap<u32, Directions>, SceneError> {
    let mut held: HashMap<u32, Directions> = HashMap::new();
    for (index, support) in supports.iter().enumerate() {
        let field = format!("{body}.supports[{index}]");
        let faces = find_face(&format!("{field}.face"), &support.face, mesh)?;
        match support.held {
            Held::Components(axes) => {
                let nodes = faces.iter().flat_map(|face| mesh.face_nodes(*face));
                nodes.for_each(|node| held.entry(node).or_default().add_axes(axes));
            }
            Held::Normal => {
                let mut normals: Vec<(u32, [f64; 3])> = nodal_normals(mesh, faces).into_iter().collect();
                normals.sort_unstable_by_key(|(node, _)| *node);
                for (node, normal) in normals {
                    held.entry(node).or_default().add(normal);
                }
            }
        }
    }
    Ok(held)
}

/// Unit normals at the nodes of some faces at the reference shape: ∫ψ (a × b) of their corners, at length one; at the
/// middle of an edge, the mean of its ends.
pub(crate) fn nodal_normals(mesh: &Mesh, faces: &[CellFace]) -> HashMap<u32, [f64; 3]> {
    let mut sums: HashMap<u32, [f64; 3]> = HashMap::new();
    for &face in faces {
        let (nodes, corners) = mesh.face_with_corners(face);
        let positions: Vec<[f64; 3]> = nodes.iter().map(|&node| mesh.nodes()[node as usize]).collect();
        let mut own = vec![[0.0; 3]; corners];
        integrate(&positions, |point| {
            for (sum, value) in own.iter_mut().zip(point.corner_values) {
                (0..3).for_each(|axis| sum[axis] += value * point.area[axis]);
            }
        });
        let middles = (0..nodes.len() - corners).map(|edge| {
            let (a, b) = (own[edge], own[(edge + 1) % corners]);
            std::array::from_fn(|axis| 0.5 * (a[axis] + b[axis]))
        });
        let all: Vec<[f64; 3]> = own.iter().copied().chain(middles).collect();
        for (node, own) in nodes.iter().zip(all) {
            let sum = sums.entry(*node).or_default();
            (0..3).for_each(|axis| sum[axis] += own[axis]);
        }
    }
    for normal in sums.values_mut() {
        let length = normal.iter().map(|x| x * x).sum::<f64>().sqrt();
        *normal = normal.map(|x| x / length);
    }
    sums
}
