//! Directions from which bodies are seen, and places on the drawing, in orthographic projection.
//!
//! ```text
//! towards the viewer  w = (cos ε cos α, cos ε sin α, sin ε)
//! to the right        r = (−sin α, cos α, 0),   up  u = w × r = (−sin ε cos α, −sin ε sin α, cos ε)
//! place on the drawing = scale · (p·r, −p·u),   depth = scale · p·w
//! ```

use super::canvas::Place;
use super::scale::extent;

/// A point in space.
pub(super) type Point = [f64; 3];

/// Angle between the viewer and the face that is looked at, around the third axis.
const TURN: f64 = 35.0_f64.to_radians();
/// Angle ε of the viewer above or below the plane of the first two axes.
const RISE: f64 = 30.0_f64.to_radians();
/// A part of a normal, relative to its length, that decides about the direction of view.
const MIN_PART: f64 = 0.3;

/// The direction from which bodies are seen. The third axis always points upwards.
///
/// By default, bodies are seen from the front, the right and above: of a box the faces x₁ = max, x₂ = min and x₃ = max.
///
/// ```
/// use figures::View;
/// assert_eq!(View::towards([0.0, 0.0, 1.0]), View::default());
/// assert_ne!(View::towards([-1.0, 0.0, 0.0]), View::default());
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct View {
    /// α of the head of the file.
    azimuth: f64,
    /// ε of the head of the file.
    elevation: f64,
}

impl Default for View {
    fn default() -> Self {
        Self::towards([0.0, -1.0, 0.0])
    }
}

impl View {
    /// Looks at a face with this outward normal, of any length, from an oblique angle: from above, or from below if the
    /// normal points downwards. A normal along the third axis, and a vector without direction, leave the azimuth of the
    /// default view.
    pub fn towards(normal: [f64; 3]) -> Self {
        let [x, y, z] = normal;
        let length = x.hypot(y).hypot(z);
        let [x, y] = if x.hypot(y) > MIN_PART * length { [x, y] } else { [0.0, -1.0] };
        Self { azimuth: y.atan2(x) + TURN, elevation: if z < -MIN_PART * length { -RISE } else { RISE } }
    }

    /// Unit vector from the bodies towards the viewer.
    pub fn towards_viewer(&self) -> [f64; 3] {
        self.directions()[2]
    }

    /// r, u and w of the head of the file.
    fn directions(&self) -> [Point; 3] {
        let ((sin_turn, cos_turn), (sin_rise, cos_rise)) = (self.azimuth.sin_cos(), self.elevation.sin_cos());
        [
            [-sin_turn, cos_turn, 0.0],
            [-sin_rise * cos_turn, -sin_rise * sin_turn, cos_rise],
            [cos_rise * cos_turn, cos_rise * sin_turn, sin_rise],
        ]
    }

    /// Smallest and largest coordinates of points on a drawing of scale 1.
    pub(super) fn bounds(self, points: impl Iterator<Item = Point> + Clone) -> [[f64; 2]; 2] {
        let drawing = Projection { view: self, origin: [0.0; 2], scale: 1.0 };
        let ends = |axis: usize| extent(points.clone().map(|point| drawing.place(point)[axis]));
        [0, 1].map(|axis| ends(axis).map_or([0.0; 2], |(low, high)| [low, high]))
    }
}

/// How points are placed on the drawing.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Projection {
    pub view: View,
    /// Place of the point 0.
    pub origin: Place,
    /// Points of the drawing per unit of length.
    pub scale: f64,
}

impl Projection {
    /// Place of a point on the drawing.
    pub fn place(&self, point: Point) -> Place {
        let [right, up, _] = self.view.directions();
        [self.origin[0] + self.scale * dot(point, right), self.origin[1] - self.scale * dot(point, up)]
    }

    /// How near a point is to the viewer, points of the drawing.
    pub fn depth(&self, point: Point) -> f64 {
        self.scale * dot(point, self.view.directions()[2])
    }
}

pub(super) fn dot(a: Point, b: Point) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}
