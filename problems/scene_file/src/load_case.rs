//! Load cases of a scene file: what of the scene is different in each.

use crate::bodies::{BodySection, LoadSection, MaterialSection, MeshBodySection, SupportSection, UpperSection};
use crate::{SceneFile, bodies};
use contact::error::SceneError;
use contact::load_cases::Over;
use contact::scene::{BodyScene, Scene};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A load case: its name, and what differs from the scene. Cases are independent states under one loading each, not a
/// history; each begins with bodies at rest.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct CaseSection {
    /// Its name, different from those of the other cases.
    pub name: String,
    /// The factor of its measure in the objective, and in that only. Default 1.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(max = 1e15), extend("x-unit" = "1", "exclusiveMinimum" = 0.0))]
    pub weight: Option<f64>,
    /// The factor of all loads, those of the case included; prescribed displacements stay. Default 1.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = -1e15, max = 1e15), extend("x-unit" = "1"))]
    pub load_factor: Option<f64>,
    /// Coulomb friction coefficient. Default that of the scene.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0.0, max = 1e6), extend("x-unit" = "1"))]
    pub friction: Option<f64>,
    /// Interference, in place of that of the scene.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = -1e9, max = 1e9), extend("x-unit" = "mm"))]
    pub interference: Option<f64>,
    /// By how much the counter surface is moved along x1, x2, x3, and the top of an upper body with it along x3.
    /// Default not at all.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(inner(range(min = -1e9, max = 1e9)), extend("x-unit" = "mm"))]
    pub offset: Option<[f64; 3]>,
    /// What differs at the lower block.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub lower: Option<CaseBodySection>,
    /// What differs at the upper block.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub upper: Option<CaseBodySection>,
    /// What differs at the body of a mesh.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub body: Option<CaseBodySection>,
}

/// A body in a load case: what is given replaces that of the scene.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct CaseBodySection {
    /// Elastic constants. Default those of the scene.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub material: Option<MaterialSection>,
    /// Held faces, all of them. Default those of the scene.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub supports: Option<Vec<SupportSection>>,
    /// The loads, all of them. Default those of the scene.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub loads: Option<Vec<LoadSection>>,
}

/// A load case as a scene of its own.
#[derive(Debug, Clone, PartialEq)]
pub struct CaseScene {
    /// Its name; empty for a scene without cases.
    pub name: String,
    /// Names of further cases that are equal to it and solved with it.
    pub equal: Vec<String>,
    /// Its weight in the objective; that of all equal cases together.
    pub weight: f64,
    /// The scene with its loads.
    pub scene: Scene,
}

impl CaseSection {
    /// The scene of the case, by its number in the file.
    fn scene(&self, index: usize, file: &SceneFile, base: &Scene) -> Result<Scene, SceneError> {
        let mut scene = base.clone();
        let place = |name: &str| format!("case[{index}].{name}");
        let MeshOr { lower, name } = MeshOr::of(file);
        let refused = |field: &str| Err(SceneError::out_of_range(place(field), "a table", "only a body of the scene"));
        match (&self.lower, &self.body, name) {
            (Some(_), _, "body") => return refused("lower"),
            (_, Some(_), "lower") => return refused("body"),
            (own, other, _) => {
                if let (Some(own), Some(base)) = (own.as_ref().or(other.as_ref()), lower) {
                    scene.lower = own.of_scene(&place(name), base, &scene.lower)?;
                }
            }
        }
        match (&self.upper, &file.upper, &mut scene.upper) {
            (Some(own), Some(base), Some(upper)) => {
                upper.body = own.of_scene(&place("upper"), Given::upper(base), &upper.body)?;
            }
            (Some(_), _, _) => return refused("upper"),
            (None, _, _) => {}
        }
        if let Some(factor) = self.load_factor {
            for body in scene.bodies_mut() {
                body.loads = body.loads.iter().map(|load| load.scaled(factor)).collect();
            }
        }
        if let Some(friction) = self.friction {
            scene.contact.friction = friction;
        }
        if let Some(interference) = self.interference {
            scene.contact.interference = interference;
        }
        if let Some(offset) = self.offset {
            scene.counter_surface = scene.counter_surface.moved(offset);
            if let Some(upper) = &mut scene.upper {
                upper.top += offset[2];
            }
        }
        let within = |source| SceneError::InFile { file: format!("case \"{}\"", self.name), source: Box::new(source) };
        scene.validate().map_err(within)?;
        Ok(scene)
    }
}

/// A body of a file as a case changes it.
struct Given<'a> {
    material: &'a MaterialSection,
    supports: &'a [SupportSection],
    loads: &'a [LoadSection],
}

impl<'a> Given<'a> {
    fn lower(section: &'a BodySection) -> Self {
        Self { material: &section.material, supports: &section.supports, loads: &section.loads }
    }

    fn upper(section: &'a UpperSection) -> Self {
        Self { material: &section.material, supports: &section.supports, loads: &section.loads }
    }

    fn mesh(section: &'a MeshBodySection) -> Self {
        Self { material: &section.material, supports: &section.supports, loads: &section.loads }
    }
}

/// The shaped body of a file, with what its table is called.
struct MeshOr<'a> {
    lower: Option<Given<'a>>,
    name: &'static str,
}

impl<'a> MeshOr<'a> {
    fn of(file: &'a SceneFile) -> Self {
        match &file.body {
            Some(body) => Self { lower: Some(Given::mesh(body)), name: "body" },
            None => Self { lower: file.lower.as_ref().map(Given::lower), name: "lower" },
        }
    }
}

impl CaseBodySection {
    /// The body of a case, from what the file says of it and what it is in the scene.
    fn of_scene(&self, name: &str, given: Given<'_>, base: &BodyScene) -> Result<BodyScene, SceneError> {
        if *self == Self::default() {
            return Err(SceneError::out_of_range(name, "an empty table", "material, supports or loads of the case"));
        }
        let material = self.material.as_ref().unwrap_or(given.material);
        let supports = self.supports.as_deref().unwrap_or(given.supports);
        let loads = self.loads.as_deref().unwrap_or(given.loads);
        Ok(BodyScene { materials: base.materials.clone(), ..bodies::body(name, material, supports, loads)? })
    }
}

/// The cases of a file; the scene itself where it has none. Cases that are equal but for name and weight become one.
///
/// # Errors
/// [`SceneError`] for a name that is empty or taken, and for fields as in a scene.
pub(crate) fn cases(file: &SceneFile, base: &Scene) -> Result<Vec<CaseScene>, SceneError> {
    if file.case.is_empty() {
        return Ok(vec![CaseScene { name: String::new(), equal: vec![], weight: 1.0, scene: base.clone() }]);
    }
    let mut cases: Vec<CaseScene> = Vec::new();
    for (index, section) in file.case.iter().enumerate() {
        let name = section.name.trim();
        let refused = |allowed: &str| {
            Err(SceneError::out_of_range(format!("case[{index}].name"), format!("\"{}\"", section.name), allowed))
        };
        if name.is_empty() {
            return refused("a name");
        }
        if file.case[..index].iter().any(|other| other.name.trim() == name) {
            return refused("a name that no other case has");
        }
        let (scene, weight) = (section.scene(index, file, base)?, section.weight.unwrap_or(1.0));
        match cases.iter_mut().find(|case| case.scene == scene) {
            Some(known) => {
                known.equal.push(name.to_owned());
                known.weight = match file.objective.over {
                    Over::Worst => known.weight.max(weight),
                    Over::Sum => known.weight + weight,
                };
            }
            None => cases.push(CaseScene { name: name.to_owned(), equal: vec![], weight, scene }),
        }
    }
    Ok(cases)
}
