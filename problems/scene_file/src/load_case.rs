//! Load cases of a scene file: what of the scene is different in each.

use crate::SceneFile;
use crate::loading::{self, LoadSection, MaterialSection, SupportSection};
use crate::lookup::body_number;
use contact::error::SceneError;
use contact::load_cases::Over;
use contact::scene::{BodyScene, Master, Scene};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A load case: its name, and what differs from the scene. Cases are independent states, not a history.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct CaseSection {
    /// Its name, different from those of the other cases.
    pub name: String,
    /// Its factor in the objective. Default 1.
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
    /// By how much obstacles are moved along x1, x2, x3. Default not at all.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(inner(range(min = -1e9, max = 1e9)), extend("x-unit" = "mm"))]
    pub offset: Option<[f64; 3]>,
    /// What differs at bodies.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub body: Vec<CaseBodySection>,
}

/// A body in a load case: what is given replaces that of the scene.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct CaseBodySection {
    /// The body. Default the only one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub name: Option<String>,
    /// Elastic constants. Default those of the scene.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub material: Option<MaterialSection>,
    /// Held faces, all of them. Default those of the scene.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub supports: Option<Vec<SupportSection>>,
    /// The loads, all of them. Default those of the scene.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub loads: Option<Vec<LoadSection>>,
    /// By how much the body is moved along x1, x2, x3. Default not at all.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(inner(range(min = -1e9, max = 1e9)), extend("x-unit" = "mm"))]
    pub offset: Option<[f64; 3]>,
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

impl CaseBodySection {
    /// Changes a body of the scene; `at`: the place of the section in the file.
    fn apply(&self, at: &str, body: &mut BodyScene) -> Result<(), SceneError> {
        let Self { material, supports, loads, offset, .. } = self;
        if material.is_none() && supports.is_none() && loads.is_none() && offset.is_none() {
            let allowed = "material, supports, loads or offset of the case";
            return Err(SceneError::out_of_range(at, "an empty table", allowed));
        }
        if let Some(material) = material {
            body.material = material.material()?;
        }
        if let Some(supports) = supports {
            body.supports = loading::supports(at, supports)?;
        }
        if let Some(loads) = loads {
            body.loads = loading::loads(at, loads)?;
        }
        if let Some(offset) = *offset {
            *body = body.clone().moved(offset)?;
        }
        Ok(())
    }
}

impl CaseSection {
    /// The scene of the case, by its number in the file.
    fn scene(&self, index: usize, base: &Scene) -> Result<Scene, SceneError> {
        let mut scene = base.clone();
        for (number, section) in self.body.iter().enumerate() {
            let at = format!("case[{index}].body[{number}]");
            let body = body_number(&format!("{at}.name"), section.name.as_ref(), &scene.bodies)?;
            section.apply(&at, &mut scene.bodies[body])?;
        }
        if let Some(factor) = self.load_factor {
            for body in &mut scene.bodies {
                body.loads = body.loads.iter().map(|load| load.scaled(factor)).collect();
            }
        }
        for contact in scene.contacts.iter_mut().filter(|contact| !contact.is_tied()) {
            contact.friction = self.friction.unwrap_or(contact.friction);
            contact.interference = self.interference.unwrap_or(contact.interference);
        }
        if let Some(offset) = self.offset {
            for contact in &mut scene.contacts {
                if let Master::Obstacle(surface) = &mut contact.master {
                    *surface = surface.moved(offset);
                }
            }
        }
        let within = |source| SceneError::InFile { file: format!("case \"{}\"", self.name), source: Box::new(source) };
        scene.validate().map_err(within)?;
        Ok(scene)
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
        let (scene, weight) = (section.scene(index, base)?, section.weight.unwrap_or(1.0));
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
