//! Surfaces of a scene file: obstacles, faces of blocks, heights at the start.

use crate::{FILES, UnitName};
use contact::scene::Side;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::path::Path;

/// A rigid obstacle, the heights of a face of a block, or those that a shape starts from. The forms from "tilted-plane"
/// on lie anywhere in space, and are obstacles only.
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
        /// Its corner of least x1 and x2. Default that of the block.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        #[schemars(inner(range(min = -1e9, max = 1e9)), extend("x-unit" = "mm"))]
        origin: Option<[f64; 2]>,
        /// Its lengths along x1, x2; required for a mesh. Default those of the block.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        #[schemars(inner(range(min = 1e-9, max = 1e9)), extend("x-unit" = "mm"))]
        size: Option<[f64; 2]>,
    },
    /// A plane.
    TiltedPlane {
        /// One of its points.
        #[schemars(inner(range(min = -1e9, max = 1e9)), extend("x-unit" = "mm"))]
        point: [f64; 3],
        /// Its normal from the body into the obstacle, of any length.
        #[schemars(inner(range(min = -1e9, max = 1e9)), extend("x-unit" = "1"))]
        normal: [f64; 3],
    },
    /// A sphere.
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
    /// A circular cylinder without ends.
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
    /// A cone, as far as its apex.
    Cone {
        /// A point of its axis.
        #[schemars(inner(range(min = -1e12, max = 1e12)), extend("x-unit" = "mm"))]
        point: [f64; 3],
        /// Direction of its axis, along which its radius grows, of any length.
        #[schemars(inner(range(min = -1e9, max = 1e9)), extend("x-unit" = "1"))]
        axis: [f64; 3],
        /// Radius at the point.
        #[schemars(range(max = 1e12), extend("x-unit" = "mm", "exclusiveMinimum" = 0.0))]
        radius: f64,
        /// Angle between the axis and the surface.
        #[schemars(extend("x-unit" = "degree", "exclusiveMinimum" = 0.0, "exclusiveMaximum" = 90.0))]
        half_angle: f64,
        /// Where the body is: inside for a seat.
        #[serde(default)]
        side: Side,
    },
    /// A torus: a circle that turns about an axis.
    Torus {
        /// Its centre.
        #[schemars(inner(range(min = -1e12, max = 1e12)), extend("x-unit" = "mm"))]
        centre: [f64; 3],
        /// Direction of its axis, of any length.
        #[schemars(inner(range(min = -1e9, max = 1e9)), extend("x-unit" = "1"))]
        axis: [f64; 3],
        /// From the axis to the centre of the circle; negative for a barrel.
        #[schemars(range(min = -1e12, max = 1e12), extend("x-unit" = "mm"))]
        major_radius: f64,
        /// Radius of the circle.
        #[schemars(range(max = 1e12), extend("x-unit" = "mm", "exclusiveMinimum" = 0.0))]
        minor_radius: f64,
        /// Where the body is: inside for a groove.
        #[serde(default)]
        side: Side,
    },
    /// A surface of revolution.
    Revolution {
        /// CSV file beside the scene file: radius and height of a point of the profile per line, in the order of the
        /// curve; mm.
        file: String,
        /// The point of the axis where the height is zero.
        #[schemars(inner(range(min = -1e12, max = 1e12)), extend("x-unit" = "mm"))]
        point: [f64; 3],
        /// Direction of its axis, along which heights grow, of any length.
        #[schemars(inner(range(min = -1e9, max = 1e9)), extend("x-unit" = "1"))]
        axis: [f64; 3],
        /// Where the body is: outside is away from the axis, or outside of a closed profile.
        #[serde(default)]
        side: Side,
    },
    /// A face of a mesh.
    Mesh {
        /// Gmsh or STL file beside the scene file.
        file: String,
        /// The face in a Gmsh file; an STL file is one face.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        face: Option<String>,
        /// The unit of lengths in the file.
        #[serde(default)]
        unit: UnitName,
        /// Where the body is: outside where the normals of the facets point, outwards from cells or, without cells, by
        /// the order of the corners.
        #[serde(default)]
        side: Side,
    },
}

impl ObstacleSection {
    /// The file that holds its numbers, and the name that a copy of it has.
    pub(crate) fn file_mut(&mut self) -> Option<(&'static str, &mut String)> {
        let [_, mesh, triangles, ..] = FILES;
        match self {
            Self::Grid { file, .. } | Self::Revolution { file, .. } => Some((FILES[0], file)),
            Self::Mesh { file, .. } => Some((if is_stl(Path::new(file)) { triangles } else { mesh }, file)),
            _ => None,
        }
    }
}

/// Whether a file is one of triangles by its name.
pub(crate) fn is_stl(file: &Path) -> bool {
    file.extension().is_some_and(|end| end.eq_ignore_ascii_case("stl"))
}
