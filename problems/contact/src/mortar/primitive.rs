//! Surfaces that faces of machines lie on, and the projection onto them.

use super::vector::dot;
use crate::scalar::Scalar;

/// A surface without ends.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Primitive {
    /// A plane.
    Plane {
        /// One of its points, mm.
        point: [f64; 3],
        /// Its unit normal.
        normal: [f64; 3],
    },
    /// A circular cylinder.
    Cylinder {
        /// A point of its axis, mm.
        point: [f64; 3],
        /// The unit vector along its axis.
        axis: [f64; 3],
        /// Radius, mm.
        radius: f64,
    },
    /// A circular cone.
    Cone {
        /// A point of its axis, mm.
        point: [f64; 3],
        /// The unit vector along its axis.
        axis: [f64; 3],
        /// Radius at the point, mm.
        radius: f64,
        /// How much the radius grows per length along the axis.
        slope: f64,
    },
    /// A sphere.
    Sphere {
        /// Its centre, mm.
        point: [f64; 3],
        /// Radius, mm.
        radius: f64,
    },
}

impl Primitive {
    /// From the surface to a place, along the normal there: positive outside.
    pub(crate) fn distance(&self, place: [f64; 3]) -> f64 {
        self.parts(place).0
    }

    /// The point of the surface next to a place.
    pub(crate) fn project<T: Scalar>(&self, place: [T; 3]) -> [T; 3] {
        let (distance, normal) = self.parts(place);
        std::array::from_fn(|axis| place[axis] - distance * normal[axis])
    }

    /// Signed distance, positive outside, and unit normal.
    pub(crate) fn parts<T: Scalar>(&self, place: [T; 3]) -> (T, [T; 3]) {
        let lifted = |vector: [f64; 3]| vector.map(T::constant);
        let from = |point: [f64; 3]| -> [T; 3] { std::array::from_fn(|axis| place[axis] - T::constant(point[axis])) };
        let across = |point: [f64; 3], axis: [f64; 3]| {
            let (from, axis) = (from(point), lifted(axis));
            let along = dot(from, axis);
            let rest: [T; 3] = std::array::from_fn(|k| from[k] - along * axis[k]);
            let length = dot(rest, rest).sqrt();
            (along, length, rest.map(|x| x / length))
        };
        match *self {
            Self::Plane { point, normal } => (dot(from(point), lifted(normal)), lifted(normal)),
            Self::Cylinder { point, axis, radius } => {
                let (_, length, radial) = across(point, axis);
                (length - T::constant(radius), radial)
            }
            Self::Cone { point, axis, radius, slope } => {
                let (along, length, radial) = across(point, axis);
                let cosine = T::constant(1.0 / (1.0 + slope * slope).sqrt());
                let slope = T::constant(slope);
                let distance = (length - T::constant(radius) - slope * along) * cosine;
                (distance, std::array::from_fn(|k| (radial[k] - slope * T::constant(axis[k])) * cosine))
            }
            Self::Sphere { point, radius } => {
                let from = from(point);
                let length = dot(from, from).sqrt();
                (length - T::constant(radius), from.map(|x| x / length))
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn projections_lie_on_the_surface_and_along_its_normal() {
        let axis = [0.6, 0.0, 0.8];
        let all = [
            Primitive::Plane { point: [1.0, 2.0, 3.0], normal: axis },
            Primitive::Cylinder { point: [1.0, 2.0, 3.0], axis, radius: 0.7 },
            Primitive::Cone { point: [1.0, 2.0, 3.0], axis, radius: 0.7, slope: 0.2 },
            Primitive::Sphere { point: [1.0, 2.0, 3.0], radius: 0.7 },
        ];
        for primitive in all {
            let place = [1.9, 2.3, 2.9];
            let foot = primitive.project(place);
            assert!(primitive.distance(foot).abs() < 1e-14, "{primitive:?}");
            let step: f64 = (0..3).map(|axis| (place[axis] - foot[axis]).powi(2)).sum();
            assert!((step.sqrt() - primitive.distance(place).abs()).abs() < 1e-14, "{primitive:?}");
        }
    }
}
