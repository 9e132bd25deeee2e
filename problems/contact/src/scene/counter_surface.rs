//! F²(x₁, x₂): the obstacle, or the lower surface of the upper body.

use crate::scene::HeightGrid;
use serde::{Deserialize, Serialize};

/// Analytic surfaces of the paper, a plane, indenters with known solutions, and heights on a grid.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub enum CounterSurface {
    /// `base + first·sin(2πx₁/period) + second·cos(2πx₂/period)`, paper (5.3).
    Waves {
        /// Mean height, mm.
        base: f64,
        /// Amplitude along x₁, mm.
        first: f64,
        /// Amplitude along x₂, mm.
        second: f64,
        /// Wave length, mm.
        period: f64,
    },
    /// `apex + R − √(R² − x₁² − x₂²)`: a sphere that touches the height `apex` over the corner (0, 0).
    Sphere {
        /// Height of the lowest point, mm.
        apex: f64,
        /// Radius R, mm.
        radius: f64,
    },
    /// As [`CounterSurface::Sphere`], touching over any point.
    SphereAt {
        /// Height of the lowest point, mm.
        apex: f64,
        /// Radius R, mm.
        radius: f64,
        /// (x₁, x₂) of the lowest point, mm.
        centre: [f64; 2],
    },
    /// A flat strip punch along x₂: the height `height` where |x₁| ≤ `half_width`, higher by `relief` elsewhere.
    Punch {
        /// Height of its flat face, mm.
        height: f64,
        /// Half of its width along x₁, mm.
        half_width: f64,
        /// How much higher the surface is beside the punch, mm.
        relief: f64,
    },
    /// A horizontal plane.
    Plane {
        /// Its height, mm.
        height: f64,
    },
    /// Heights on a grid over the base.
    Grid(HeightGrid),
}

/// R − √(R² − r²) of a sphere at the place r from its lowest point, without the cancellation for large R.
fn rise(radius: f64, place: [f64; 2]) -> f64 {
    let square = place[0] * place[0] + place[1] * place[1];
    square / (radius + (radius * radius - square).sqrt())
}

impl CounterSurface {
    /// Height at (x₁, x₂), mm; NaN outside a sphere.
    pub fn height(&self, x1: f64, x2: f64) -> f64 {
        match self {
            &Self::Waves { base, first, second, period } => {
                let angle = 2.0 * std::f64::consts::PI / period;
                first * (angle * x1).sin() + second * (angle * x2).cos() + base
            }
            &Self::Sphere { apex, radius } => apex + rise(radius, [x1, x2]),
            &Self::SphereAt { apex, radius, centre } => apex + rise(radius, [x1 - centre[0], x2 - centre[1]]),
            // Nodes on the edge belong to the face, whatever rounding says.
            &Self::Punch { height, half_width, relief } => {
                height + if x1.abs() <= half_width * (1.0 + 1e-9) { 0.0 } else { relief }
            }
            &Self::Plane { height } => height,
            Self::Grid(grid) => grid.height(x1, x2),
        }
    }
}
