//! What options that stand for fields of the short form change in a scene with lists of bodies and contacts.

use contact::error::SceneError;
use scene_file::{PartSection, SceneFile, Setting};

/// Fields with their values, or what no scene may have.
pub type Settings = Result<Vec<Setting>, SceneError>;

/// The bodies of a list that a field belongs to.
type Picked = fn(&PartSection) -> bool;

/// Whether controls change a body.
fn is_optimized(part: &PartSection) -> bool {
    part.surface.is_some() || part.lattice.is_some()
}

/// The field below a body, and the bodies that have it; none for a field that belongs to no body.
fn below(path: &str) -> Option<(String, Picked)> {
    if let Some(rest) = path.strip_prefix("mesh.") {
        return Some((format!("block.{rest}"), |part| part.block.is_some()));
    }
    if path.starts_with("surface.") {
        return Some((path.to_owned(), |part| part.surface.is_some()));
    }
    let rest = ["lower.", "upper.", "body."].iter().find_map(|body| path.strip_prefix(body))?;
    // The formulation is that of all bodies, the elastic constants are those of the optimized one.
    Some((rest.to_owned(), if rest.ends_with("formulation") { |_| true } else { is_optimized }))
}

/// The settings of fields of the short form in a scene with lists; unchanged in one without.
///
/// # Errors
/// [`SceneError::OutOfRange`] where no body has the field, or where several have it and only one can be meant.
pub fn in_lists(file: &SceneFile, settings: Vec<Setting>) -> Settings {
    let parts = file.parts();
    if parts.is_empty() {
        return Ok(settings);
    }
    let mut found: Vec<Setting> = Vec::new();
    for setting in settings {
        if setting.path() == "friction" {
            found.extend(frictions(file, &setting));
        }
        let Some((field, picked)) = below(setting.path()) else {
            found.push(setting);
            continue;
        };
        let places: Vec<usize> = (0..parts.len()).filter(|index| picked(&parts[*index])).collect();
        let is_of_one = field.starts_with("material") && !field.ends_with("formulation");
        if places.is_empty() || (is_of_one && places.len() > 1) {
            let allowed = match (places.is_empty(), field.starts_with("block")) {
                (false, _) => {
                    format!("a scene with one optimized body; --set body[0].{field}=... sets that of one body")
                }
                (true, true) => "a scene with a block of bricks among its bodies".to_owned(),
                (true, false) => "a scene with an optimized surface of a block".to_owned(),
            };
            return Err(SceneError::out_of_range(setting.path(), "given", allowed));
        }
        let paths = places.into_iter().map(|index| format!("body[{index}].{field}"));
        // Fields of several bodies of the short form are one here.
        for path in paths.filter(|path| found.iter().all(|own| own.path() != path)).collect::<Vec<_>>() {
            found.push(setting.at(&path));
        }
    }
    Ok(found)
}

/// The friction of contacts that have one of their own.
fn frictions(file: &SceneFile, setting: &Setting) -> Vec<Setting> {
    let own = file.contact.several().iter().enumerate().filter(|(_, pair)| pair.friction.is_some());
    own.map(|(index, _)| setting.at(&format!("contact[{index}].friction"))).collect()
}

/// Subdomains of blocks that do not divide their bricks.
pub fn unfit_subdomains(file: &SceneFile) -> Vec<Setting> {
    let blocks = file.parts().iter().enumerate().filter_map(|(index, part)| Some((index, part.block.as_ref()?)));
    let unfit = blocks.filter(|(_, block)| {
        let divides = |(bricks, count): (&usize, usize)| count > 0 && bricks % count == 0;
        block.subdomains.is_some_and(|counts| !block.bricks.iter().zip(counts).all(divides))
    });
    unfit.map(|(index, _)| Setting::removal(&format!("body[{index}].block.subdomains"))).collect()
}

/// The field that a field of the short form stands for in a scene: with lists, that of the first body which has it.
pub fn first_in_lists(file: &SceneFile, field: &str) -> String {
    let found = below(field).and_then(|(field, picked)| {
        let index = file.parts().iter().position(picked)?;
        Some(format!("body[{index}].{field}"))
    });
    found.unwrap_or_else(|| field.to_owned())
}

/// Whether a field of an error in a scene with lists is one that a field of the short form stands for: the place in the
/// file, or what checks call it.
pub fn stands_for(field: &str, error: &str) -> bool {
    let Some((own, _)) = below(field) else { return false };
    let place = error.strip_prefix("body[").and_then(|rest| rest.split_once("].")).map(|(_, rest)| rest);
    let checked = own.strip_prefix("block.").is_some_and(|name| error.contains(&format!(".{name}[")));
    place.is_some_and(|place| place.starts_with(&own)) || checked
}
