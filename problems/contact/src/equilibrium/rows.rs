//! The geometry of the contact rows at one shape, and its derivatives; geometry by obstacle or by pairs of nodes.
//!
//! ```text
//! P: onto the free directions,  c = |P n|,  m = P n/c:    d₀ = P n,   t_k: orthonormal in the range of P across m
//! jump of row r = Σ_sides weight d_r·u,    force of the body on the counter surface = Σ λ_r d_r
//! gap = (distance of the shapes) − (interference) − n·(I − P) v,    v: jump that supports prescribe
//! d₀′ = P n′,   t_k′ = −(t_k·n′)/c m,   gap′,  A′
//! ```
//! A rotation of the tangential rows in their plane changes no force, so that its derivative is taken as zero.

use crate::body::Body;
use crate::body::elasticity::facet::tributary_areas;
use crate::body::mesh::CellFace;
use crate::equilibrium::{ContactBoundary, ContactPoint, ContactStatus};
use crate::error::ContactError;
use crate::scalar::{Dual, Scalar};
use crate::scene::{AreaKind, ContactScene, CounterSurface, Foot, NormalKind};
use crate::shape::Velocities;
use std::collections::BTreeMap;

/// The rows of one contact node at a shape.
#[derive(Debug, Clone, PartialEq)]
pub struct NodeRows {
    /// Unit normal n from the lower body outwards.
    pub normal: [f64; 3],
    /// Directions of its rows: P n, then the tangential ones; as many as the node has rows.
    pub directions: Vec<[f64; 3]>,
    /// Gap before loading less the interference, mm; negative where the shapes overlap. Where supports hold all its
    /// nodes in a direction, it is the gap of the place where they put the node along that direction.
    pub gap: f64,
    /// Tributary area A, mm².
    pub area: f64,
    gap_slope: [f64; 3],
    normal_slope: [[f64; 3]; 3],
}

/// The rows of all contact nodes at a shape, in the order of [`ContactBoundary::points`].
#[derive(Debug, Clone, PartialEq)]
pub struct ContactRows {
    /// The rows of every node.
    pub nodes: Vec<NodeRows>,
}

/// What the rows of a shape are computed from.
#[derive(Debug, Clone)]
pub struct ContactGeometry {
    /// Faces of the lower body.
    pub(crate) faces: Vec<CellFace>,
    counter: CounterSurface,
    normal: NormalKind,
    area: AreaKind,
    interference: f64,
}

/// Length of P n from which a node counts as held along its normal.
pub(crate) const HELD: f64 = 1e-8;

/// Sensitivities of a function with respect to what the rows of one node are made of.
#[derive(Debug, Clone, Default)]
pub struct RowSensitivities {
    /// By the directions of the rows; empty for 0.
    pub directions: Vec<[f64; 3]>,
    /// By the gap.
    pub gap: f64,
}

/// The change of the rows of one node along velocities of the nodes.
#[derive(Debug, Clone)]
pub struct RowChange {
    /// Of the directions of the rows.
    pub directions: Vec<[f64; 3]>,
    /// Of the gap.
    pub gap: f64,
}

impl ContactGeometry {
    pub(crate) fn new(faces: Vec<CellFace>, counter: CounterSurface, contact: &ContactScene) -> Self {
        let &ContactScene { normal, area, interference, .. } = contact;
        Self { faces, counter, normal, area, interference }
    }

    /// Whether the rows have the same directions for all shapes.
    pub fn is_fixed(&self) -> bool {
        let plane = matches!(self.counter, CounterSurface::Plane { .. } | CounterSurface::TiltedPlane { .. });
        self.normal == NormalKind::X3 || plane
    }

    /// Whether areas are the same for all shapes whose nodes move along x₃ alone.
    pub fn areas_are_projected(&self) -> bool {
        self.area == AreaKind::Projected
    }

    /// Unit normal of the counter surface at the point nearest to a place, or straight above it; none where there is
    /// none.
    pub(crate) fn counter_normal(&self, x: [f64; 3]) -> Option<[f64; 3]> {
        let normal = match self.normal {
            NormalKind::Surface => self.counter.foot(x).ok()?.normal,
            NormalKind::X3 => {
                let slope = self.counter.foot_along_x3(x).gap_slope;
                let length = slope.iter().map(|x| x * x).sum::<f64>().sqrt();
                slope.map(|x| -x / length)
            }
        };
        normal.iter().all(|x| x.is_finite()).then_some(normal)
    }

    /// The rows at given positions of the nodes of all bodies.
    ///
    /// # Errors
    /// [`ContactError::NoFoot`] for a contact node without a unique nearest point on the counter surface.
    pub fn rows(
        &self,
        boundary: &ContactBoundary,
        bodies: &[Body],
        positions: &[&[[f64; 3]]],
    ) -> Result<ContactRows, ContactError> {
        let areas = self.areas(&bodies[0], positions[0]);
        let node = |point: &ContactPoint| {
            let x = positions[0][point.node as usize];
            let foot = match point.sides.get(1) {
                Some(partner) => paired(x, positions[partner.body][partner.node as usize]),
                None if self.normal == NormalKind::X3 => self.counter.foot_along_x3(x),
                None => self.counter.foot(x).map_err(|reason| ContactError::NoFoot {
                    node: point.node,
                    place: x,
                    reason,
                })?,
            };
            let Foot { normal, mut gap, mut gap_slope, normal_slope } = foot;
            gap -= self.interference;
            // What supports impose on all its nodes is no unknown, and no row of its own has it.
            for (i, imposed) in point.imposed.into_iter().enumerate() {
                gap -= imposed * normal[i];
                (0..3).for_each(|j| gap_slope[j] -= imposed * normal_slope[i][j]);
            }
            let directions = directions(&point.free, normal, point.row_count());
            let area = areas.get(&point.node).copied().unwrap_or(0.0);
            Ok(NodeRows { normal, directions, gap, area, gap_slope, normal_slope })
        };
        Ok(ContactRows { nodes: boundary.points.iter().map(node).collect::<Result<_, ContactError>>()? })
    }

    /// Tributary areas of the corners of the contact faces.
    fn areas(&self, body: &Body, positions: &[[f64; 3]]) -> BTreeMap<u32, f64> {
        let mut areas = BTreeMap::new();
        for &face in &self.faces {
            let nodes: Vec<u32> = body.mesh.face_nodes(face).collect();
            let x: Vec<[f64; 3]> = nodes.iter().map(|&node| positions[node as usize]).collect();
            for (node, area) in nodes.into_iter().zip(tributary_areas(&x, self.area)) {
                *areas.entry(node).or_insert(0.0) += area;
            }
        }
        areas
    }

    /// Adds sensitivities of the areas of all nodes to those of the positions of the nodes of the lower body that move.
    pub fn pull_back_areas(
        &self,
        boundary: &ContactBoundary,
        body: &Body,
        positions: &[[f64; 3]],
        sensitivities: &[f64],
        moves: impl Fn(u32) -> bool,
        result: &mut [[f64; 3]],
    ) {
        let weights: BTreeMap<u32, f64> =
            boundary.points.iter().zip(sensitivities).map(|(point, own)| (point.node, *own)).collect();
        for &face in &self.faces {
            let nodes: Vec<u32> = body.mesh.face_nodes(face).collect();
            let weight = |node: &u32| weights.get(node).copied().unwrap_or(0.0);
            let mut x: Vec<[Dual; 3]> =
                nodes.iter().map(|&node| positions[node as usize].map(Dual::constant)).collect();
            for index in (0..nodes.len()).filter(|&index| moves(nodes[index])) {
                for axis in 0..3 {
                    x[index][axis].derivative = 1.0;
                    let areas = tributary_areas(&x, self.area);
                    let sum: f64 = nodes.iter().zip(areas).map(|(node, area)| weight(node) * area.derivative).sum();
                    result[nodes[index] as usize][axis] += sum;
                    x[index][axis].derivative = 0.0;
                }
            }
        }
    }

    /// The changes of the areas of all nodes along one field of velocities of the lower body.
    pub fn area_changes(
        &self,
        boundary: &ContactBoundary,
        body: &Body,
        positions: &[[f64; 3]],
        velocities: &Velocities<'_>,
        column: usize,
    ) -> Vec<f64> {
        let mut areas: BTreeMap<u32, f64> = BTreeMap::new();
        for &face in &self.faces {
            let nodes: Vec<u32> = body.mesh.face_nodes(face).collect();
            let x: Vec<[Dual; 3]> = nodes
                .iter()
                .map(|&node| {
                    let (x, v) = (positions[node as usize], velocities.at(node, column));
                    std::array::from_fn(|axis| Dual::new(x[axis], v[axis]))
                })
                .collect();
            for (node, area) in nodes.into_iter().zip(tributary_areas(&x, self.area)) {
                *areas.entry(node).or_insert(0.0) += area.derivative;
            }
        }
        boundary.points.iter().map(|point| areas.get(&point.node).copied().unwrap_or(0.0)).collect()
    }
}

impl ContactRows {
    /// Adds sensitivities with respect to directions and gaps to those of the positions of the nodes of the lower body.
    pub fn pull_back(&self, boundary: &ContactBoundary, sensitivities: &[RowSensitivities], result: &mut [[f64; 3]]) {
        for ((point, node), own) in boundary.points.iter().zip(&self.nodes).zip(sensitivities) {
            let by_normal = node.normal_sensitivity(&point.free, &own.directions);
            for (j, result) in result[point.node as usize].iter_mut().enumerate() {
                *result += own.gap * node.gap_slope[j];
                *result += (0..3).map(|i| by_normal[i] * node.normal_slope[i][j]).sum::<f64>();
            }
        }
    }

    /// The changes of the rows of all nodes along one field of velocities of the lower body.
    pub fn changes(&self, boundary: &ContactBoundary, velocities: &Velocities<'_>, column: usize) -> Vec<RowChange> {
        let nodes = boundary.points.iter().zip(&self.nodes);
        nodes.map(|(point, node)| node.change(&point.free, velocities.at(point.node, column))).collect()
    }

    /// σ = λ_N/A per contact node, MPa, of normal forces in N.
    pub fn pressures(&self, normal: &[f64]) -> Vec<f64> {
        normal.iter().zip(&self.nodes).map(|(force, node)| force / node.area).collect()
    }

    /// Derivatives with respect to the packed rows from those with respect to the normal forces and to the tangential
    /// forces along the axes (as [`ContactForces`](crate::equilibrium::ContactForces) has them), at fixed directions.
    pub fn pack(&self, normal: &[f64], tangential: &[[f64; 3]]) -> Vec<f64> {
        let mut packed = Vec::new();
        for (index, node) in self.nodes.iter().enumerate() {
            packed.push(normal[index]);
            let along =
                |direction: &[f64; 3]| (0..3).map(|axis| direction[axis] * tangential[index][axis]).sum::<f64>();
            packed.extend(node.directions.iter().skip(1).map(along));
        }
        packed
    }

    /// Jumps less gaps of all packed rows where free directions are at rest and held ones where supports put them, mm.
    pub fn prescribed_approaches(&self, boundary: &ContactBoundary) -> Vec<f64> {
        let mut approaches = Vec::with_capacity(boundary.row_count);
        for (point, node) in boundary.points.iter().zip(&self.nodes) {
            let jump = point.prescribed_jump();
            approaches.extend(node.directions.iter().map(|direction| dot(*direction, jump)));
            approaches[point.start] -= node.gap;
        }
        approaches
    }

    /// Initial gaps, mm.
    pub fn gaps(&self) -> impl Iterator<Item = f64> + '_ {
        self.nodes.iter().map(|node| node.gap)
    }

    /// Area of the contact surface, mm².
    pub fn area(&self) -> f64 {
        self.nodes.iter().map(|node| node.area).sum()
    }

    /// Area of the closed nodes, Σ A over the nodes that stick or slip, mm²; one status per node.
    pub fn closed_area(&self, status: &[ContactStatus]) -> f64 {
        let nodes = self.nodes.iter().zip(status).filter(|(_, status)| **status != ContactStatus::Open);
        nodes.map(|(node, _)| node.area).fold(0.0, |sum, area| sum + area)
    }

    /// Tributary areas, mm².
    pub fn areas(&self) -> Vec<f64> {
        self.nodes.iter().map(|node| node.area).collect()
    }

    /// The directions of all packed rows.
    pub fn directions(&self) -> impl Iterator<Item = [f64; 3]> + '_ {
        self.nodes.iter().flat_map(|node| node.directions.iter().copied())
    }
}

impl NodeRows {
    /// c = |P n|.
    fn size(&self) -> f64 {
        length(self.directions[0])
    }

    /// The derivative by n of a function whose derivatives by the directions are given.
    fn normal_sensitivity(&self, free: &[[f64; 3]], by_directions: &[[f64; 3]]) -> [f64; 3] {
        let Some((by_normal, by_tangents)) = by_directions.split_first() else { return [0.0; 3] };
        let mut sum = onto(free, *by_normal);
        let square = dot(self.directions[0], self.directions[0]);
        for (tangent, own) in self.directions[1..].iter().zip(by_tangents) {
            let share = dot(self.directions[0], *own) / square;
            (0..3).for_each(|axis| sum[axis] -= share * tangent[axis]);
        }
        sum
    }

    /// The change of the rows while the node moves.
    fn change(&self, free: &[[f64; 3]], velocity: [f64; 3]) -> RowChange {
        let turned: [f64; 3] = std::array::from_fn(|i| dot(self.normal_slope[i], velocity));
        let square = dot(self.directions[0], self.directions[0]);
        let tangent = |tangent: &[f64; 3]| self.directions[0].map(|d| -dot(*tangent, turned) / square * d);
        let tangents = self.directions[1..].iter().map(tangent);
        let directions = std::iter::once(onto(free, turned)).chain(tangents).collect();
        RowChange { directions, gap: dot(self.gap_slope, velocity) }
    }

    /// P n and all tangential directions that are free, whether they have rows or not.
    pub(crate) fn all_directions(&self, free: &[[f64; 3]]) -> Vec<[f64; 3]> {
        directions(free, self.normal, free.len())
    }

    /// Whether supports hold the node along its normal.
    pub(crate) fn is_held(&self) -> bool {
        self.size() < HELD
    }
}

/// Normal and gap of two nodes that meet along x₃.
fn paired(lower: [f64; 3], upper: [f64; 3]) -> Foot {
    let normal = [0.0, 0.0, 1.0];
    Foot { normal, gap: upper[2] - lower[2], gap_slope: [0.0, 0.0, -1.0], normal_slope: [[0.0; 3]; 3] }
}

/// P n and tangential directions, as many as the node has rows.
fn directions(free: &[[f64; 3]], normal: [f64; 3], count: usize) -> Vec<[f64; 3]> {
    let projected = onto(free, normal);
    let c = length(projected);
    let mut directions = vec![projected];
    if count == 1 {
        return directions;
    }
    let m = projected.map(|x| x / c);
    // The free direction farthest from the normal gives the first tangent.
    let along = |direction: &[f64; 3]| dot(*direction, m).abs();
    let first = free.iter().copied().reduce(|best, other| if along(&other) < along(&best) { other } else { best });
    let first = first.unwrap_or_default();
    let share = dot(first, m);
    let across: [f64; 3] = std::array::from_fn(|axis| first[axis] - share * m[axis]);
    let size = length(across);
    let tangent = across.map(|x| x / size);
    directions.push(tangent);
    if count == 3 {
        directions.push(std::array::from_fn(|i| {
            m[(i + 1) % 3] * tangent[(i + 2) % 3] - m[(i + 2) % 3] * tangent[(i + 1) % 3]
        }));
    }
    directions
}

/// The part of a vector along orthonormal directions; the vector itself if there are three.
fn onto(free: &[[f64; 3]], vector: [f64; 3]) -> [f64; 3] {
    if free.len() == 3 {
        return vector;
    }
    let mut sum = [0.0; 3];
    for direction in free {
        let share = dot(*direction, vector);
        (0..3).for_each(|axis| sum[axis] += share * direction[axis]);
    }
    sum
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    (0..3).map(|axis| a[axis] * b[axis]).sum()
}

fn length(a: [f64; 3]) -> f64 {
    dot(a, a).sqrt()
}
