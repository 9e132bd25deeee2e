//! Directions from which bodies are seen: w = (cos ε cos α, cos ε sin α, sin ε) towards the viewer.

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
        let ((sin_turn, cos_turn), (sin_rise, cos_rise)) = (self.azimuth.sin_cos(), self.elevation.sin_cos());
        [cos_rise * cos_turn, cos_rise * sin_turn, sin_rise]
    }
}
