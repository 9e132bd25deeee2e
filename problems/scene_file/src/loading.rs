//! What a body of a scene file is made of, and what acts on it: materials, supports, loads.

use contact::body::elasticity::{Formulation, Material};
use contact::error::SceneError;
use contact::scene::{Held, Load, LoadKind, Support};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// An isotropic elastic material.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct MaterialSection {
    /// Young's modulus E.
    #[schemars(range(min = 1e-9, max = 1e15), extend("x-unit" = "MPa"))]
    pub young_modulus: f64,
    /// Poisson's ratio.
    #[schemars(extend("x-unit" = "1", "exclusiveMinimum" = -1.0, "exclusiveMaximum" = 0.5))]
    pub poisson_ratio: f64,
    /// Cells: `mean-dilatation` against locking of nearly incompressible materials.
    #[serde(default)]
    pub formulation: Formulation,
    /// Density, for masses.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(max = 1e15), extend("x-unit" = "kg/m³", "exclusiveMinimum" = 0.0))]
    pub density: Option<f64>,
}

/// Displacements prescribed on a face.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SupportSection {
    /// The face of a block, or a physical surface of a mesh.
    pub face: String,
    /// Displacement components that are prescribed there, along the axes or along the normal of the face at the start:
    /// zero unless a value is given. On a block, u3 only on the face opposite to the contact face.
    pub held: Vec<Component>,
    /// Values of u1, u2, u3 where they are held. Default 0. Where two supports share nodes, they must agree. With
    /// friction, no support may move nodes of the contact face.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(inner(range(min = -1e9, max = 1e9)), extend("x-unit" = "mm"))]
    pub displacement: Option<[f64; 3]>,
    /// Displacement along the outward normal where "normal" is held. Default 0.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = -1e9, max = 1e9), extend("x-unit" = "mm"))]
    pub normal_displacement: Option<f64>,
}

/// A load: one of traction, pressure, force with moment, and formula on a face, or a body force.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct LoadSection {
    /// The face of a load on a face, named as those of supports.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub face: Option<String>,
    /// The physical volume of a body force. Default the whole body.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub volume: Option<String>,
    /// Traction along x1, x2, x3.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(inner(range(min = -1e15, max = 1e15)), extend("x-unit" = "MPa"))]
    pub traction: Option<[f64; 3]>,
    /// Pressure against the outward normal.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = -1e15, max = 1e15), extend("x-unit" = "MPa"))]
    pub pressure: Option<f64>,
    /// Total force along x1, x2, x3, as a traction that is linear over the face.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(inner(range(min = -1e18, max = 1e18)), extend("x-unit" = "N"))]
    pub force: Option<[f64; 3]>,
    /// Moment about the point, besides the force or alone.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(inner(range(min = -1e21, max = 1e21)), extend("x-unit" = "N mm"))]
    pub moment: Option<[f64; 3]>,
    /// Where the force attacks, and what the moment refers to. Default the centroid of the face.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(inner(range(min = -1e9, max = 1e9)), extend("x-unit" = "mm"))]
    pub point: Option<[f64; 3]>,
    /// Traction along x1, x2, x3 in MPa as formulas in x1, x2, x3 in mm.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub formula: Option<[String; 3]>,
    /// Force per volume along x1, x2, x3.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(inner(range(min = -1e15, max = 1e15)), extend("x-unit" = "N/mm³"))]
    pub body_force: Option<[f64; 3]>,
}

/// A displacement component.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
#[allow(missing_docs, reason = "the names are the meaning")]
pub enum Component {
    U1,
    U2,
    U3,
    Normal,
}

/// An isotropic elastic material of a physical volume.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct VolumeMaterialSection {
    /// The physical volume.
    pub volume: String,
    /// Its elastic constants.
    #[serde(flatten)]
    pub material: MaterialSection,
}

/// A unit of length.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum UnitName {
    /// Millimetres.
    #[default]
    Mm,
    /// Centimetres.
    Cm,
    /// Metres.
    M,
    /// Inches of 25.4 mm.
    Inch,
}

impl UnitName {
    /// Its length in mm.
    pub fn millimetres(self) -> f64 {
        match self {
            Self::Mm => 1.0,
            Self::Cm => 10.0,
            Self::M => 1000.0,
            Self::Inch => 25.4,
        }
    }

    /// Its name in words.
    pub(crate) fn words(self) -> &'static str {
        match self {
            Self::Mm => "mm",
            Self::Cm => "cm",
            Self::M => "m",
            Self::Inch => "inches",
        }
    }
}

impl MaterialSection {
    pub(super) fn material(&self) -> Result<Material, SceneError> {
        let material = Material::new(self.young_modulus, self.poisson_ratio)?.with_formulation(self.formulation);
        self.density.map_or(Ok(material), |density| material.with_density(density))
    }
}

impl VolumeMaterialSection {
    pub(super) fn material(&self) -> Result<(String, Material), SceneError> {
        Ok((self.volume.clone(), self.material.material()?))
    }
}

/// The supports of the body at a place of the file.
pub(super) fn supports(at: &str, sections: &[SupportSection]) -> Result<Vec<Support>, SceneError> {
    let supports = sections.iter().enumerate();
    let supports = supports.map(|(index, section)| support(&format!("{at}.supports[{index}]"), section));
    Ok(supports.collect::<Result<Vec<_>, SceneError>>()?.concat())
}

/// The loads of the body at a place of the file.
pub(super) fn loads(at: &str, sections: &[LoadSection]) -> Result<Vec<Load>, SceneError> {
    let loads = sections.iter().enumerate();
    loads.map(|(index, section)| load(&format!("{at}.loads[{index}]"), section)).collect()
}

/// The supports of a section: one of components, one along the normal.
fn support(field: &str, section: &SupportSection) -> Result<Vec<Support>, SceneError> {
    const AXES: [Component; 3] = [Component::U1, Component::U2, Component::U3];
    let SupportSection { face, held, displacement, normal_displacement } = section;
    let holds = |component| held.contains(&component);
    let values = displacement.unwrap_or_default();
    let free = |axis: &usize| !holds(AXES[*axis]) && values[*axis] != 0.0;
    if let Some(axis) = (0..3).find(free) {
        let allowed = format!("0, or \"u{}\" among the held components", axis + 1);
        return Err(SceneError::out_of_range(format!("{field}.displacement[{axis}]"), values[axis], allowed));
    }
    let normal = normal_displacement.unwrap_or_default();
    if normal != 0.0 && !holds(Component::Normal) {
        let allowed = "0, or \"normal\" among the held components";
        return Err(SceneError::out_of_range(format!("{field}.normal_displacement"), normal, allowed));
    }
    let axes = AXES.map(holds);
    let components: [Option<f64>; 3] = std::array::from_fn(|axis| axes[axis].then_some(values[axis]));
    let along_axes = (axes.contains(&true) || !holds(Component::Normal)).then_some(Held::Components(components));
    let along_normal = holds(Component::Normal).then_some(Held::Normal(normal));
    let of = |held| Support { face: face.clone(), held };
    Ok(along_axes.into_iter().chain(along_normal).map(of).collect())
}

/// The load of a section.
fn load(field: &str, section: &LoadSection) -> Result<Load, SceneError> {
    let LoadSection { face, volume, traction, pressure, force, moment, point, formula, body_force } = section;
    let resultant = (force.is_some() || moment.is_some()).then(|| LoadKind::Resultant {
        force: force.unwrap_or_default(),
        moment: moment.unwrap_or_default(),
        point: *point,
    });
    let on_face = [
        traction.map(LoadKind::Traction),
        pressure.map(LoadKind::Pressure),
        resultant,
        formula.clone().map(LoadKind::Formula),
    ];
    let mut kinds: Vec<(LoadKind, bool)> = on_face.into_iter().flatten().map(|kind| (kind, true)).collect();
    kinds.extend(body_force.map(|force| (LoadKind::BodyForce(force), false)));
    let refused = |value: &str, allowed: &str| Err(SceneError::out_of_range(field, value, allowed));
    let (kind, needs_face) = match kinds.pop() {
        None => return refused("a load of no size", "one of traction, pressure, force, moment, formula, body_force"),
        Some(_) if !kinds.is_empty() => return refused("several loads", "one kind of load per entry"),
        Some(found) => found,
    };
    if point.is_some() && force.is_none() && moment.is_none() {
        return refused("a point", "a point with a force or a moment alone");
    }
    match (needs_face, face, volume) {
        (true, Some(face), None) => Ok(Load { place: Some(face.clone()), kind }),
        (true, None, _) => refused("a load without a face", "the face that it acts on"),
        (true, Some(_), Some(_)) => refused("a volume", "a volume with a body force alone"),
        (false, None, volume) => Ok(Load { place: volume.clone(), kind }),
        (false, Some(_), _) => refused("a face", "a volume, or none, with a body force"),
    }
}
