//! Facets of second degree: shape functions of corners and middles, and points of the true surface.
//!
//! ```text
//! Y(ξ) = Σ Q_k X_k + r₀(ξ),   r₀ = projection of Σ Q_k X_k(start) to the primitive less Σ Q_k X_k(start)
//! triangle: λ(2λ − 1), 4 λ_a λ_b;   quadrilateral: eight functions of the serendipity family
//! ```

use super::planar::CORNERS;
use super::polygon::scaled;
use super::primitive::Primitive;
use crate::scalar::Scalar;

/// Corners, then middles; the fourth of each is missing in a triangle.
pub const NODES: usize = 8;

/// What a patch at the start lacks to its primitive: a function of the own coordinates of the facet.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Remainder {
    pub primitive: Primitive,
    /// Corners and middles at the start.
    pub start: [[f64; 3]; NODES],
}

/// In place of the fourth middle of a triangle.
pub const NO_MIDDLE: u32 = u32::MAX;

/// A facet of second degree.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct QuadraticFacet {
    /// Numbers of the middles of its edges, the first between the first two corners; [`NO_MIDDLE`] for none.
    pub middles: [u32; 4],
    /// None for a facet that lies in a plane, or on no primitive.
    pub remainder: Option<Remainder>,
}

/// Shape functions of second degree and their slopes along two coordinates that run counterclockwise.
#[derive(Debug, Clone, Copy)]
pub struct Quadratic<T> {
    pub values: [T; NODES],
    pub slopes: [[T; 2]; NODES],
}

impl<T: Scalar> Quadratic<T> {
    /// From the linear or bilinear shape functions of the corners.
    pub fn new(count: usize, linear: [T; 4]) -> Self {
        if count == 3 { Self::triangle(linear) } else { Self::quadrilateral(linear) }
    }

    fn triangle(linear: [T; 4]) -> Self {
        const SLOPES: [[f64; 2]; 3] = [[-1.0, -1.0], [1.0, 0.0], [0.0, 1.0]];
        let zero = T::constant(0.0);
        let (mut values, mut slopes) = ([zero; NODES], [[zero; 2]; NODES]);
        for k in 0..3 {
            let (a, b) = (linear[k], linear[(k + 1) % 3]);
            values[k] = a * (scaled(a, 2.0) - T::one());
            values[4 + k] = scaled(a * b, 4.0);
            for (along, of_a) in SLOPES[k].into_iter().enumerate() {
                slopes[k][along] = scaled(scaled(a, 4.0) - T::one(), of_a);
                slopes[4 + k][along] = scaled(b, 4.0 * of_a) + scaled(a, 4.0 * SLOPES[(k + 1) % 3][along]);
            }
        }
        Self { values, slopes }
    }

    fn quadrilateral(linear: [T; 4]) -> Self {
        let coordinate =
            |axis: usize| (0..4).fold(T::constant(0.0), |sum, k| sum + scaled(linear[k], CORNERS[k][axis]));
        let (xi, eta) = (coordinate(0), coordinate(1));
        let one = T::one();
        let zero = T::constant(0.0);
        let (mut values, mut slopes) = ([zero; NODES], [[zero; 2]; NODES]);
        for (k, [s, t]) in CORNERS.into_iter().enumerate() {
            let (along, across) = (one + scaled(xi, s), one + scaled(eta, t));
            values[k] = scaled(along * across * (scaled(xi, s) + scaled(eta, t) - one), 0.25);
            slopes[k] = [
                scaled(across * (scaled(xi, 2.0 * s) + scaled(eta, t)), 0.25 * s),
                scaled(along * (scaled(xi, s) + scaled(eta, 2.0 * t)), 0.25 * t),
            ];
        }
        for (k, t) in [(4, -1.0), (6, 1.0)] {
            let (bubble, across) = (one - xi * xi, one + scaled(eta, t));
            values[k] = scaled(bubble * across, 0.5);
            slopes[k] = [zero - xi * across, scaled(bubble, 0.5 * t)];
        }
        for (k, s) in [(5, 1.0), (7, -1.0)] {
            let (along, bubble) = (one + scaled(xi, s), one - eta * eta);
            values[k] = scaled(along * bubble, 0.5);
            slopes[k] = [scaled(bubble, 0.5 * s), zero - eta * along];
        }
        Self { values, slopes }
    }

    /// Σ Q_k X_k.
    pub fn place(&self, nodes: &[[f64; 3]; NODES]) -> [T; 3] {
        std::array::from_fn(|axis| {
            (0..NODES).fold(T::constant(0.0), |sum, k| sum + scaled(self.values[k], nodes[k][axis]))
        })
    }

    /// Σ Q_k,ξ X_k and Σ Q_k,η X_k.
    pub fn tangents(&self, nodes: &[[f64; 3]; NODES]) -> [[T; 3]; 2] {
        [0, 1].map(|along| {
            std::array::from_fn(|axis| {
                (0..NODES).fold(T::constant(0.0), |sum, k| sum + scaled(self.slopes[k][along], nodes[k][axis]))
            })
        })
    }

    /// The point of the true surface.
    pub fn point(&self, curve: &Curve) -> [T; 3] {
        let patch = self.place(&curve.nodes);
        let Some(remainder) = &curve.remainder else { return patch };
        let start = self.place(&remainder.start);
        let foot = remainder.primitive.project(start);
        std::array::from_fn(|axis| patch[axis] + (foot[axis] - start[axis]))
    }
}

/// A facet of second degree at a shape.
#[derive(Debug, Clone, Copy)]
pub struct Curve {
    pub count: usize,
    pub nodes: [[f64; 3]; NODES],
    pub remainder: Option<Remainder>,
}
