//! Surfaces of a scene file: obstacles, optimized surfaces of blocks, and their bounds.

use contact::scene::Side;
use contact::shape::ShapedFace;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A rigid obstacle, or the heights of a face of a block.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(tag = "form", rename_all = "kebab-case", deny_unknown_fields)]
pub enum ObstacleSection {
    /// A horizontal plane.
    Plane {
        /// Its height.
        #[schemars(range(min = -1e9, max = 1e9), extend("x-unit" = "mm"))]
        height: f64,
    },
    /// base + first sin(2 pi x1/period) + second cos(2 pi x2/period).
    Waves {
        /// Mean height.
        #[schemars(range(min = -1e9, max = 1e9), extend("x-unit" = "mm"))]
        base: f64,
        /// Amplitude along x1.
        #[schemars(range(min = -1e9, max = 1e9), extend("x-unit" = "mm"))]
        first: f64,
        /// Amplitude along x2.
        #[schemars(range(min = -1e9, max = 1e9), extend("x-unit" = "mm"))]
        second: f64,
        /// Wave length.
        #[schemars(range(max = 1e9), extend("x-unit" = "mm", "exclusiveMinimum" = 0.0))]
        period: f64,
    },
    /// A sphere as a height surface, which must cover the base.
    Sphere {
        /// Height of the lowest point.
        #[schemars(range(min = -1e9, max = 1e9), extend("x-unit" = "mm"))]
        apex: f64,
        /// Radius.
        #[schemars(range(max = 1e12), extend("x-unit" = "mm", "exclusiveMinimum" = 0.0))]
        radius: f64,
        /// x1, x2 of the lowest point. Default [0, 0].
        #[serde(default, skip_serializing_if = "Option::is_none")]
        #[schemars(inner(range(min = -1e9, max = 1e9)), extend("x-unit" = "mm"))]
        centre: Option<[f64; 2]>,
    },
    /// Heights on a uniform grid over the base, bilinear in between.
    Grid {
        /// CSV file beside the scene file: one line per x1, one column per x2, both edges included; mm. Lines that
        /// begin with # are comments.
        file: String,
        /// The corner of the grid of least x1 and x2. Default that of the base of the block.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        #[schemars(inner(range(min = -1e9, max = 1e9)), extend("x-unit" = "mm"))]
        origin: Option<[f64; 2]>,
        /// Lengths of the grid along x1, x2; required for a mesh. Default those of the base of the block.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        #[schemars(inner(range(min = 1e-9, max = 1e9)), extend("x-unit" = "mm"))]
        size: Option<[f64; 2]>,
    },
    /// A plane anywhere in space; an obstacle only.
    TiltedPlane {
        /// One of its points.
        #[schemars(inner(range(min = -1e9, max = 1e9)), extend("x-unit" = "mm"))]
        point: [f64; 3],
        /// Its normal from the body into the obstacle, of any length.
        #[schemars(inner(range(min = -1e9, max = 1e9)), extend("x-unit" = "1"))]
        normal: [f64; 3],
    },
    /// A sphere anywhere in space; an obstacle only.
    Ball {
        /// Centre.
        #[schemars(inner(range(min = -1e12, max = 1e12)), extend("x-unit" = "mm"))]
        centre: [f64; 3],
        /// Radius.
        #[schemars(range(max = 1e12), extend("x-unit" = "mm", "exclusiveMinimum" = 0.0))]
        radius: f64,
        /// Where the body is: inside for a socket.
        #[serde(default)]
        side: Side,
    },
    /// A circular cylinder anywhere in space, without ends; an obstacle only.
    Cylinder {
        /// A point of its axis.
        #[schemars(inner(range(min = -1e12, max = 1e12)), extend("x-unit" = "mm"))]
        point: [f64; 3],
        /// Direction of its axis, of any length.
        #[schemars(inner(range(min = -1e9, max = 1e9)), extend("x-unit" = "1"))]
        axis: [f64; 3],
        /// Radius.
        #[schemars(range(max = 1e12), extend("x-unit" = "mm", "exclusiveMinimum" = 0.0))]
        radius: f64,
        /// Where the body is: inside for a bore.
        #[serde(default)]
        side: Side,
    },
}

/// The optimized surface of a block.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SurfaceSection {
    /// The face of the block that it shapes.
    #[serde(default)]
    pub face: ShapedFace,
    /// Spline that carries the surface.
    #[serde(default)]
    pub spline: SplineName,
    /// Degree of the B-spline, less than the number of control points; a Bezier surface has none of its own. Default 3.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 1, max = 39), extend("x-unit" = "1"))]
    pub degree: Option<usize>,
    /// Control points along x1, x2.
    #[serde(default = "six_by_six")]
    #[schemars(inner(range(min = 2, max = 40)), extend("x-unit" = "1"))]
    pub control_points: [usize; 2],
    /// Shape that an optimization starts from.
    pub start: StartSection,
    /// A fairer surface than the measure alone asks for. Default none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub fairness: Option<FairnessSection>,
}

/// The bending of the surface as a part of the objective.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct FairnessSection {
    /// The factor of the bending ∫(∂₁₁F)² + 2(∂₁₂F)² + (∂₂₂F)² of the control net, a number without unit, which is
    /// added to the objective.
    #[schemars(range(min = 0.0, max = 1e60), extend("x-unit" = "unit of the objective"))]
    pub weight: f64,
}

/// Which spline.
// The tag of `SplineKind`, whose degree is a field of its own in a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
#[allow(missing_docs, reason = "the names are the meaning")]
pub enum SplineName {
    #[default]
    Bspline,
    Bezier,
}

/// The shape at the start. All forms but `controls` are sampled at the places of the control points, which are spread
/// evenly over the base.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(tag = "form", rename_all = "kebab-case", deny_unknown_fields)]
pub enum StartSection {
    /// All control heights alike.
    Plane {
        /// The height.
        #[schemars(range(max = 1e9), extend("x-unit" = "mm", "exclusiveMinimum" = 0.0))]
        height: f64,
    },
    /// base + first sin(2 pi x1/period) + second cos(2 pi x2/period).
    Waves {
        /// Mean height.
        #[schemars(range(max = 1e9), extend("x-unit" = "mm", "exclusiveMinimum" = 0.0))]
        base: f64,
        /// Amplitude along x1.
        #[schemars(range(min = -1e9, max = 1e9), extend("x-unit" = "mm"))]
        first: f64,
        /// Amplitude along x2.
        #[schemars(range(min = -1e9, max = 1e9), extend("x-unit" = "mm"))]
        second: f64,
        /// Wave length.
        #[schemars(range(max = 1e9), extend("x-unit" = "mm", "exclusiveMinimum" = 0.0))]
        period: f64,
    },
    /// Heights on a uniform grid over the base, bilinear in between.
    Grid {
        /// CSV file beside the scene file: one line per x1, one column per x2, both edges included; mm. Lines that
        /// begin with # are comments.
        file: String,
    },
    /// Control heights one by one.
    Controls {
        /// Row major, index i*n2 + j with i along x1.
        #[schemars(inner(range(max = 1e9)), extend("x-unit" = "mm"))]
        heights: Vec<f64>,
    },
}

/// Bounds of the control heights.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct AdmissibleSection {
    /// Smallest control height.
    #[schemars(range(max = 1e9), extend("x-unit" = "mm", "exclusiveMinimum" = 0.0))]
    pub minimum_height: f64,
    /// Largest slope between neighbouring controls.
    #[schemars(range(max = 1e9), extend("x-unit" = "1", "exclusiveMinimum" = 0.0))]
    pub slope: f64,
    /// Smallest and largest volume of the body.
    #[schemars(inner(range(min = 0.0, max = 1e27)), extend("x-unit" = "mm³"))]
    pub volume: [f64; 2],
}

fn six_by_six() -> [usize; 2] {
    [6, 6]
}
