//! The contact of a scene: what touches what, along which normals, over which areas, with which friction.

pub use crate::body::elasticity::facet::AreaKind;
use crate::scene::CounterSurface;
use serde::{Deserialize, Serialize};

/// Along which normals contact acts.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema), schemars(rename = "NormalName", transform = crate::schema::names_only))]
pub enum NormalKind {
    /// The normal of an obstacle at the point nearest to the contact node; between two bodies, the mean of the normals
    /// of the slave facets about the node, weighted by their areas.
    #[default]
    Surface,
    /// The axis x₃, as in the paper; gaps are measured along it.
    X3,
}

/// A face of a body.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct BodyFace {
    /// The body, by its place among those of the scene.
    pub body: usize,
    /// Name of the face.
    pub face: String,
}

impl BodyFace {
    /// A face of the body at a place among those of the scene.
    pub fn new(body: usize, face: impl Into<String>) -> Self {
        Self { body, face: face.into() }
    }
}

/// What a slave face may touch, or is tied to.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub enum Master {
    /// A rigid obstacle.
    Obstacle(CounterSurface),
    /// A face of another body, whose mesh need not match.
    Body(BodyFace),
}

/// How the two sides of a contact act on each other.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub enum ContactKind {
    /// They may touch, slide and part: unilateral contact with Coulomb friction.
    #[default]
    Unilateral,
    /// They are glued as they lie: no jump of the displacement.
    Tied,
}

/// Two faces that may touch, and how contact is measured there. Contact nodes lie on the slave face.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ContactScene {
    /// The face with the contact nodes.
    pub slave: BodyFace,
    /// What it may touch.
    pub master: Master,
    /// Whether the sides may part.
    pub kind: ContactKind,
    /// Along which normals contact acts.
    pub normal: NormalKind,
    /// How tributary areas are measured on an obstacle; between bodies, areas are those of the mortar integrals.
    pub area: AreaKind,
    /// Coulomb friction coefficient 𝓕.
    pub friction: f64,
    /// Other friction coefficients by the names of faces or node sets of the slave body.
    pub friction_by_region: Vec<(String, f64)>,
    /// How far the bodies are pressed into each other before loading, along the normals of the contact nodes, mm: every
    /// gap is smaller by it. Negative: a clearance.
    pub interference: f64,
    /// The gap at the start, mm, whatever the meshes say: later changes of the shape count. Negative: the bodies
    /// overlap by it. None: the faces tell the gaps. Between bodies only, and not with an interference.
    pub clearance: Option<f64>,
    /// Which surfaces the gaps between two bodies are measured between.
    pub geometry: FaceGeometry,
}

/// What lies between the nodes of faces of two bodies.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema), schemars(transform = crate::schema::names_only))]
pub enum FaceGeometry {
    /// Surfaces of second degree through the middle nodes of the file, on a plane, cylinder, cone or sphere that all
    /// nodes lie on, or from normals fitted to the nodes around.
    #[default]
    Curved,
    /// The flat facets of the meshes, for comparison.
    Facets,
}

impl ContactScene {
    /// A contact with the true normals of its surfaces.
    pub fn new(slave: BodyFace, master: Master, friction: f64) -> Self {
        Self {
            slave,
            master,
            kind: ContactKind::Unilateral,
            normal: NormalKind::Surface,
            area: AreaKind::Surface,
            friction,
            friction_by_region: Vec::new(),
            interference: 0.0,
            clearance: None,
            geometry: FaceGeometry::Curved,
        }
    }

    /// The contact of the paper's scenes: normal along x₃, areas of the projected grid.
    pub fn along_x3(slave: BodyFace, master: Master, friction: f64) -> Self {
        Self { normal: NormalKind::X3, area: AreaKind::Projected, ..Self::new(slave, master, friction) }
    }

    /// Two faces that are glued as they lie.
    pub fn tied(slave: BodyFace, master: BodyFace) -> Self {
        Self { kind: ContactKind::Tied, ..Self::new(slave, Master::Body(master), 0.0) }
    }

    /// Whether the sides are glued.
    pub fn is_tied(&self) -> bool {
        self.kind == ContactKind::Tied
    }

    /// Whether any node has friction.
    pub fn has_friction(&self) -> bool {
        self.friction > 0.0 || self.friction_by_region.iter().any(|(_, friction)| *friction > 0.0)
    }

    /// Its faces: the slave face, then the master face where there is one.
    pub fn faces(&self) -> impl Iterator<Item = &BodyFace> {
        std::iter::once(&self.slave).chain(self.master_face())
    }

    /// The obstacle, where there is one.
    pub fn obstacle(&self) -> Option<&CounterSurface> {
        match &self.master {
            Master::Obstacle(surface) => Some(surface),
            Master::Body(_) => None,
        }
    }

    /// The face of the master body, where there is one.
    pub fn master_face(&self) -> Option<&BodyFace> {
        match &self.master {
            Master::Obstacle(_) => None,
            Master::Body(face) => Some(face),
        }
    }
}
