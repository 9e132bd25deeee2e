//! Supports and loads of a body.

use serde::{Deserialize, Serialize};

/// What a support prescribes at the nodes of its face.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub enum Held {
    /// The values of u₁, u₂, u₃, mm; none where a component is free.
    Components([Option<f64>; 3]),
    /// The displacement along the outward normal of the face at the reference shape, mm.
    Normal(f64),
}

/// Displacements prescribed on a face of a body.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Support {
    /// Name of the face.
    pub face: String,
    /// What is held there.
    pub held: Held,
}

impl Support {
    /// Some components held at zero on a face.
    pub fn new(face: impl Into<String>, components: [bool; 3]) -> Self {
        Self { face: face.into(), held: Held::Components(components.map(|held| held.then_some(0.0))) }
    }

    /// The displacement along the normals of a face held at zero.
    pub fn along_normal(face: impl Into<String>) -> Self {
        Self { face: face.into(), held: Held::Normal(0.0) }
    }
}

/// A load on a body.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Load {
    /// Name of the face, or of the volume of a body force; none for all volumes.
    pub place: Option<String>,
    /// What acts there.
    pub kind: LoadKind,
}

/// What acts on a face or in a volume.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub enum LoadKind {
    /// A constant force per area along the axes, MPa.
    Traction([f64; 3]),
    /// A pressure on the face, MPa; against its outward normal.
    Pressure(f64),
    /// A force (N) at a point, and a moment (N·mm) besides, as a traction over the face that is linear in the position:
    /// t = F/A + ω × (x − c), c the centroid. The point is the centroid if none is given.
    Resultant {
        /// Total force along the axes, N.
        force: [f64; 3],
        /// Moment about the point, N·mm.
        moment: [f64; 3],
        /// Point of attack, mm.
        point: Option<[f64; 3]>,
    },
    /// A force per area along the axes as formulas in x1, x2, x3 (mm), MPa.
    Formula([String; 3]),
    /// A force per volume along the axes, N/mm³.
    BodyForce([f64; 3]),
}

impl Load {
    /// A constant traction on a face, MPa.
    pub fn traction(face: impl Into<String>, traction: [f64; 3]) -> Self {
        Self { place: Some(face.into()), kind: LoadKind::Traction(traction) }
    }

    /// The load times a factor.
    #[must_use]
    pub fn scaled(&self, factor: f64) -> Self {
        let vector = |vector: [f64; 3]| vector.map(|x| factor * x);
        let kind = match &self.kind {
            LoadKind::Traction(traction) => LoadKind::Traction(vector(*traction)),
            LoadKind::Pressure(pressure) => LoadKind::Pressure(factor * pressure),
            LoadKind::Resultant { force, moment, point } => {
                LoadKind::Resultant { force: vector(*force), moment: vector(*moment), point: *point }
            }
            LoadKind::Formula(texts) => LoadKind::Formula(texts.clone().map(|text| format!("{factor:?}*({text})"))),
            LoadKind::BodyForce(force) => LoadKind::BodyForce(vector(*force)),
        };
        Self { place: self.place.clone(), kind }
    }
}
