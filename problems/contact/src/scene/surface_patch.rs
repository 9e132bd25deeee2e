//! A curved facet of a mesh surface: projection along its normals, and the nearest points of its rims.

use crate::mortar::vector::{cross, dot, length, plus};
use crate::mortar::{NODES, Quadratic};
use crate::scene::foot::Foot;
use crate::scene::nearest_place::nearest_place;
use crate::scene::side::Side;
use rstar::AABB;

/// Steps of Newton's method for a projection.
const STEPS: usize = 40;
/// Change of the coordinates, and of the distance in units of the facet, that ends them.
const STILL: f64 = 1e-14;
/// How far a projection may lie beyond an edge, in coordinates of the facet: rounding.
const BEYOND: f64 = 1e-9;
/// Coordinates from which a projection has left the facet.
const LOST: f64 = 8.0;

/// What lies beyond an edge of a facet.
#[derive(Debug, Clone, Copy)]
pub(super) enum Rim {
    /// The smooth part goes on.
    Inner,
    /// Nothing.
    Open,
    /// Another smooth part; the mean normal of both.
    Sharp([f64; 3]),
}

/// A facet of second degree with the unit normals of its corners.
#[derive(Debug)]
pub(super) struct SurfacePatch {
    /// Corners: three or four.
    pub count: usize,
    /// Corners, then middles.
    pub places: [[f64; 3]; NODES],
    pub normals: [[f64; 3]; 4],
    /// By edge, the first between the first two corners.
    pub rims: [Rim; 4],
}

/// A point of a patch with its distance along the normal there.
#[derive(Debug)]
pub(super) struct Projection {
    distance: f64,
    normal: [f64; 3],
    /// ∂distance/∂x.
    slope: [f64; 3],
    /// ∂normal_i/∂x_j.
    normal_slope: [[f64; 3]; 3],
}

impl Projection {
    /// The foot of the point.
    pub fn foot(&self, side: Side) -> Foot {
        let foot = Foot::of_distance(self.distance, self.normal, self.normal_slope, side);
        let sign = if side == Side::Outside { 1.0 } else { -1.0 };
        Foot { gap_slope: self.slope.map(|part| sign * part), ..foot }
    }
}

/// A patch and its normals at a place: values and slopes along both coordinates.
struct At {
    place: [f64; 3],
    tangents: [[f64; 3]; 2],
    normal: [f64; 3],
    turns: [[f64; 3]; 2],
}

impl SurfacePatch {
    /// A box around the patch: that of its corners, wider by the distances of its middles from their chords.
    pub fn bounds(&self) -> AABB<[f64; 3]> {
        let arm = |k: usize| {
            let [a, m, b] = self.edge(k);
            length(std::array::from_fn(|axis| m[axis] - 0.5 * (a[axis] + b[axis])))
        };
        let wider: f64 = (0..self.count).map(arm).sum();
        let corners = &self.places[..self.count];
        let extreme =
            |axis: usize, pick: fn(f64, f64) -> f64| corners.iter().map(|x| x[axis]).reduce(pick).unwrap_or_default();
        let low = std::array::from_fn(|axis| extreme(axis, f64::min) - wider);
        let high = std::array::from_fn(|axis| extreme(axis, f64::max) + wider);
        AABB::from_corners(low, high)
    }

    /// Start, middle and end of an edge.
    fn edge(&self, k: usize) -> [[f64; 3]; 3] {
        [self.places[k], self.places[4 + k], self.places[(k + 1) % self.count]]
    }

    /// Shape functions of the corners with their slopes.
    fn linear(&self, [xi, eta]: [f64; 2]) -> ([f64; 4], [[f64; 2]; 4]) {
        if self.count == 3 {
            return ([1.0 - xi - eta, xi, eta, 0.0], [[-1.0, -1.0], [1.0, 0.0], [0.0, 1.0], [0.0, 0.0]]);
        }
        let corners = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];
        let value = |[s, t]: [f64; 2]| 0.25 * (1.0 + s * xi) * (1.0 + t * eta);
        let slope = |[s, t]: [f64; 2]| [0.25 * s * (1.0 + t * eta), 0.25 * t * (1.0 + s * xi)];
        (corners.map(value), corners.map(slope))
    }

    fn at(&self, xi: [f64; 2]) -> At {
        let (values, slopes) = self.linear(xi);
        let quadratic = Quadratic::new(self.count, values);
        let sum = |weights: [f64; 4]| -> [f64; 3] {
            std::array::from_fn(|axis| (0..4).map(|k| weights[k] * self.normals[k][axis]).sum())
        };
        let raw = sum(values);
        let size = length(raw);
        let normal = raw.map(|part| part / size);
        let turns = [0, 1].map(|along| {
            let change = sum(slopes.map(|slope| slope[along]));
            plus(change, -dot(change, normal), normal).map(|part| part / size)
        });
        At { place: quadratic.place(&self.places), tangents: quadratic.tangents(&self.places), normal, turns }
    }

    /// The projection of a point along the normals of the patch; none beside the patch.
    pub fn project(&self, x: [f64; 3]) -> Option<Projection> {
        let size = length(plus(self.places[1], -1.0, self.places[0]));
        let mut xi = if self.count == 3 { [1.0 / 3.0; 2] } else { [0.0; 2] };
        let start = self.at(xi);
        let mut distance = dot(plus(x, -1.0, start.place), start.normal);
        for _step in 0..STEPS {
            let here = self.at(xi);
            let rest: [f64; 3] = std::array::from_fn(|axis| x[axis] - here.place[axis] - distance * here.normal[axis]);
            let inverse = inverse(columns(&here, distance))?;
            let step = inverse.map(|row| dot(row, rest));
            xi = [xi[0] + step[0], xi[1] + step[1]];
            distance += step[2];
            if xi.iter().any(|part| part.is_nan() || part.abs() > LOST) {
                return None;
            }
            let scale = size + distance.abs();
            if step[0].abs().max(step[1].abs()) <= STILL * LOST && step[2].abs() <= STILL * LOST * scale {
                return self.is_inside(xi).then(|| self.projection(xi, distance))?;
            }
        }
        None
    }

    fn is_inside(&self, [xi, eta]: [f64; 2]) -> bool {
        match self.count {
            3 => xi >= -BEYOND && eta >= -BEYOND && xi + eta <= 1.0 + BEYOND,
            _ => xi.abs().max(eta.abs()) <= 1.0 + BEYOND,
        }
    }

    fn projection(&self, xi: [f64; 2], distance: f64) -> Option<Projection> {
        let here = self.at(xi);
        let [first, second, slope] = inverse(columns(&here, distance))?;
        let [along_first, along_second] = here.turns;
        let turn = |i: usize, j: usize| along_first[i] * first[j] + along_second[i] * second[j];
        let normal_slope = std::array::from_fn(|i| std::array::from_fn(|j| turn(i, j)));
        Some(Projection { distance, normal: here.normal, slope, normal_slope })
    }

    /// The feet of a point on the edges that end a smooth part.
    pub fn rim_feet(&self, x: [f64; 3], side: Side) -> impl Iterator<Item = Foot> + '_ {
        (0..self.count).filter_map(move |k| match self.rims[k] {
            Rim::Inner => None,
            Rim::Open => Some(self.edge_foot(k, None, x, side)),
            Rim::Sharp(mean) => Some(self.edge_foot(k, Some(mean), x, side)),
        })
    }

    /// The foot on an edge; `mean`: the mean normal of the parts that meet there. Beside an open rim there is nothing
    /// to lie inside of.
    fn edge_foot(&self, k: usize, mean: Option<[f64; 3]>, x: [f64; 3], side: Side) -> Foot {
        let edge = Edge(self.edge(k));
        let t = edge.nearest(x);
        let away = plus(x, -1.0, edge.at(t));
        let distance = length(away);
        if distance == 0.0 {
            return Foot::of_distance(0.0, mean.unwrap_or(self.normals[k]), [[0.0; 3]; 3], side);
        }
        // The distance from a rim is one from outside on both sides of the surface.
        let outside = if mean.is_none() { Side::Outside } else { side };
        let sign = if mean.is_some_and(|mean| dot(mean, away) < 0.0) { -1.0 } else { 1.0 };
        let way = away.map(|part| part / distance);
        let (along, bend) = edge.tangent(t, away);
        let is_within = t > 0.0 && t < 1.0;
        let second = |i: usize, j: usize| {
            let flat = f64::from(u8::from(i == j)) - way[i] * way[j];
            let own = if is_within { along[i] * along[j] / (1.0 - bend) } else { 0.0 };
            sign * (flat - own) / distance
        };
        let second = std::array::from_fn(|i| std::array::from_fn(|j| second(i, j)));
        Foot::of_distance(sign * distance, way.map(|part| sign * part), second, outside)
    }
}

/// A curve of second degree through start, middle and end.
struct Edge([[f64; 3]; 3]);

impl Edge {
    fn sum(&self, weights: [f64; 3]) -> [f64; 3] {
        std::array::from_fn(|axis| (0..3).map(|k| weights[k] * self.0[k][axis]).sum())
    }

    fn at(&self, t: f64) -> [f64; 3] {
        self.sum([(1.0 - t) * (1.0 - 2.0 * t), 4.0 * t * (1.0 - t), t * (2.0 * t - 1.0)])
    }

    fn first(&self, t: f64) -> [f64; 3] {
        self.sum([4.0 * t - 3.0, 4.0 - 8.0 * t, 4.0 * t - 1.0])
    }

    /// The unit tangent, and (x − q)·q″ with the second derivative by the length.
    fn tangent(&self, t: f64, away: [f64; 3]) -> ([f64; 3], f64) {
        let first = self.first(t);
        let size = length(first);
        let tangent = first.map(|part| part / size);
        let second = self.sum([4.0, -8.0, 4.0]);
        let across = plus(second, -dot(second, tangent), tangent);
        (tangent, dot(away, across) / (size * size))
    }

    /// The place of the point nearest to x.
    fn nearest(&self, x: [f64; 3]) -> f64 {
        let from = |t: f64| plus(self.at(t), -1.0, x);
        nearest_place(|t| dot(from(t), from(t)), |t| dot(from(t), self.first(t)))
    }
}

/// Y_ξ + g m_ξ, Y_η + g m_η, m.
fn columns(at: &At, distance: f64) -> [[f64; 3]; 3] {
    let along = |k: usize| plus(at.tangents[k], distance, at.turns[k]);
    [along(0), along(1), at.normal]
}

/// The rows of the inverse of a matrix given by its columns.
fn inverse([a, b, c]: [[f64; 3]; 3]) -> Option<[[f64; 3]; 3]> {
    let rows = [cross(b, c), cross(c, a), cross(a, b)];
    let determinant = dot(a, rows[0]);
    (determinant != 0.0 && determinant.is_finite()).then(|| rows.map(|row| row.map(|part| part / determinant)))
}
