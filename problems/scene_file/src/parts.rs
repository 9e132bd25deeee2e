//! Bodies and contacts of a scene of any number of bodies.

use crate::{
    AdmissibleSection, CounterSection, FrictionSection, LatticeSection, LoadSection, MaterialSection, SupportSection,
    SurfaceSection, UnitName, VolumeMaterialSection,
};
use contact::scene::{AreaKind, FaceGeometry, NormalKind};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// One of the bodies: a block of bricks or a mesh.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PartSection {
    /// Its name, by which contacts, load cases and regions refer to it.
    pub name: String,
    /// A block of bricks, in place of a mesh.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub block: Option<BlockSection>,
    /// A Gmsh file beside the scene file, in place of a block. Default none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub mesh: Option<String>,
    /// Unit of lengths in the mesh file.
    #[serde(default)]
    pub unit: UnitName,
    /// Pieces into which total FETI divides the mesh, about. Default one per 512 hexahedra or 400 tetrahedra.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 1, max = 1_000_000), extend("x-unit" = "1"))]
    pub pieces: Option<usize>,
    /// Elastic constants of all volumes without others.
    pub material: MaterialSection,
    /// Elastic constants of physical volumes.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub materials: Vec<VolumeMaterialSection>,
    /// Held faces.
    #[serde(default)]
    pub supports: Vec<SupportSection>,
    /// The loads.
    #[serde(default)]
    pub loads: Vec<LoadSection>,
    /// The optimized surface of a block. Default none: its faces keep their shape.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub surface: Option<SurfaceSection>,
    /// Bounds of the surface of a block.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub admissible: Option<AdmissibleSection>,
    /// The shapes of a mesh, or of a block without surface. Default none: it keeps its shape.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub lattice: Option<LatticeSection>,
}

/// A block of bricks over a rectangle, with the faces x1-min, x1-max, x2-min, x2-max, bottom and top.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct BlockSection {
    /// Least x1 and x2 of its base. Default [0, 0].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(inner(range(min = -1e9, max = 1e9)), extend("x-unit" = "mm"))]
    pub corner: Option<[f64; 2]>,
    /// Lengths of its base along x1, x2.
    #[schemars(inner(range(min = 1e-9, max = 1e9)), extend("x-unit" = "mm"))]
    pub size: [f64; 2],
    /// Bricks along x1, x2, x3.
    #[schemars(inner(range(min = 1, max = 400)), extend("x-unit" = "1"))]
    pub bricks: [usize; 3],
    /// Subdomains along x1, x2, x3; divisors of the bricks. Default 2 per edge, or, where 2 does not divide the bricks,
    /// the divisor that leaves closest to 6 bricks.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(inner(range(min = 1, max = 400)), extend("x-unit" = "1"))]
    pub subdomains: Option<[usize; 3]>,
    /// Heights of its bottom. Default the plane x3 = 0; none where the surface shapes it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub bottom: Option<CounterSection>,
    /// Heights of its top. Required unless the surface shapes it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub top: Option<CounterSection>,
}

/// A face of a body.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct FaceSection {
    /// Name of the body.
    pub body: String,
    /// Name of its face.
    pub face: String,
}

/// Two faces that may touch or are glued, or a face and a rigid obstacle: slave and master, faces, or slave and
/// obstacle. Contact nodes, pressures and gaps belong to the slave.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct PairSection {
    /// The slave face. Default chosen among faces.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub slave: Option<FaceSection>,
    /// The master face, on another body.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub master: Option<FaceSection>,
    /// Two faces in place of slave and master: the slave is the face with the smaller product of Young's modulus and
    /// mean width of the facets, the softer and finer side.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub faces: Option<[FaceSection; 2]>,
    /// A rigid obstacle in place of a master face.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub obstacle: Option<CounterSection>,
    /// Whether the faces are glued as they lie, so that they neither slide nor part.
    pub tied: bool,
    /// Coulomb friction coefficient. Default that of the scene; none between glued faces.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0.0, max = 1e6), extend("x-unit" = "1"))]
    pub friction: Option<f64>,
    /// Along which normals contact acts: those of the obstacle or the averaged ones of the slave face, or x3 as in the
    /// paper.
    pub normal: NormalKind,
    /// How areas on an obstacle are measured. Default "projected" with normal = "x3", else "surface"; between bodies
    /// the mortar integrals measure them.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub area: Option<AreaKind>,
    /// How far the sides are pressed into each other before loading: every gap is smaller by it. Negative: a clearance.
    /// Default 0.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = -1e9, max = 1e9), extend("x-unit" = "mm"))]
    pub interference: Option<f64>,
    /// The gap at the start between two bodies, whatever their meshes say: later changes of the shape count. Negative:
    /// an interference. Default: the faces tell the gaps. Not with interference.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = -1e9, max = 1e9), extend("x-unit" = "mm"))]
    pub clearance: Option<f64>,
    /// What gaps between two bodies are measured between: "curved" surfaces, or the flat "facets" of the meshes for
    /// comparison.
    pub geometry: FaceGeometry,
    /// Other friction coefficients on parts of the slave face.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub regions: Vec<FrictionSection>,
}
