//! The geometry of the contact rows at one shape, and its derivatives.
//!
//! ```text
//! P: onto the free directions,  c = |P n|,  m = P n/c:    d₀ = P n,   t_k: orthonormal in the range of P across m
//! jump of row r = Σ_sides w d_r·u,  w = 1 for the node, −m_j for master nodes;   force on what lies opposite = Σ λ_r d_r
//! gap = (distance of the shapes) − (interference) − n·(I − P) v,    v: jump that supports prescribe
//! d₀′ = P n′,   t_k′ = −(t_k·n′)/c m,   w′,   gap′,   A′
//! ```
//! A rotation of the tangential rows in their plane changes no force, so that its derivative is taken as zero.

use crate::equilibrium::pair_rows::PairRows;
use crate::equilibrium::{ContactBoundary, ContactPoint, ContactStatus};
use crate::scene::Foot;
use crate::shape::Velocities;

/// The rows of one contact node at a shape.
#[derive(Debug, Clone, PartialEq)]
pub struct NodeRows {
    /// Unit normal n from the slave body outwards.
    pub normal: [f64; 3],
    /// Directions of its rows: P n, then the tangential ones; as many as the node has rows.
    pub directions: Vec<[f64; 3]>,
    /// Weights of its [sides](ContactPoint::sides): 1 for the node itself, minus the mortar weights of the master
    /// nodes.
    pub weights: Vec<f64>,
    /// Gap before loading less the interference, mm; negative where the shapes overlap, 0 where faces are glued. Where
    /// supports hold all its nodes in a direction, it is the gap of the place where they put the node along that
    /// direction.
    pub gap: f64,
    /// Tributary area A, mm²; of the mortar integrals between bodies.
    pub area: f64,
    /// Whether anything lies opposite to it; a node without carries no force.
    pub is_covered: bool,
    /// How gap and normal change with the place of the node, where an obstacle lies opposite to it.
    slopes: Option<ObstacleSlopes>,
}

/// Slopes of gap and normal by the place of a contact node.
#[derive(Debug, Clone, Copy, PartialEq)]
struct ObstacleSlopes {
    gap: [f64; 3],
    normal: [[f64; 3]; 3],
}

/// The rows of all contact nodes at a shape, in the order of [`ContactBoundary::points`].
#[derive(Debug, Clone)]
pub struct ContactRows {
    /// The rows of every node.
    pub nodes: Vec<NodeRows>,
    /// What the rows of every contact between bodies are computed from; none for obstacles.
    pub(crate) pairs: Vec<Option<PairRows>>,
    /// Number of nodes that may open, which come first.
    pub(crate) contact_count: usize,
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
    /// By the weights of the sides; empty for 0.
    pub weights: Vec<f64>,
}

/// The change of the rows of one node along velocities of the nodes.
#[derive(Debug, Clone, Default)]
pub struct RowChange {
    /// Of the directions of the rows.
    pub directions: Vec<[f64; 3]>,
    /// Of the gap.
    pub gap: f64,
    /// Of the weights of the sides; empty for 0.
    pub weights: Vec<f64>,
}

impl ContactRows {
    /// Adds sensitivities with respect to directions, weights and gaps to those of the positions of nodes:
    /// `add(body, node, sensitivity)`. `moves`: whether a node of a body moves with the shape.
    pub fn pull_back(
        &self,
        boundary: &ContactBoundary,
        sensitivities: &[RowSensitivities],
        moves: impl Fn(usize, u32) -> bool + Sync,
        mut add: impl FnMut(usize, u32, [f64; 3]),
    ) {
        for ((point, node), own) in boundary.points.iter().zip(&self.nodes).zip(sensitivities) {
            let Some(slopes) = &node.slopes else { continue };
            let by_normal = node.normal_sensitivity(&point.free, &own.directions);
            let through_normal = |j: usize| (0..3).map(|i| by_normal[i] * slopes.normal[i][j]).sum::<f64>();
            add(point.body, point.node, std::array::from_fn(|j| own.gap * slopes.gap[j] + through_normal(j)));
        }
        for (contact, pair) in self.pairs.iter().enumerate() {
            if let Some(pair) = pair {
                let range = boundary.of_contact(contact);
                let points = (&boundary.points[range.clone()], &self.nodes[range.clone()]);
                pair.pull_back(points, &sensitivities[range], &moves, &mut add);
            }
        }
    }

    /// The changes of the rows of all nodes along one field of velocities.
    pub fn changes(&self, boundary: &ContactBoundary, velocities: &Velocities<'_>, column: usize) -> Vec<RowChange> {
        let mut changes = Vec::with_capacity(self.nodes.len());
        for contact in boundary.contacts() {
            let (pair, range) = (&self.pairs[contact], boundary.of_contact(contact));
            let (points, nodes) = (&boundary.points[range.clone()], &self.nodes[range]);
            match pair {
                Some(pair) => changes.extend(pair.changes((points, nodes), velocities, column)),
                None => {
                    changes.extend(points.iter().zip(nodes).map(|(point, node)| {
                        node.on_obstacle(&point.free, velocities.at(point.body, point.node, column))
                    }))
                }
            }
        }
        changes
    }

    /// σ = λ_N/A per contact node that may open, MPa, of normal forces in N.
    pub fn pressures(&self, normal: &[f64]) -> Vec<f64> {
        normal.iter().zip(&self.nodes).map(|(force, node)| force / node.area).collect()
    }

    /// Derivatives with respect to the packed rows from those with respect to the normal forces and to the tangential
    /// forces along the axes (as [`ContactForces`](crate::equilibrium::ContactForces) has them), at fixed directions; 0 by
    /// the forces of glued nodes.
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
    pub fn prescribed_approaches(&self, boundary: &ContactBoundary) -> Vec<f64> {
        let mut approaches = Vec::with_capacity(boundary.row_count);
        for (point, node) in boundary.points.iter().zip(&self.nodes) {
            let jump = point.prescribed_jump(&node.weights);
            approaches.extend(node.directions.iter().map(|direction| dot(*direction, jump)));
            approaches[point.start] -= node.gap;
        }
        approaches
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

impl NodeRows {
    /// c = |P n|.
    fn size(&self) -> f64 {
        length(self.directions[0])
    }

    /// The derivative by n of a function whose derivatives by the directions are given.
    pub(crate) fn normal_sensitivity(&self, free: &[[f64; 3]], by_directions: &[[f64; 3]]) -> [f64; 3] {
        let Some((by_normal, by_tangents)) = by_directions.split_first() else { return [0.0; 3] };
        let mut sum = onto(free, *by_normal);
        let square = dot(self.directions[0], self.directions[0]);
        for (tangent, own) in self.directions[1..].iter().zip(by_tangents) {
            let share = dot(self.directions[0], *own) / square;
            (0..3).for_each(|axis| sum[axis] -= share * tangent[axis]);
        }
        sum
    }

    /// The change of the directions with that of the normal.
    pub(crate) fn turned(&self, free: &[[f64; 3]], normal: [f64; 3]) -> Vec<[f64; 3]> {
        let square = dot(self.directions[0], self.directions[0]);
        let tangent = |tangent: &[f64; 3]| self.directions[0].map(|d| -dot(*tangent, normal) / square * d);
        let tangents = self.directions[1..].iter().map(tangent);
        std::iter::once(onto(free, normal)).chain(tangents).collect()
    }

    /// The change of the rows while the node moves along an obstacle.
    fn on_obstacle(&self, free: &[[f64; 3]], velocity: [f64; 3]) -> RowChange {
        let Some(slopes) = &self.slopes else { return RowChange::default() };
        let normal: [f64; 3] = std::array::from_fn(|i| dot(slopes.normal[i], velocity));
        RowChange { directions: self.turned(free, normal), gap: dot(slopes.gap, velocity), weights: Vec::new() }
    }

    /// The rows of a node whose nearest point on an obstacle is known.
    pub(crate) fn of_obstacle(point: &ContactPoint, foot: Foot, interference: f64, area: f64) -> Self {
        let Foot { normal, mut gap, mut gap_slope, normal_slope } = foot;
        gap -= interference;
        let weights = vec![1.0];
        // What supports impose on the node is no unknown, and no row of its own has it.
        for (i, imposed) in point.imposed(&weights).into_iter().enumerate() {
            gap -= imposed * normal[i];
            (0..3).for_each(|j| gap_slope[j] -= imposed * normal_slope[i][j]);
        }
        let directions = directions(&point.free, normal, point.row_count());
        let slopes = Some(ObstacleSlopes { gap: gap_slope, normal: normal_slope });
        Self { normal, directions, weights, gap, area, is_covered: true, slopes }
    }

    /// The rows of a node that nothing lies opposite to.
    pub(crate) fn away(point: &ContactPoint, normal: [f64; 3], weights: Vec<f64>, gap: f64, area: f64) -> Self {
        Self { is_covered: false, ..Self::of_pair(point, normal, weights, gap, area) }
    }

    /// The rows of a node with given weights of its sides.
    pub(crate) fn of_pair(point: &ContactPoint, normal: [f64; 3], weights: Vec<f64>, gap: f64, area: f64) -> Self {
        let directions = directions(&point.free, normal, point.row_count());
        Self { normal, directions, weights, gap, area, is_covered: true, slopes: None }
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

pub(crate) fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    (0..3).map(|axis| a[axis] * b[axis]).sum()
}

fn length(a: [f64; 3]) -> f64 {
    dot(a, a).sqrt()
}
