//! Supports: the directions in which nodes are held, and the displacements along them.

use crate::body::elasticity::facet::integrate;
use crate::body::mesh::{CellFace, Mesh};
use crate::error::SceneError;
use crate::names::find_face;
use crate::scene::{Held, Support};
use std::collections::{BTreeMap, HashMap};

/// Orthonormal directions in which a node is held, the axes among them first and in their order, and the displacement
/// that supports prescribe along them.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Directions {
    /// What supports ask for, along axes first.
    conditions: Vec<Condition>,
    axes: [bool; 3],
    /// Those across the axes, without their parts along the held axes.
    oblique: Vec<[f64; 3]>,
    all: Vec<[f64; 3]>,
    /// The first support that holds every direction, among those of the body.
    supports: Vec<usize>,
    /// The displacement of least length that fulfils all conditions, mm.
    displacement: [f64; 3],
}

/// A displacement that a support prescribes along a direction.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Condition {
    /// The axis that the direction is; 3 for the normal of a face.
    axis: usize,
    direction: [f64; 3],
    /// Displacement along it, mm.
    value: f64,
    /// The support among those of the body.
    support: usize,
}

/// Two supports that prescribe different displacements along one direction.
struct Conflict {
    supports: [usize; 2],
    /// Displacements, mm.
    values: [f64; 2],
}

/// Length of the new part of a direction that counts as none: others hold it already.
const DEPENDENT: f64 = 1e-8;

/// Difference of two displacements along one direction, relative to their size, that the rounding of normals explains.
const SAME: f64 = 2.0 * DEPENDENT;

impl Directions {
    fn add(&mut self, condition: Condition) -> Result<(), Conflict> {
        self.conditions.push(condition);
        self.conditions.sort_by_key(|condition| condition.axis);
        let known = Self { conditions: std::mem::take(&mut self.conditions), ..Self::default() };
        *self = known.resolved()?;
        Ok(())
    }

    /// Directions and displacement of the conditions.
    fn resolved(mut self) -> Result<Self, Conflict> {
        for &Condition { axis, direction, value, support } in &self.conditions {
            let along = dot(direction, self.displacement);
            let Some((rest, length)) = rest_beyond(&self.all, direction) else {
                let size = dot(self.displacement, self.displacement).sqrt().max(value.abs());
                if (value - along).abs() > SAME * size {
                    let share = |place: &usize| dot(direction, self.all[*place]).abs();
                    let other = (0..self.all.len()).max_by(|a, b| share(a).total_cmp(&share(b)));
                    let other = other.map_or(support, |place| self.supports[place]);
                    return Err(Conflict { supports: [other, support], values: [along, value] });
                }
                continue;
            };
            let step = (value - along) / length;
            (0..3).for_each(|axis| self.displacement[axis] += step * rest[axis]);
            match axis {
                3 => self.oblique.push(rest),
                axis => self.axes[axis] = true,
            }
            self.all.push(rest);
            self.supports.push(support);
        }
        Ok(self)
    }

    /// The held directions.
    pub fn held(&self) -> &[[f64; 3]] {
        &self.all
    }

    /// The first support that holds every direction, among those of the body.
    pub fn supports(&self) -> &[usize] {
        &self.supports
    }

    /// The prescribed displacement, along the axes, mm; a sum of held directions.
    pub fn displacement(&self) -> [f64; 3] {
        self.displacement
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

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    (0..3).map(|axis| a[axis] * b[axis]).sum()
}

/// The part of a vector along orthonormal directions; the vector itself if there are three.
pub(crate) fn onto(directions: &[[f64; 3]], vector: [f64; 3]) -> [f64; 3] {
    if directions.len() == 3 {
        return vector;
    }
    let mut sum = [0.0; 3];
    for direction in directions {
        let share = dot(*direction, vector);
        (0..3).for_each(|axis| sum[axis] += share * direction[axis]);
    }
    sum
}

/// The part of a unit vector beyond orthonormal ones, at length one; none if there is none.
pub(crate) fn beyond(known: &[[f64; 3]], direction: [f64; 3]) -> Option<[f64; 3]> {
    rest_beyond(known, direction).map(|(rest, _)| rest)
}

/// The part of a unit vector beyond orthonormal ones, at length one, with the length that it has.
fn rest_beyond(known: &[[f64; 3]], direction: [f64; 3]) -> Option<([f64; 3], f64)> {
    let mut rest = direction;
    for known in known {
        let share = dot(*known, rest);
        (0..3).for_each(|axis| rest[axis] -= share * known[axis]);
    }
    let length = dot(rest, rest).sqrt();
    (length > DEPENDENT).then(|| (rest.map(|x| x / length), length))
}

/// The held directions of all nodes that supports hold, with the displacements along them.
///
/// # Errors
/// [`SceneError::OutOfRange`] for faces that the mesh does not have, for displacements that are not finite, and for
/// supports that prescribe different displacements along one direction of a node.
pub fn held_directions(body: &str, mesh: &Mesh, supports: &[Support]) -> Result<HashMap<u32, Directions>, SceneError> {
    let mut held: HashMap<u32, Directions> = HashMap::new();
    for (index, support) in supports.iter().enumerate() {
        let field = format!("{body}.supports[{index}]");
        let faces = find_face(&format!("{field}.face"), &support.face, mesh)?;
        let conflict = |node: u32, conflict: Conflict| {
            let Conflict { supports: [first, second], values } = conflict;
            let place = mesh.nodes()[node as usize];
            SceneError::out_of_range(
                format!("{body}.supports[{second}]"),
                format!("a displacement of {} mm at the node at {place:?}", values[1]),
                format!("the {} mm that {body}.supports[{first}] prescribes there in this direction", values[0]),
            )
        };
        for (node, conditions) in conditions(&field, (index, support), mesh, faces)? {
            let own = held.entry(node).or_default();
            conditions.into_iter().try_for_each(|one| own.add(one)).map_err(|error| conflict(node, error))?;
        }
    }
    Ok(held)
}

/// What a support asks of the nodes of its faces, by ascending node.
fn conditions(
    field: &str,
    (index, support): (usize, &Support),
    mesh: &Mesh,
    faces: &[CellFace],
) -> Result<BTreeMap<u32, Vec<Condition>>, SceneError> {
    let finite = |value: f64| {
        let allowed = "a finite number (mm)";
        SceneError::require(value.is_finite(), format!("{field}: displacement"), value, allowed)
    };
    match support.held {
        Held::Components(values) => {
            values.into_iter().flatten().try_for_each(finite)?;
            let along = |axis: usize| {
                values[axis].map(|value| Condition { axis, direction: unit(axis), value, support: index })
            };
            let all: Vec<Condition> = (0..3).filter_map(along).collect();
            Ok(faces.iter().flat_map(|face| mesh.face_nodes(*face)).map(|node| (node, all.clone())).collect())
        }
        Held::Normal(value) => {
            finite(value)?;
            let of = |direction| vec![Condition { axis: 3, direction, value, support: index }];
            Ok(nodal_normals(mesh, mesh.nodes(), faces).into_iter().map(|(node, normal)| (node, of(normal))).collect())
        }
    }
}

/// Unit normals at the nodes of some faces, for nodes at these places: ∫ψ (a × b) of their corners, at length one; at
/// the middle of an edge, the mean of its ends.
pub(crate) fn nodal_normals(mesh: &Mesh, places: &[[f64; 3]], faces: &[CellFace]) -> HashMap<u32, [f64; 3]> {
    let mut sums: HashMap<u32, [f64; 3]> = HashMap::new();
    for &face in faces {
        let (nodes, corners) = mesh.face_with_corners(face);
        let positions: Vec<[f64; 3]> = nodes.iter().map(|&node| places[node as usize]).collect();
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
