//! Load cases of a scene file: what of the scene is different in each.

use crate::bodies::{LoadSection, MaterialSection, SupportSection};
use crate::either::Either;
use crate::short_form::named;
use crate::{SceneFile, bodies};
use contact::error::SceneError;
use contact::load_cases::Over;
use contact::names::find;
use contact::scene::{BodyScene, Geometry, Master, Scene};
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
    /// By how much obstacles are moved along x1, x2, x3; in the short form, the counter surface, and the top of an
    /// upper body with it along x3. Default not at all.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(inner(range(min = -1e9, max = 1e9)), extend("x-unit" = "mm"))]
    pub offset: Option<[f64; 3]>,
    /// What differs at the lower block.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub lower: Option<CaseBodySection>,
    /// What differs at the upper block.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub upper: Option<CaseBodySection>,
    /// What differs at the body of a mesh; or, as a list, at bodies by their names.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub body: Option<Either<CaseBodySection, CasePartSection>>,
}

/// One of several bodies in a load case: what is given replaces that of the scene.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct CasePartSection {
    /// The body.
    pub name: String,
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

/// What a case says of a body.
#[derive(Debug, Clone, Copy, Default)]
struct Changed<'a> {
    material: Option<&'a MaterialSection>,
    supports: Option<&'a [SupportSection]>,
    loads: Option<&'a [LoadSection]>,
    offset: Option<[f64; 3]>,
}

impl<'a> Changed<'a> {
    fn of(section: &'a CaseBodySection) -> Self {
        let CaseBodySection { material, supports, loads } = section;
        let (supports, loads) = (supports.as_deref(), loads.as_deref());
        Self { material: material.as_ref(), supports, loads, offset: None }
    }

    fn of_part(section: &'a CasePartSection) -> Self {
        let CasePartSection { material, supports, loads, offset, .. } = section;
        let (supports, loads) = (supports.as_deref(), loads.as_deref());
        Self { material: material.as_ref(), supports, loads, offset: *offset }
    }

    fn is_empty(&self) -> bool {
        self.material.is_none() && self.supports.is_none() && self.loads.is_none() && self.offset.is_none()
    }

    /// Changes a body of the scene; `place`: the table of the case.
    fn apply(&self, place: &str, body: &mut BodyScene) -> Result<(), SceneError> {
        if self.is_empty() {
            return Err(SceneError::out_of_range(place, "an empty table", "material, supports or loads of the case"));
        }
        // What the case does not say of the body comes from the scene.
        let name = std::mem::replace(&mut body.name, place.to_owned());
        if let Some(material) = self.material {
            body.material = material.material()?;
        }
        if let Some(supports) = self.supports {
            body.supports = bodies::supports(place, supports)?;
        }
        if let Some(loads) = self.loads {
            body.loads = bodies::loads(place, loads)?;
        }
        body.name = name;
        if let Some(offset) = self.offset {
            *body = body.clone().moved(offset)?;
        }
        Ok(())
    }
}

impl CaseSection {
    /// The scene of the case, by its number in the file.
    fn scene(&self, index: usize, file: &SceneFile, base: &Scene) -> Result<Scene, SceneError> {
        let mut scene = base.clone();
        let place = |name: &str| format!("case[{index}].{name}");
        let tables = [
            ("lower", self.lower.as_ref()),
            ("upper", self.upper.as_ref()),
            ("body", self.body.as_ref().and_then(Either::one)),
        ];
        for (name, section) in tables {
            let Some(section) = section else { continue };
            let known = file.parts().is_empty();
            let Some(body) = scene.bodies.iter_mut().find(|body| known && body.name == name) else {
                return Err(SceneError::out_of_range(place(name), "a table", "only a body of the scene"));
            };
            Changed::of(section).apply(&place(name), body)?;
        }
        for (number, section) in self.body.as_ref().map_or(&[][..], Either::several).iter().enumerate() {
            let at = place(&format!("body[{number}]"));
            let names = scene.bodies.iter().map(|body| body.name.as_str());
            let body = find(&format!("{at}.name"), &section.name, names)?;
            Changed::of_part(section).apply(&at, &mut scene.bodies[body])?;
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
            self.move_counter_surfaces(offset, &mut scene);
        }
        let within = |source| SceneError::InFile { file: format!("case \"{}\"", self.name), source: Box::new(source) };
        scene.validate().map_err(|error| within(named(file, error)))?;
        Ok(scene)
    }

    /// Moves all obstacles; of the short form, an upper block with its counter surface.
    fn move_counter_surfaces(&self, offset: [f64; 3], scene: &mut Scene) {
        for contact in &mut scene.contacts {
            if let Master::Obstacle(surface) = &mut contact.master {
                *surface = surface.moved(offset);
            }
        }
        let upper = scene.bodies.iter_mut().find(|body| body.name == "upper");
        if let Some(Geometry::Block(block)) = upper.map(|body| &mut body.geometry) {
            (block.bottom, block.top) = (block.bottom.moved(offset), block.top.moved([0.0, 0.0, offset[2]]));
        }
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
