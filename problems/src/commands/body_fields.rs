//! Options that stand for a field of the bodies of a scene: which bodies they change.

use contact::error::SceneError;
use scene_file::{BodySection, SceneFile, Setting};

/// Fields with their values, or what no scene may have.
pub type Settings = Result<Vec<Setting>, SceneError>;

/// How options write the field of a body: as that of the first one.
const FIRST: &str = "body[0].";

/// Whether an option that stands for a field below a body changes this one: fields of blocks and of lattices belong to
/// bodies that have them, the formulation to all, the elastic constants to the optimized one.
fn has(body: &BodySection, field: &str) -> bool {
    match field.split_once('.') {
        Some(("block", _)) => body.block.is_some(),
        _ if field.ends_with("formulation") => true,
        _ => body.lattice.is_some(),
    }
}

/// The settings of an option at the bodies that it changes; fields of no body stay as they are.
///
/// # Errors
/// [`SceneError::OutOfRange`] where no body has the field, or where several have it and only one can be meant.
pub fn of_bodies(file: &SceneFile, settings: Vec<Setting>) -> Settings {
    let mut found: Vec<Setting> = Vec::new();
    for setting in settings {
        if setting.path() == "friction" {
            found.extend(frictions(file, &setting));
        }
        let Some(field) = setting.path().strip_prefix(FIRST) else {
            found.push(setting);
            continue;
        };
        let places: Vec<usize> = (0..file.body.len()).filter(|&index| has(&file.body[index], field)).collect();
        let is_of_one = field.starts_with("material") && !field.ends_with("formulation");
        let allowed = match (places.len(), field.starts_with("block")) {
            (0, true) => "a scene with a block of bricks; pieces of a body divides a mesh".to_owned(),
            (0, false) => "a scene with an optimized body".to_owned(),
            (2.., _) if is_of_one => {
                format!("a scene with one optimized body; --set body[0].{field}=... sets that of one body")
            }
            _ => {
                found.extend(places.into_iter().map(|index| setting.at(&format!("body[{index}].{field}"))));
                continue;
            }
        };
        return Err(SceneError::out_of_range(setting.path(), "given", allowed));
    }
    Ok(found)
}

/// The friction of contacts that have one of their own.
fn frictions(file: &SceneFile, setting: &Setting) -> Vec<Setting> {
    let special = file.contact.iter().enumerate().filter(|(_, contact)| contact.friction.is_some());
    special.map(|(index, _)| setting.at(&format!("contact[{index}].friction"))).collect()
}

/// Subdomains of blocks that do not divide their bricks.
pub fn unfit_subdomains(file: &SceneFile) -> Vec<Setting> {
    let blocks = file.body.iter().enumerate().filter_map(|(index, body)| Some((index, body.block.as_ref()?)));
    let unfit = blocks.filter(|(_, block)| {
        let divides = |(bricks, count): (&usize, usize)| count > 0 && bricks % count == 0;
        block.subdomains.is_some_and(|counts| !block.bricks.iter().zip(counts).all(divides))
    });
    unfit.map(|(index, _)| Setting::removal(&format!("body[{index}].block.subdomains"))).collect()
}

/// The field of an option at the first body that it changes.
pub fn first_body(file: &SceneFile, field: &str) -> String {
    let found = field.strip_prefix(FIRST).and_then(|field| {
        let index = file.body.iter().position(|body| has(body, field))?;
        Some(format!("body[{index}].{field}"))
    });
    found.unwrap_or_else(|| field.to_owned())
}

/// Whether a field that an error names is one that an option stands for: its place in the file, or what checks of a
/// body with a name call it.
pub fn stands_for(field: &str, error: &str) -> bool {
    let Some(field) = field.strip_prefix(FIRST) else { return false };
    let place = error.strip_prefix("body[").and_then(|rest| rest.split_once("].")).map(|(_, rest)| rest);
    place.is_some_and(|place| place.starts_with(field)) || error.contains(&format!(".{field}["))
}
