//! The counter surface: a rigid obstacle, or F²(x₁, x₂), the lower surface of an upper body.

use crate::error::SceneError;
use crate::scene::HeightGrid;
use crate::shape::Pieces;
use serde::{Deserialize, Serialize};

/// Analytic surfaces of the paper, a plane, indenters with known solutions, and heights on a grid.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub enum CounterSurface {
    /// `base + first·sin(2π(x₁ − o₁)/period) + second·cos(2π(x₂ − o₂)/period)`, paper (5.3) for the origin o = 0.
    Waves {
        /// Mean height of the waves, mm.
        base: f64,
        /// Amplitude along x₁, mm.
        first: f64,
        /// Amplitude along x₂, mm.
        second: f64,
        /// Length of the waves along both axes, mm.
        period: f64,
        /// (x₁, x₂) of the origin o, mm.
        origin: [f64; 2],
    },
    /// `apex + R − √(R² − r²)` at the distance r from the centre: a sphere that touches the height `apex` there.
    Sphere {
        /// Height of the lowest point, mm.
        apex: f64,
        /// Radius R of the sphere, mm.
        radius: f64,
        /// (x₁, x₂) of the lowest point, mm.
        centre: [f64; 2],
    },
    /// A flat strip punch along x₂: the height `height` where |x₁ − `centre`| ≤ `half_width`, higher by `relief`
    /// elsewhere.
    Punch {
        /// Height of its flat face, mm.
        height: f64,
        /// Half of its width along x₁, mm.
        half_width: f64,
        /// How much higher the surface is beside the punch, mm.
        relief: f64,
        /// x₁ of its middle, mm.
        centre: f64,
    },
    /// A horizontal plane at a height.
    Plane {
        /// Height of the plane, mm.
        height: f64,
    },
    /// Heights on a grid over the base.
    Grid(HeightGrid),
    /// A plane anywhere in space; an obstacle only.
    TiltedPlane {
        /// One of its points, mm.
        point: [f64; 3],
        /// Its normal from the body into the obstacle, of any length.
        normal: [f64; 3],
    },
    /// A sphere anywhere in space; an obstacle only.
    Ball {
        /// Centre, mm.
        centre: [f64; 3],
        /// Radius, mm.
        radius: f64,
        /// Where the body is.
        side: Side,
    },
    /// A circular cylinder anywhere in space, without ends; an obstacle only.
    Cylinder {
        /// A point of its axis, mm.
        point: [f64; 3],
        /// The direction of its axis, of any length.
        axis: [f64; 3],
        /// Radius, mm.
        radius: f64,
        /// Where the body is.
        side: Side,
    },
}

/// On which side of a closed surface the body is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema), schemars(rename = "SideName", transform = crate::schema::names_only))]
pub enum Side {
    /// Outside: the obstacle is convex.
    #[default]
    Outside,
    /// Inside: the obstacle is a socket or a bore.
    Inside,
}

/// R − √(R² − r²) of a sphere at the place r from its lowest point, without the cancellation for large R.
fn rise(radius: f64, place: [f64; 2]) -> f64 {
    let square = place[0] * place[0] + place[1] * place[1];
    square / (radius + (radius * radius - square).sqrt())
}

impl CounterSurface {
    /// Refuses numbers that make no surface; `field` stands in messages.
    ///
    /// # Errors
    /// [`SceneError::OutOfRange`] for directions of no length, radii that are not positive, numbers that are not
    /// finite.
    pub(crate) fn check(&self, field: &str) -> Result<(), SceneError> {
        let direction = |name: &str, vector: &[f64; 3]| {
            let length = vector.iter().map(|x| x * x).sum::<f64>().sqrt();
            let valid = length > 0.0 && length.is_finite();
            SceneError::require(valid, format!("{field}.{name}"), format!("{vector:?}"), "a direction of some length")
        };
        let finite = |name: &str, vector: &[f64; 3]| {
            let valid = vector.iter().all(|x| x.is_finite());
            SceneError::require(valid, format!("{field}.{name}"), format!("{vector:?}"), "finite numbers (mm)")
        };
        let radius = |radius: f64| {
            let valid = radius > 0.0 && radius.is_finite();
            SceneError::require(valid, format!("{field}.radius"), radius, "a finite number > 0 (mm)")
        };
        match self {
            Self::TiltedPlane { point, normal } => finite("point", point).and(direction("normal", normal)),
            Self::Ball { centre, radius: r, .. } => finite("centre", centre).and(radius(*r)),
            Self::Cylinder { point, axis, radius: r, .. } => {
                finite("point", point).and(direction("axis", axis)).and(radius(*r))
            }
            Self::Sphere { radius: r, .. } => radius(*r),
            _ => Ok(()),
        }
    }

    /// The surface translated by a vector, mm.
    #[must_use]
    pub fn moved(&self, by: [f64; 3]) -> Self {
        let along_base = |[x1, x2]: [f64; 2]| [x1 + by[0], x2 + by[1]];
        let point = |x: [f64; 3]| std::array::from_fn(|axis| x[axis] + by[axis]);
        let mut moved = self.clone();
        match &mut moved {
            Self::Waves { base, origin, .. } => (*base, *origin) = (*base + by[2], along_base(*origin)),
            Self::Sphere { apex, centre, .. } => (*apex, *centre) = (*apex + by[2], along_base(*centre)),
            Self::Punch { height, centre, .. } => (*height, *centre) = (*height + by[2], *centre + by[0]),
            Self::Plane { height } => *height += by[2],
            Self::Grid(grid) => *grid = grid.moved(by),
            Self::TiltedPlane { point: x, .. } | Self::Ball { centre: x, .. } | Self::Cylinder { point: x, .. } => {
                *x = point(*x);
            }
        }
        moved
    }

    /// Whether it is a height over (x₁, x₂).
    pub fn has_heights(&self) -> bool {
        !matches!(self, Self::TiltedPlane { .. } | Self::Ball { .. } | Self::Cylinder { .. })
    }

    /// Height at (x₁, x₂), mm; NaN outside a sphere, and where the surface is no height over (x₁, x₂).
    pub fn height(&self, x1: f64, x2: f64) -> f64 {
        match self {
            &Self::Waves { base, first, second, period, origin: [o1, o2] } => {
                let angle = 2.0 * std::f64::consts::PI / period;
                first * (angle * (x1 - o1)).sin() + second * (angle * (x2 - o2)).cos() + base
            }
            &Self::Sphere { apex, radius, centre } => apex + rise(radius, [x1 - centre[0], x2 - centre[1]]),
            // Nodes on the edge belong to the face, whatever rounding says.
            &Self::Punch { height, half_width, relief, centre } => {
                height + if (x1 - centre).abs() <= half_width * (1.0 + 1e-9) { 0.0 } else { relief }
            }
            &Self::Plane { height } => height,
            Self::Grid(grid) => grid.height(x1, x2),
            Self::TiltedPlane { .. } | Self::Ball { .. } | Self::Cylinder { .. } => f64::NAN,
        }
    }

    /// The smooth pieces of the surface over a base of `size` mm; none for a punch, which has a step, and for surfaces
    /// that are no heights.
    ///
    /// A sphere is most curved where it is farthest from its lowest point: |vᵀ∇²F v| ≤ |v|² R²/(R² − r²)^{3/2}.
    pub fn pieces(&self, size: [f64; 2]) -> Option<Pieces> {
        let whole = size.map(|length| vec![0.0, length]);
        let sphere = |radius: f64, [c1, c2]: [f64; 2]| {
            let farthest = [c1.abs().max((size[0] - c1).abs()), c2.abs().max((size[1] - c2).abs())];
            let depth = radius * radius - farthest.iter().map(|x| x * x).sum::<f64>();
            let curvature = radius * radius / depth.powf(1.5);
            [curvature, 0.0, curvature]
        };
        let (lines, curvature) = match self {
            &Self::Waves { first, second, period, .. } => {
                let square = (2.0 * std::f64::consts::PI / period).powi(2);
                (whole, [square * first.abs(), 0.0, square * second.abs()])
            }
            &Self::Sphere { radius, centre, .. } => (whole, sphere(radius, centre)),
            Self::Punch { .. } | Self::TiltedPlane { .. } | Self::Ball { .. } | Self::Cylinder { .. } => return None,
            Self::Plane { .. } => (whole, [0.0; 3]),
            Self::Grid(grid) => return Some(grid.pieces()),
        };
        Some(Pieces { lines, curvature })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn curvatures_keep_within_the_bounds_and_come_near() {
        let size = [10.0, 7.0];
        for surface in [
            CounterSurface::Waves { base: 3.0, first: -0.5, second: 0.7, period: 5.0, origin: [0.6, -0.3] },
            CounterSurface::Sphere { apex: 1.0, radius: 20.0, centre: [0.0; 2] },
            CounterSurface::Sphere { apex: 1.0, radius: 30.0, centre: [4.0, 9.0] },
        ] {
            let [c11, c12, c22] = surface.pieces(size).expect("smooth").curvature;
            // Second differences: rounding is 1e-15/step², and their error of higher order is small on this step.
            let (mut largest, step) = (0.0_f64, 1e-3);
            for (i, j, turn) in (0..40 * 40 * 8).map(|index| (index / 320 + 1, index / 8 % 40 + 1, index % 8)) {
                let [x1, x2] = [size[0] * f64::from(i) / 41.0, size[1] * f64::from(j) / 41.0];
                let (v2, v1) = (f64::from(turn) * std::f64::consts::PI / 8.0).sin_cos();
                let at = |way: f64| surface.height(x1 + way * step * v1, x2 + way * step * v2);
                let curvature = (at(1.0) - 2.0 * at(0.0) + at(-1.0)).abs() / (step * step);
                largest = largest.max(curvature / (c11 * v1 * v1 + 2.0 * c12 * (v1 * v2).abs() + c22 * v2 * v2));
            }
            assert!((0.8..1.0 + 1e-6).contains(&largest), "{surface:?}: {largest}");
        }
        assert_eq!(CounterSurface::Plane { height: 3.0 }.pieces(size).map(|plane| plane.curvature), Some([0.0; 3]));
        assert_eq!(CounterSurface::Punch { height: 1.0, half_width: 2.0, relief: 3.0, centre: 0.0 }.pieces(size), None);
    }
}
