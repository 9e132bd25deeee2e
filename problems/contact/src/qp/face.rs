//! The face of a point: which entries may move at first order, and how active discs curve.
//!
//! ```text
//! inside:          all entries of the block move
//! on a circle:     x_T slides along the tangent p ⟂ e;  the multiplier κ = −g·e/radius adds κ p pᵀ to the Hessian
//! on a bound, on a zero disc, at the end of an interval:   held
//! ```
//! The curvature κ is that of the Lagrangian: a Newton step in the face follows the circle, not only its tangent.

use crate::qp::separable_set::{on_circle, polar};
use crate::qp::{Block, SeparableSet};

/// What a constrained block may do.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Part {
    Held { first: usize, size: usize },
    Slide { first: usize, tangent: [f64; 2], curvature: f64 },
}

/// A linear space of directions with the curvature of its active circles.
#[derive(Debug, Clone, PartialEq)]
pub struct Face {
    parts: Vec<Part>,
}

impl Face {
    /// The face of x; with `release`, blocks whose negative gradient points into the set are let go.
    pub(crate) fn new(set: &SeparableSet, x: &[f64], gradient: &[f64], release: bool) -> Self {
        let mut parts = Vec::new();
        for block in set.blocks() {
            match *block {
                Block::HalfLine { index, bound } => {
                    if x[index] <= bound && (gradient[index] >= 0.0 || !release) {
                        parts.push(Part::Held { first: index, size: 1 });
                    }
                }
                Block::Disc { first, size, centre, radius } => {
                    let range = first..first + size;
                    let (direction, length) = polar(&x[range.clone()], &centre);
                    let outward: f64 = gradient[range].iter().zip(direction).map(|(g, e)| g * e).sum();
                    if !on_circle(length, radius) || (radius > 0.0 && release && outward > 0.0) {
                        continue;
                    }
                    if radius == 0.0 || size == 1 {
                        parts.push(Part::Held { first, size });
                    } else {
                        let tangent = [-direction[1], direction[0]];
                        parts.push(Part::Slide { first, tangent, curvature: (-outward / radius).max(0.0) });
                    }
                }
            }
        }
        Self { parts }
    }

    /// Orthogonal projection onto the space of directions, in place.
    pub fn restrict(&self, v: &mut [f64]) {
        for part in &self.parts {
            match *part {
                Part::Held { first, size } => v[first..first + size].fill(0.0),
                Part::Slide { first, tangent, .. } => {
                    let along = tangent[0] * v[first] + tangent[1] * v[first + 1];
                    v[first] = along * tangent[0];
                    v[first + 1] = along * tangent[1];
                }
            }
        }
    }

    /// Multiplies the circles' entries of v by `factor(κ)`.
    pub(crate) fn scale_circles(&self, v: &mut [f64], factor: impl Fn(f64) -> f64) {
        self.for_circles(|entry, curvature| v[entry] *= factor(curvature));
    }

    /// v += `factor(κ)`·d on the circles.
    pub(crate) fn add_on_circles(&self, d: &[f64], v: &mut [f64], factor: impl Fn(f64) -> f64) {
        self.for_circles(|entry, curvature| v[entry] += factor(curvature) * d[entry]);
    }

    fn for_circles(&self, mut visit: impl FnMut(usize, f64)) {
        for part in &self.parts {
            if let Part::Slide { first, curvature, .. } = *part {
                visit(first, curvature);
                visit(first + 1, curvature);
            }
        }
    }
}
