//! Coordinates of a lattice: where points of space, or of a block, lie in it.

use crate::error::SceneError;
use crate::scene::Block;
use serde::{Deserialize, Serialize};

/// Which coordinates a lattice has.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub enum Coordinates {
    /// Along the three axes of a box with a corner and edges that are perpendicular to each other.
    Cartesian {
        /// Corner of the box, mm.
        corner: [f64; 3],
        /// Its edges, mm.
        edges: [[f64; 3]; 3],
    },
    /// Radius, angle and height about an axis.
    Cylindrical {
        /// A point of the axis, from which heights are measured, mm.
        point: [f64; 3],
        /// Direction of the axis.
        axis: [f64; 3],
        /// Direction of angle 0, across the axis.
        zero: [f64; 3],
        /// Least and largest radius, mm; angle, radians; height, mm.
        ranges: [[f64; 2]; 3],
    },
    /// Along the bricks of a block: node (i, j, k) of n₁ × n₂ × n₃ bricks lies at (i/n₁, j/n₂, k/n₃), whatever the
    /// heights of its faces; control points move along x₁, x₂, x₃.
    Block,
}

/// Distance over the extent of a lattice at which a point still counts as inside: rounding of mesh files.
const INSIDE: f64 = 1e-9;

/// A point on [0, 1]³ with the unit vectors of the coordinates there.
pub(crate) type Place = ([f64; 3], [[f64; 3]; 3]);

/// The axes of space.
pub(crate) const AXES: [[f64; 3]; 3] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

impl Coordinates {
    /// Checks their numbers.
    ///
    /// # Errors
    /// [`SceneError::OutOfRange`] naming the field.
    pub(crate) fn validate(&self) -> Result<(), SceneError> {
        match self {
            Self::Cartesian { edges, .. } => {
                for (axis, edge) in edges.iter().enumerate() {
                    let valid = length(*edge) > 0.0 && length(*edge).is_finite();
                    let field = format!("lattice.edges[{axis}]");
                    SceneError::require(valid, field, format!("{edge:?}"), "an edge of some length (mm)")?;
                    for other in &edges[..axis] {
                        let cosine = dot(*edge, *other) / (length(*edge) * length(*other));
                        let allowed = "edges perpendicular to each other";
                        SceneError::require(cosine.abs() < 1e-6, "lattice.edges", format!("{edges:?}"), allowed)?;
                    }
                }
            }
            Self::Cylindrical { axis, zero, ranges, .. } => {
                let valid = length(*axis) > 0.0 && length(cross(*axis, *zero)) > 1e-9 * length(*axis) * length(*zero);
                let value = format!("axis {axis:?}, zero {zero:?}");
                SceneError::require(valid, "lattice.axis", value, "two directions that are not parallel")?;
                for [least, largest] in ranges {
                    let value = format!("[{least}, {largest}]");
                    SceneError::require(least < largest, "lattice.ranges", value, "the smaller number first")?;
                }
            }
            Self::Block => {}
        }
        Ok(())
    }

    /// A point of space in the lattice; none outside its box, and for the coordinates of a block, whose nodes have
    /// places by their numbers.
    pub(crate) fn place(&self, x: [f64; 3]) -> Option<Place> {
        let (xi, frame): Place = match *self {
            Self::Cartesian { corner, edges } => {
                let from = subtract(x, corner);
                (edges.map(|edge| dot(from, edge) / dot(edge, edge)), edges.map(unit))
            }
            Self::Cylindrical { point, axis, zero, ranges } => {
                let axis = unit(axis);
                let second = unit(cross(axis, zero));
                let first = cross(second, axis);
                let from = subtract(x, point);
                let (height, a, b) = (dot(from, axis), dot(from, first), dot(from, second));
                let radius = a.hypot(b);
                // The angle counts from the least one of the range.
                let [least, largest] = ranges[1];
                let turn = 2.0 * std::f64::consts::PI;
                let slack = INSIDE * (largest - least);
                let angle = least - slack + (b.atan2(a) - least + slack).rem_euclid(turn);
                let outward = combine(first, a / radius, second, b / radius);
                let around = combine(first, -b / radius, second, a / radius);
                let place = [radius, angle, height];
                let xi = |k: usize| (place[k] - ranges[k][0]) / (ranges[k][1] - ranges[k][0]);
                (std::array::from_fn(xi), [outward, around, axis])
            }
            Self::Block => return None,
        };
        let inside = xi.iter().all(|xi| (-INSIDE..=1.0 + INSIDE).contains(xi));
        inside.then(|| (xi.map(|xi| xi.clamp(0.0, 1.0)), frame))
    }

    /// Where a point of the lattice lies at the start, mm; `block`: the block at the start, for its coordinates.
    pub(crate) fn point(&self, xi: [f64; 3], block: Option<&Block>) -> [f64; 3] {
        match (*self, block) {
            (Self::Cartesian { corner, edges }, _) => {
                std::array::from_fn(|k| corner[k] + (0..3).map(|axis| xi[axis] * edges[axis][k]).sum::<f64>())
            }
            (Self::Cylindrical { point, axis, zero, ranges }, _) => {
                let axis = unit(axis);
                let second = unit(cross(axis, zero));
                let first = cross(second, axis);
                let [radius, angle, height] =
                    std::array::from_fn(|k| ranges[k][0] + xi[k] * (ranges[k][1] - ranges[k][0]));
                let across = combine(first, radius * angle.cos(), second, radius * angle.sin());
                std::array::from_fn(|k| point[k] + across[k] + height * axis[k])
            }
            (Self::Block, Some(block)) => {
                let [x1, x2] = block.grid().moved([block.size[0] * xi[0], block.size[1] * xi[1]]);
                let [bottom, top] = [&block.bottom, &block.top].map(|surface| surface.height(x1, x2));
                [x1, x2, bottom + (top - bottom) * xi[2]]
            }
            (Self::Block, None) => xi,
        }
    }

    /// Lengths of the coordinate lines through the middle, mm.
    pub(crate) fn lengths(&self, block: Option<&Block>) -> [f64; 3] {
        match (*self, block) {
            (Self::Cartesian { edges, .. }, _) => edges.map(length),
            (Self::Cylindrical { ranges: [radius, angle, height], .. }, _) => {
                let middle = 0.5 * (radius[0] + radius[1]);
                [radius[1] - radius[0], middle * (angle[1] - angle[0]), height[1] - height[0]]
            }
            (Self::Block, Some(block)) => {
                let [bottom, top] = [0.0, 1.0].map(|share| self.point([0.5, 0.5, share], Some(block))[2]);
                [block.size[0], block.size[1], top - bottom]
            }
            (Self::Block, None) => [1.0; 3],
        }
    }

    /// What moves along a coordinate does, in words.
    pub(crate) fn way(&self, axis: usize) -> String {
        match *self {
            Self::Cartesian { edges, .. } => {
                let edge = unit(edges[axis]);
                match (0..3).find(|&axis| edge[axis].abs() > 1.0 - 1e-12) {
                    Some(axis) => format!("along x{}", axis + 1),
                    None => format!("along edge {}", axis + 1),
                }
            }
            Self::Cylindrical { .. } => ["outwards", "around", "along the axis"][axis].to_owned(),
            Self::Block => format!("along x{}", axis + 1),
        }
    }
}

pub(crate) fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    (0..3).map(|axis| a[axis] * b[axis]).sum()
}

pub(crate) fn length(a: [f64; 3]) -> f64 {
    dot(a, a).sqrt()
}

pub(crate) fn unit(a: [f64; 3]) -> [f64; 3] {
    let length = length(a);
    a.map(|x| x / length)
}

fn subtract(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|axis| a[axis] - b[axis])
}

pub(crate) fn combine(a: [f64; 3], s: f64, b: [f64; 3], t: f64) -> [f64; 3] {
    std::array::from_fn(|axis| s * a[axis] + t * b[axis])
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|i| a[(i + 1) % 3] * b[(i + 2) % 3] - a[(i + 2) % 3] * b[(i + 1) % 3])
}
