//! The counter surface: a rigid obstacle, or F²(x₁, x₂), the lower surface of an upper body.

use crate::error::SceneError;
use crate::scene::HeightGrid;
use crate::scene::mesh_surface::MeshSurface;
use crate::scene::revolution::{Meridian, Revolution};
use crate::scene::side::Side;
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
    /// A surface of revolution anywhere in space; an obstacle only.
    Revolution(Box<Revolution>),
    /// A face of a mesh anywhere in space; an obstacle only.
    Mesh(MeshSurface),
}

/// R − √(R² − r²) of a sphere at the place r from its lowest point, without the cancellation for large R.
fn rise(radius: f64, place: [f64; 2]) -> f64 {
    let square = place[0] * place[0] + place[1] * place[1];
    square / (radius + (radius * radius - square).sqrt())
}

impl From<Revolution> for CounterSurface {
    fn from(surface: Revolution) -> Self {
        Self::Revolution(Box::new(surface))
    }
}

impl CounterSurface {
    /// A circular cylinder anywhere in space, without ends: a point of its axis (mm), the direction of its axis, its
    /// radius (mm), and where the body is. An obstacle only.
    pub fn cylinder(point: [f64; 3], axis: [f64; 3], radius: f64, side: Side) -> Self {
        Revolution { point, axis, side, meridian: Meridian::Line { radius, slope: 0.0 } }.into()
    }

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
            Self::Revolution(surface) => {
                finite("point", &surface.point).and(direction("axis", &surface.axis)).and(surface.check(field))
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
            Self::TiltedPlane { point: x, .. } | Self::Ball { centre: x, .. } => *x = point(*x),
            Self::Revolution(surface) => surface.point = point(surface.point),
            Self::Mesh(surface) => *surface = surface.moved(by),
        }
        moved
    }

    /// Whether it is a height over (x₁, x₂).
    pub fn has_heights(&self) -> bool {
        !matches!(self, Self::TiltedPlane { .. } | Self::Ball { .. } | Self::Revolution(_) | Self::Mesh(_))
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
            Self::TiltedPlane { .. } | Self::Ball { .. } | Self::Revolution(_) | Self::Mesh(_) => f64::NAN,
        }
    }
}
