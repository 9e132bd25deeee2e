//! Bodies of a scene file: blocks of bricks and meshes.

use crate::{
    LatticeSection, LoadSection, MaterialSection, ObstacleSection, SupportSection, UnitName, VolumeMaterialSection,
};
use contact::error::SceneError;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// An elastic body: a block of bricks, or a mesh from a Gmsh file (4.1 or 2.2, text or binary) of hexahedra of 8 nodes
/// or tetrahedra of 4 or 10 nodes.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct BodySection {
    /// Its name. Default "body" for the only one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub name: Option<String>,
    /// A block of bricks, in place of a mesh.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub block: Option<BlockSection>,
    /// A Gmsh file beside the scene file, in place of a block. Physical surfaces name faces, physical volumes parts,
    /// physical points and curves sets of nodes.
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
    /// Held faces; never a contact face of a block.
    #[serde(default)]
    pub supports: Vec<SupportSection>,
    /// The loads; none on a contact face of a block.
    #[serde(default)]
    pub loads: Vec<LoadSection>,
    /// The shape that is optimized. Default none: the body keeps its shape.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub lattice: Option<LatticeSection>,
}

/// A block of bricks over a rectangle, with the faces x1-min, x1-max, x2-min, x2-max, bottom, top.
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
    #[serde(default = "twelve")]
    #[schemars(inner(range(min = 1, max = 400)), extend("x-unit" = "1"))]
    pub bricks: [usize; 3],
    /// Subdomains along x1, x2, x3; divisors of the bricks. Default 2, or the divisor that leaves closest to 6 bricks.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(inner(range(min = 1, max = 400)), extend("x-unit" = "1"))]
    pub subdomains: Option<[usize; 3]>,
    /// Heights of its bottom. Default the plane x3 = 0; none where the lattice shapes it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub bottom: Option<ObstacleSection>,
    /// Heights of its top. Required unless the lattice shapes it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub top: Option<ObstacleSection>,
}

fn twelve() -> [usize; 3] {
    [12; 3]
}

impl BodySection {
    /// The name of the body in a list of so many; `at`: its place in the file.
    ///
    /// # Errors
    /// [`SceneError::OutOfRange`] for one of several without a name.
    pub(crate) fn name(&self, at: &str, count: usize) -> Result<String, SceneError> {
        match &self.name {
            Some(name) => Ok(name.clone()),
            None if count == 1 => Ok("body".into()),
            None => Err(SceneError::out_of_range(format!("{at}.name"), "missing", "a name for each of several bodies")),
        }
    }
}

/// 2 subdomains per edge, or, where 2 does not divide the bricks, the divisor that leaves closest to six bricks.
pub fn default_subdomains(bricks: usize) -> usize {
    if bricks.is_multiple_of(2) {
        return 2;
    }
    let divisors = (1..=bricks).filter(|count| bricks.is_multiple_of(*count));
    let distance = |count: &usize| {
        let bricks = (bricks / count) as f64 / 6.0;
        bricks.max(1.0 / bricks)
    };
    divisors.min_by(|a, b| distance(a).total_cmp(&distance(b))).unwrap_or(1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tearing_of_meshes_that_two_does_not_divide() {
        assert_eq!([12, 35, 25, 9, 7, 13, 1].map(default_subdomains), [2, 5, 5, 1, 1, 1, 1]);
    }
}
