//! Surfaces of revolution: a meridian in the half-plane of radius ρ and height z about an axis.
//!
//! ```text
//! signed distance in the half-plane:   d(ρ, z),   ∇d = m,   ∇²d = k t tᵀ      m away from the axis,  t ⊥ m
//! in space:   ∇d = m_ρ e_ρ + m_z a,   ∇²d = k t tᵀ + (m_ρ/ρ) e_θ e_θᵀ
//! ```

use crate::error::SceneError;
use crate::mortar::vector::{across as perpendicular, dot, length, plus};
use crate::scene::foot::Foot;
use crate::scene::profile::{MeridianDistance, Profile};
use crate::scene::side::Side;
use serde::{Deserialize, Serialize};

/// Radial part of a unit normal on the axis that is rounding.
const LEVEL: f64 = 1e-9;

/// A surface of revolution; an obstacle only.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Revolution {
    /// A point of the axis, where the height z is zero, mm.
    pub point: [f64; 3],
    /// The direction of the axis, of any length.
    pub axis: [f64; 3],
    /// Where the body is.
    pub side: Side,
    /// The curve that turns about the axis.
    pub meridian: Meridian,
}

/// The curve that turns about the axis of a surface of revolution.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub enum Meridian {
    /// A straight line: a cylinder or a cone, without ends.
    Line {
        /// Radius at the height zero, mm.
        radius: f64,
        /// How much the radius grows per height; 0 for a cylinder.
        slope: f64,
    },
    /// A circle about a point at the height zero: a torus; a barrel where that point lies beyond the axis.
    Circle {
        /// From the axis to the centre of the circle, mm; negative beyond the axis.
        major_radius: f64,
        /// Radius of the circle, mm.
        minor_radius: f64,
    },
    /// A curve through points.
    Profile(Profile),
}

impl Revolution {
    /// Refuses numbers that make no surface; `field` stands in messages.
    ///
    /// # Errors
    /// [`SceneError::OutOfRange`] naming the number.
    pub(super) fn check(&self, field: &str) -> Result<(), SceneError> {
        let positive = |name: &str, value: f64| {
            let valid = value > 0.0 && value.is_finite();
            SceneError::require(valid, format!("{field}.{name}"), value, "a finite number > 0 (mm)")
        };
        match self.meridian {
            Meridian::Line { radius, slope } => {
                positive("radius", radius)?;
                SceneError::require(slope.is_finite(), format!("{field}.slope"), slope, "a finite number")
            }
            Meridian::Circle { major_radius, minor_radius } => {
                positive("minor_radius", minor_radius)?;
                let valid = major_radius.is_finite() && major_radius + minor_radius > 0.0;
                let allowed = "a finite number above that of −minor_radius (mm)";
                SceneError::require(valid, format!("{field}.major_radius"), major_radius, allowed)
            }
            Meridian::Profile(_) => Ok(()),
        }
    }

    /// The foot of a point.
    pub(super) fn foot(&self, x: [f64; 3]) -> Result<Foot, &'static str> {
        let size = length(self.axis);
        let axis = self.axis.map(|part| part / size);
        let from = plus(x, -1.0, self.point);
        let along = dot(from, axis);
        let across = plus(from, -along, axis);
        let radius = length(across);
        let distance = self.meridian.distance([radius, along])?;
        let [first, second] = distance.normal;
        let is_on_axis = radius <= f64::EPSILON * (along.abs() + distance.value.abs());
        if is_on_axis && first.abs() > LEVEL {
            return Err("it lies on the axis of the surface, where every normal is as good");
        }
        // On the axis of a surface that is level there, it bends the same way in all directions.
        let (outward, bending_around) = match is_on_axis {
            true => (perpendicular(axis)[0], distance.bending),
            false => (across.map(|part| part / radius), first / radius),
        };
        let in_space =
            |[radial, axial]: [f64; 2]| -> [f64; 3] { std::array::from_fn(|k| radial * outward[k] + axial * axis[k]) };
        let (normal, tangent) = (in_space([first, second]), in_space([-second, first]));
        let around = |i: usize, j: usize| f64::from(u8::from(i == j)) - outward[i] * outward[j] - axis[i] * axis[j];
        let bending = |i: usize, j: usize| distance.bending * tangent[i] * tangent[j] + bending_around * around(i, j);
        Ok(Foot::of_distance(
            distance.value,
            normal,
            std::array::from_fn(|i| std::array::from_fn(|j| bending(i, j))),
            self.side,
        ))
    }
}

impl Meridian {
    fn distance(&self, place: [f64; 2]) -> Result<MeridianDistance, &'static str> {
        let [radius_of_place, height] = place;
        match *self {
            Self::Line { radius, slope } => {
                let cosine = 1.0 / (1.0 + slope * slope).sqrt();
                let value = cosine * (radius_of_place - radius - slope * height);
                if radius_of_place - cosine * value < 0.0 {
                    return Err("it lies beyond the apex of the cone, where the surface has no normal");
                }
                Ok(MeridianDistance { value, normal: [cosine, -cosine * slope], bending: 0.0 })
            }
            Self::Circle { major_radius, minor_radius } => {
                let from = [radius_of_place - major_radius, height];
                let distance = from[0].hypot(from[1]);
                if distance <= f64::EPSILON * minor_radius {
                    return Err("it lies at the centre of the circle that turns, where every normal is as good");
                }
                let normal = from.map(|part| part / distance);
                if major_radius + minor_radius * normal[0] < 0.0 {
                    return Err("its nearest point on the circle that turns lies beyond the axis");
                }
                Ok(MeridianDistance { value: distance - minor_radius, normal, bending: 1.0 / distance })
            }
            Self::Profile(ref profile) => profile.distance(place),
        }
    }
}
