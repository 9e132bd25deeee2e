//! Bodies of a scene file: material, supports, loads.

use contact::body::elasticity::{Formulation, Material};
use contact::body::mesh::Face;
use contact::error::SceneError;
use contact::scene::{BodyScene, Load, Support};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A body.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct BodySection {
    /// Elastic constants.
    pub material: MaterialSection,
    /// Held faces; never the contact boundary.
    #[serde(default)]
    pub supports: Vec<SupportSection>,
    /// Loaded faces; never the contact boundary.
    #[serde(default)]
    pub loads: Vec<LoadSection>,
}

/// The upper body.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct UpperSection {
    /// Height of its flat top; must lie above the counter surface.
    #[schemars(range(min = -1e9, max = 1e9), extend("x-unit" = "mm"))]
    pub top: f64,
    /// Elastic constants.
    pub material: MaterialSection,
    /// Held faces; never the contact boundary.
    #[serde(default)]
    pub supports: Vec<SupportSection>,
    /// Loaded faces; never the contact boundary.
    #[serde(default)]
    pub loads: Vec<LoadSection>,
}

/// An isotropic elastic material.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct MaterialSection {
    /// Young's modulus E.
    #[schemars(range(min = 1e-9, max = 1e15), extend("x-unit" = "MPa"))]
    pub young_modulus: f64,
    /// Poisson's ratio.
    #[schemars(extend("x-unit" = "1", "exclusiveMinimum" = -1.0, "exclusiveMaximum" = 0.5))]
    pub poisson_ratio: f64,
    /// Bricks: `mean-dilatation` against locking of nearly incompressible materials.
    #[serde(default)]
    pub formulation: Formulation,
}

/// Displacements held at zero on a face.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SupportSection {
    /// The face.
    pub face: Face,
    /// Displacement components that are zero there; u3 only on the face opposite to the contact boundary.
    pub held: Vec<Component>,
}

/// A constant traction on a face.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct LoadSection {
    /// The face.
    pub face: Face,
    /// Traction along x1, x2, x3.
    #[schemars(inner(range(min = -1e15, max = 1e15)), extend("x-unit" = "MPa"))]
    pub traction: [f64; 3],
}

/// A displacement component.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
#[allow(missing_docs, reason = "the names are the meaning")]
pub enum Component {
    U1,
    U2,
    U3,
}

/// The body of a scene.
///
/// # Errors
/// [`SceneError`] for elastic constants outside their range.
pub(super) fn body(
    material: &MaterialSection,
    supports: &[SupportSection],
    loads: &[LoadSection],
) -> Result<BodyScene, SceneError> {
    let support = |section: &SupportSection| Support {
        face: section.face,
        components: [Component::U1, Component::U2, Component::U3].map(|component| section.held.contains(&component)),
    };
    Ok(BodyScene {
        material: Material::new(material.young_modulus, material.poisson_ratio)?.with_formulation(material.formulation),
        supports: supports.iter().map(support).collect(),
        loads: loads.iter().map(|load| Load { face: load.face, traction: load.traction }).collect(),
    })
}
