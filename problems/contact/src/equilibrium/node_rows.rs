//! The geometry of the rows of one contact node at a shape, and its derivatives.
//!
//! ```text
//! P: onto the free directions,  c = |P n|,  m = P n/c:    d₀ = P n,   t_k: orthonormal in the range of P across m
//! jump of row r = Σ_sides w d_r·u,  w = 1 for the node, −m_j for master nodes;   force on what lies opposite = Σ λ_r d_r
//! gap = (distance of the shapes) − (interference) − n·(I − P) v,    v: jump that supports prescribe
//! d₀′ = P n′,   t_k′ = −(t_k·n′)/c m,   w′,   gap′,   A′
//! ```
//! A rotation of the tangential rows in their plane changes no force, so that its derivative is taken as zero.

use crate::body::onto;
use crate::equilibrium::ContactPoint;
use crate::scene::Foot;

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

    /// The derivative by the place of a node that an obstacle lies opposite to.
    pub(crate) fn obstacle_sensitivity(&self, free: &[[f64; 3]], own: &RowSensitivities) -> Option<[f64; 3]> {
        let slopes = self.slopes.as_ref()?;
        let by_normal = self.normal_sensitivity(free, &own.directions);
        let through_normal = |j: usize| (0..3).map(|i| by_normal[i] * slopes.normal[i][j]).sum::<f64>();
        Some(std::array::from_fn(|j| own.gap * slopes.gap[j] + through_normal(j)))
    }

    /// The change of the rows while the node moves along an obstacle.
    pub(crate) fn on_obstacle(&self, free: &[[f64; 3]], velocity: [f64; 3]) -> RowChange {
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

pub(crate) fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    (0..3).map(|axis| a[axis] * b[axis]).sum()
}

fn length(a: [f64; 3]) -> f64 {
    dot(a, a).sqrt()
}
