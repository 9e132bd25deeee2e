//! Integrals over the common part of a slave facet and a master facet, in the auxiliary plane.
//!
//! ```text
//! M_kl = ∫ N_k N_l,   P_kj = ∫ N_k Nᵐ_j,   D_k = ∫ N_k = Σ_l M_kl
//! of facets of second degree also:  ∫ N_k ν·(Y_m − Y_s),   ∫ N_k ν       ν: unit normal of the slave facet Y_s
//! fan of triangles about the centroid of the area, sixteen points of degree 8 in each
//! ```

use super::curve::{Curve, NODES, Quadratic};
use super::gradient::Gradient;
use super::planar::{Element, Planar};
use super::polygon::{Polygon, cross, minus, scaled};
use super::vector::{cross as cross3, dot as dot3};
use crate::scalar::Scalar;

/// A common part smaller than this part of the slave facet is left out.
const TINY: f64 = 1e-14;

/// What lies this near to an edge of the slave facet (part of its area) counts as lying on it.
const ON_EDGE: f64 = 1e-11;

/// Coordinates of the projected corners: slave, then master.
pub const INPUTS: usize = 16;

/// Columns of P, and after them those of facets of second degree: gap and the three components of the normal.
pub const COLUMNS: usize = 8;

/// The column of ∫ N_k ν·(Y_m − Y_s).
pub const GAP: usize = 4;

/// The first column of ∫ N_k ν.
pub const NORMAL: usize = 5;

/// A matrix with a row per corner of the slave facet.
pub type Wide<T> = [[T; COLUMNS]; 4];

/// k and l of the numbers of M.
pub const SYMMETRIC: [[usize; 2]; 10] =
    [[0, 0], [0, 1], [0, 2], [0, 3], [1, 1], [1, 2], [1, 3], [2, 2], [2, 3], [3, 3]];

/// The integrals M (upper triangle) and P of a pair.
#[derive(Debug, Clone, Copy)]
pub struct Raw<T> {
    pub own: [T; 10],
    /// P, then gap and normal; zero for flat facets.
    pub mixed: Wide<T>,
}

/// Derivatives of the numbers of [`Raw`].
#[derive(Debug)]
pub struct Jacobian {
    /// By the projected corners: M, then row by row the columns that there are.
    planar: Vec<[f64; INPUTS]>,
    /// By the nodes of facets of second degree at fixed integration points; none for flat facets.
    spatial: Option<Box<Spatial>>,
}

/// Derivatives of gap and normal by the nodes of the slave facet and of the master facet.
#[derive(Debug)]
struct Spatial {
    gap: [[[[f64; 3]; NODES]; 2]; 4],
    /// By the nodes of the slave facet: rows are components of the normal.
    normal: [[[[f64; 3]; 3]; NODES]; 4],
}

/// Barycentric coordinates and weights of the rule of degree 8 \[Dunavant1985\]: centre, then two kinds of orbits.
fn rule() -> impl Iterator<Item = ([f64; 3], f64)> {
    const THREE: [(f64, f64); 3] = [
        (0.459_292_588_292_723_2, 0.095_091_634_267_284_62),
        (0.170_569_307_751_760_2, 0.103_217_370_534_718_25),
        (0.050_547_228_317_030_98, 0.032_458_497_623_198_08),
    ];
    const SIX: ([f64; 2], f64) = ([0.263_112_829_634_638_1, 0.008_394_777_409_957_605], 0.027_230_314_174_434_994);
    let third = 1.0 / 3.0;
    let centre = ([third; 3], 0.144_315_607_677_787_17);
    let three = THREE.into_iter().flat_map(|(s, w)| {
        let rest = 1.0 - 2.0 * s;
        [[rest, s, s], [s, rest, s], [s, s, rest]].map(|point| (point, w))
    });
    let ([a, b], w) = SIX;
    let c = 1.0 - a - b;
    let six = [[a, b, c], [a, c, b], [b, a, c], [b, c, a], [c, a, b], [c, b, a]].map(|point| (point, w));
    std::iter::once(centre).chain(three).chain(six)
}

/// Area below which a common part of a slave facet of this area is left out, and the tolerance of clipping.
fn tolerances(slave_area: f64) -> [f64; 2] {
    [TINY * slave_area, ON_EDGE * slave_area]
}

/// Visit the common parts of the convex pieces of both facets.
pub fn visit<T: Scalar>(
    slave: &Planar<T>,
    master: &Planar<T>,
    mut part: impl FnMut(&Polygon<T>, &Element<'_, T>, &Element<'_, T>),
) {
    let (own, other) = (slave.plain(), master.plain());
    let area: f64 = own.pieces().map(|piece| piece.polygon(&own).area()).sum();
    let [tiny, tolerance] = tolerances(area);
    for own_piece in own.pieces() {
        let own_element = Element { facet: slave, plain: &own, piece: own_piece };
        let frame = own_piece.polygon(slave);
        for other_piece in other.pieces() {
            let other_element = Element { facet: master, plain: &other, piece: other_piece };
            let common = other_piece.polygon(master).clipped(&frame, tolerance);
            if common.vertices().len() >= 3 && common.area().value() > tiny {
                part(&common, &own_element, &other_element);
            }
        }
    }
}

impl<T: Scalar> Raw<T> {
    pub fn zero() -> Self {
        Self { own: [T::constant(0.0); 10], mixed: [[T::constant(0.0); COLUMNS]; 4] }
    }

    /// Integrate over the common part of two projected facets.
    pub fn new(slave: &Planar<T>, master: &Planar<T>, curves: Option<[&Curve; 2]>) -> Self {
        let mut sums = Self::zero();
        visit(slave, master, |common, own, other| {
            points(common, |weight, point| sums.add_point(weight, own.shape(point), other.shape(point), curves));
        });
        sums
    }

    fn add_point(&mut self, weight: T, own: [T; 4], other: [T; 4], curves: Option<[&Curve; 2]>) {
        let weighted = own.map(|value| value * weight);
        for (sum, [k, l]) in self.own.iter_mut().zip(SYMMETRIC) {
            *sum += weighted[k] * own[l];
        }
        for (row, &value) in self.mixed.iter_mut().zip(&weighted) {
            row.iter_mut().zip(&other).for_each(|(sum, &factor)| *sum += value * factor);
        }
        let Some([slave, master]) = curves else { return };
        let own = Quadratic::new(slave.count, own);
        let other = Quadratic::new(master.count, other);
        let [a, b] = own.tangents(&slave.nodes);
        let area = cross3(a, b);
        let size = dot3(area, area).sqrt();
        let normal = area.map(|component| component / size);
        let (from, to) = (own.point(slave), other.point(master));
        let gap = dot3(normal, std::array::from_fn(|axis| to[axis] - from[axis]));
        for (row, &value) in self.mixed.iter_mut().zip(&weighted) {
            row[GAP] += value * gap;
            (0..3).for_each(|axis| row[NORMAL + axis] += value * normal[axis]);
        }
    }

    /// M in full.
    pub fn matrix(&self) -> [[T; 4]; 4] {
        let mut full = [[T::constant(0.0); 4]; 4];
        for (&value, [k, l]) in self.own.iter().zip(SYMMETRIC) {
            full[k][l] = value;
            full[l][k] = value;
        }
        full
    }
}

/// Row sums of M: ∫ N_k.
pub fn row_sums(matrix: &[[f64; 4]; 4]) -> [f64; 4] {
    matrix.map(|row| row.iter().sum())
}

/// Visit weights and points of the rule over a polygon.
fn points<T: Scalar>(common: &Polygon<T>, mut visit: impl FnMut(T, [T; 2])) {
    let centre = common.centroid();
    for [from, to] in common.edges() {
        let area = scaled(cross(minus(from, centre), minus(to, centre)), 0.5);
        for (barycentric, weight) in rule() {
            let at = |axis: usize| {
                let sum = scaled(centre[axis], barycentric[0]) + scaled(from[axis], barycentric[1]);
                sum + scaled(to[axis], barycentric[2])
            };
            visit(scaled(area, weight), [at(0), at(1)]);
        }
    }
}

/// Differentiate the integrals of a pair.
pub fn jacobian(slave: &Planar<f64>, master: &Planar<f64>, curves: Option<[&Curve; 2]>) -> Jacobian {
    let lifted = |facet: &Planar<f64>, first: usize| Planar {
        corners: std::array::from_fn(|corner| {
            std::array::from_fn(|axis| {
                Gradient::<INPUTS>::variable(facet.corners[corner][axis], first + 2 * corner + axis)
            })
        }),
        count: facet.count,
    };
    let raw = Raw::new(&lifted(slave, 0), &lifted(master, 8), curves);
    let columns = if curves.is_some() { COLUMNS } else { 4 };
    let mixed = raw.mixed.iter().flat_map(|row| &row[..columns]);
    let planar = raw.own.iter().chain(mixed).map(|number| number.slopes).collect();
    let spatial = curves.map(|curves| Box::new(Spatial::new(slave, master, curves)));
    Jacobian { planar, spatial }
}

/// Velocities of, or sensitivities to, the nodes of the slave facet and of the master facet.
pub type OfNodes = [[[f64; 3]; NODES]; 2];

impl Jacobian {
    /// Columns of P, gap and normal that there are.
    fn columns(&self) -> usize {
        (self.planar.len() - SYMMETRIC.len()) / 4
    }

    /// Apply it to velocities of the projected corners and of all nodes.
    pub fn forward(&self, velocities: &[f64; INPUTS], nodes: &OfNodes) -> Raw<f64> {
        let planar = &self.planar;
        let change = |row: usize| planar[row].iter().zip(velocities).map(|(slope, velocity)| slope * velocity).sum();
        let mut raw = Raw { own: std::array::from_fn(change), ..Raw::zero() };
        let columns = self.columns();
        for (k, row) in raw.mixed.iter_mut().enumerate() {
            (0..columns).for_each(|j| row[j] = change(SYMMETRIC.len() + columns * k + j));
            let Some(spatial) = &self.spatial else { continue };
            for (slopes, velocities) in spatial.gap[k].iter().zip(nodes) {
                row[GAP] += slopes.iter().zip(velocities).map(|(slope, v)| dot3(*slope, *v)).sum::<f64>();
            }
            for (slopes, v) in spatial.normal[k].iter().zip(&nodes[0]) {
                (0..3).for_each(|axis| row[NORMAL + axis] += dot3(slopes[axis], *v));
            }
        }
        raw
    }

    /// Apply its transpose to sensitivities of the integrals.
    pub fn backward(&self, sensitivities: &Raw<f64>) -> ([f64; INPUTS], OfNodes) {
        let (mut sums, mut nodes) = ([0.0; INPUTS], [[[0.0; 3]; NODES]; 2]);
        let columns = self.columns();
        let factors = sensitivities.own.iter().chain(sensitivities.mixed.iter().flat_map(|row| &row[..columns]));
        for (row, &factor) in self.planar.iter().zip(factors) {
            sums.iter_mut().zip(row).for_each(|(sum, slope)| *sum += factor * slope);
        }
        if let Some(spatial) = &self.spatial {
            for (k, row) in sensitivities.mixed.iter().enumerate() {
                let mut add = |side: usize, node: usize, factor: f64, slope: [f64; 3]| {
                    (0..3).for_each(|axis| nodes[side][node][axis] += factor * slope[axis]);
                };
                for node in 0..NODES {
                    (0..2).for_each(|side| add(side, node, row[GAP], spatial.gap[k][side][node]));
                    let slopes = spatial.normal[k][node];
                    (0..3).for_each(|axis| add(0, node, row[NORMAL + axis], slopes[axis]));
                }
            }
        }
        (sums, nodes)
    }
}

impl Spatial {
    fn new(slave: &Planar<f64>, master: &Planar<f64>, curves: [&Curve; 2]) -> Self {
        let mut sums = Self { gap: [[[[0.0; 3]; NODES]; 2]; 4], normal: [[[[0.0; 3]; 3]; NODES]; 4] };
        visit(slave, master, |common, own, other| {
            points(common, |weight, point| sums.add_point(weight, own.shape(point), other.shape(point), curves));
        });
        sums
    }

    /// ```text
    /// ∂ν = (I − ν νᵀ)(∂a × b + a × ∂b)/|a × b|,   ∂(ν·(Y_m − Y_s)) = ∂ν·(Y_m − Y_s) + ν·(∂Y_m − ∂Y_s)
    /// ```
    fn add_point(&mut self, weight: f64, own: [f64; 4], other: [f64; 4], [slave, master]: [&Curve; 2]) {
        let weighted = own.map(|value| value * weight);
        let (own, other) = (Quadratic::new(slave.count, own), Quadratic::new(master.count, other));
        let [a, b] = own.tangents(&slave.nodes);
        let area = cross3(a, b);
        let size = dot3(area, area).sqrt();
        let normal = area.map(|component| component / size);
        let (from, to) = (own.point(slave), other.point(master));
        // The transpose of ∂ν at one node, for a vector.
        let turned = |slopes: [f64; 2], vector: [f64; 3]| -> [f64; 3] {
            let along = dot3(normal, vector);
            let across: [f64; 3] = std::array::from_fn(|axis| (vector[axis] - along * normal[axis]) / size);
            let (by_a, by_b) = (cross3(b, across), cross3(across, a));
            std::array::from_fn(|axis| slopes[0] * by_a[axis] + slopes[1] * by_b[axis])
        };
        let distance = std::array::from_fn(|axis| to[axis] - from[axis]);
        for node in 0..NODES {
            let by_distance = turned(own.slopes[node], distance);
            let by_axis: [[f64; 3]; 3] = std::array::from_fn(|axis| {
                turned(own.slopes[node], std::array::from_fn(|other| if other == axis { 1.0 } else { 0.0 }))
            });
            for (k, &weight) in weighted.iter().enumerate() {
                for axis in 0..3 {
                    self.gap[k][0][node][axis] += weight * (by_distance[axis] - own.values[node] * normal[axis]);
                    self.gap[k][1][node][axis] += weight * other.values[node] * normal[axis];
                    (0..3).for_each(|to| self.normal[k][node][axis][to] += weight * by_axis[axis][to]);
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_rule_is_exact_to_degree_eight() {
        let factorial = |n: i32| (1..=n).map(f64::from).product::<f64>();
        for (a, b) in (0..=8).flat_map(|a| (0..=8 - a).map(move |b| (a, b))) {
            let sum: f64 = rule().map(|([_, x, y], weight)| weight * x.powi(a) * y.powi(b)).sum();
            let exact = 2.0 * factorial(a) * factorial(b) / factorial(a + b + 2);
            assert!((sum - exact).abs() < 1e-15, "x^{a} y^{b}: {:e}", sum - exact);
        }
        let ninth: f64 = rule().map(|([_, x, _], weight)| weight * x.powi(9)).sum();
        assert!((ninth - 2.0 / 110.0).abs() > 1e-8);
    }

    #[test]
    fn integrals_of_two_shifted_squares() {
        // [0, 1]² and [1/2, 3/2] × [0, 1]: N_0 = (1 − x)(1 − y), Nᵐ_0 = (3/2 − x)(1 − y).
        let square = |x: f64| Planar { corners: [[x, 0.0], [x + 1.0, 0.0], [x + 1.0, 1.0], [x, 1.0]], count: 4 };
        let raw = Raw::new(&square(0.0), &square(0.5), None);
        let inner = |f: fn(f64) -> f64| {
            [0.5, 0.75, 1.0].iter().zip([1.0, 4.0, 1.0]).map(|(&x, w)| w * f(x)).sum::<f64>() / 12.0
        };
        let (own, mixed) = (inner(|x| (1.0 - x) * (1.0 - x)), inner(|x| (1.0 - x) * (1.5 - x)));
        assert!((raw.own[0] - own / 3.0).abs() < 1e-16 && (raw.mixed[0][0] - mixed / 3.0).abs() < 1e-16);
        // The derivative of ∫∫ by a common shift of the master's left corners, d/ds: −N_0 Nᵐ_0 at the edge, and Nᵐ_0′.
        let jacobian = jacobian(&square(0.0), &square(0.5), None);
        let difference = |s: f64| {
            let master = Planar { corners: [[0.5 + s, 0.0], [1.5, 0.0], [1.5, 1.0], [0.5 + s, 1.0]], count: 4 };
            Raw::new(&square(0.0), &master, None).mixed[0][0]
        };
        let slope = jacobian.planar[10][8] + jacobian.planar[10][14];
        assert!((slope - (difference(1e-5) - difference(-1e-5)) / 2e-5).abs() < 1e-9);
    }
}
