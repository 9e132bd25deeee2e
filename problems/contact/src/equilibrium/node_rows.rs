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
use crate::equilibrium::contact_point::ContactPoint;
use crate::equilibrium::numbers::{Numbers, Placed};

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
}

/// Length of P n from which a node counts as held along its normal.
pub(crate) const HELD: f64 = 1e-8;

/// Sensitivities of a function with respect to what the rows of one node are made of.
#[derive(Debug, Clone, Default)]
pub struct RowSensitivities {
    /// By the directions of the rows; empty for 0.
    pub directions: Vec<[f64; 3]>,
    /// By the whole normal, where a function has more of it than the directions.
    pub normal: [f64; 3],
    /// By the gap.
    pub gap: f64,
    /// By the area.
    pub area: f64,
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
    /// Of the area.
    pub area: f64,
    /// Of the weights of the sides; empty for 0.
    pub weights: Vec<f64>,
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

    /// The change of the directions with that of the normal.
    fn turned(&self, free: &[[f64; 3]], normal: [f64; 3]) -> Vec<[f64; 3]> {
        let square = dot(self.directions[0], self.directions[0]);
        let tangent = |tangent: &[f64; 3]| self.directions[0].map(|d| -dot(*tangent, normal) / square * d);
        let tangents = self.directions[1..].iter().map(tangent);
        std::iter::once(onto(free, normal)).chain(tangents).collect()
    }

    /// The rows of a node from its numbers. What supports impose on its sides is no unknown, and no row of its own has
    /// it: it is part of the gap, less the interference of the contact.
    pub(crate) fn new(point: &ContactPoint, placed: Placed, interference: f64) -> Self {
        let Placed { numbers: Numbers { normal, gap, area, weights }, is_covered } = placed;
        let gap = match (point.is_tied, is_covered) {
            (true, _) => 0.0,
            (false, true) => gap - interference - dot(normal, point.imposed(&weights)),
            (false, false) => gap,
        };
        let directions = directions(&point.free, normal, point.row_count());
        Self { normal, directions, weights, gap, area, is_covered }
    }

    /// The change of the rows with that of the numbers; nothing changes where nothing lies opposite.
    pub(crate) fn change(&self, point: &ContactPoint, numbers: Numbers) -> RowChange {
        if !self.is_covered {
            return RowChange { directions: vec![[0.0; 3]; self.directions.len()], ..RowChange::default() };
        }
        let Numbers { normal, gap, area, weights } = numbers;
        let gap = if point.is_tied {
            0.0
        } else {
            let by_weights = weights.iter().zip(self.gap_slopes(point)).map(|(weight, slope)| weight * slope);
            gap - dot(normal, point.imposed(&self.weights)) + by_weights.sum::<f64>()
        };
        RowChange { directions: self.turned(&point.free, normal), gap, area, weights }
    }

    /// The sensitivities by the numbers from those by the rows.
    pub(crate) fn pull_back(&self, point: &ContactPoint, own: &RowSensitivities) -> Numbers {
        if !self.is_covered {
            return Numbers::default();
        }
        let gap = if point.is_tied { 0.0 } else { own.gap };
        let (by_directions, imposed) =
            (self.normal_sensitivity(&point.free, &own.directions), point.imposed(&self.weights));
        let normal = std::array::from_fn(|axis| by_directions[axis] + own.normal[axis] - gap * imposed[axis]);
        let mut weights = own.weights.clone();
        weights.resize(point.sides.len(), 0.0);
        weights.iter_mut().zip(self.gap_slopes(point)).for_each(|(sum, slope)| *sum += gap * slope);
        Numbers { normal, gap, area: own.area, weights }
    }

    /// The derivatives of the gap by the weights of all sides through what supports impose on them.
    fn gap_slopes<'a>(&self, point: &'a ContactPoint) -> impl Iterator<Item = f64> + use<'a> {
        // n − P n: what of the normal no row has.
        let rest: [f64; 3] = std::array::from_fn(|axis| self.normal[axis] - self.directions[0][axis]);
        point.sides.iter().map(move |side| -dot(rest, side.prescribed))
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
