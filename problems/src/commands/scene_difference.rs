//! The fields in which two scenes differ.

use crate::commands::failure::Failure;
use crate::commands::loaded_scene::LoadedScene;
use serde_json::{Map, Value};
use std::collections::BTreeSet;
use std::fmt;

/// A field with other values in the scene of a run than in that of the command.
pub struct Difference {
    field: String,
    there: Value,
    here: Value,
}

/// The differing fields for which `counts` holds, and which are no names of files.
///
/// # Errors
/// [`Failure::Computation`] if a scene cannot be written as JSON.
pub fn differences(
    there: &LoadedScene,
    here: &LoadedScene,
    counts: impl Fn(&str) -> bool,
) -> Result<Vec<Difference>, Failure> {
    let value = |scene: &LoadedScene| serde_json::to_value(&scene.file).map_err(Failure::computation);
    let mut found = Vec::new();
    collect(String::new(), (value(there)?, value(here)?), &mut found);
    // The degree that a file leaves out is the default one.
    let splines = |scene: &LoadedScene| {
        let heights = scene.case.scene.bodies.iter().map(|body| body.heights().map(|heights| heights.degrees));
        heights.collect::<Vec<_>>()
    };
    let same_splines = splines(there) == splines(here);
    let is_silent = |field: &str| {
        field.ends_with(".file") || plain(field) == "body.mesh" || (same_splines && field.ends_with("lattice.degrees"))
    };
    found.retain(|difference| !is_silent(&difference.field) && counts(&difference.field));
    Ok(found)
}

/// The lists whose entries are compared one by one.
const LISTS: [&str; 2] = ["body", "contact"];

fn collect(field: String, values: (Value, Value), found: &mut Vec<Difference>) {
    let values = match values {
        (Value::Array(there), Value::Array(here)) if LISTS.contains(&&*field) && there.len() == here.len() => {
            let pairs = there.into_iter().zip(here).enumerate();
            return pairs.for_each(|(index, values)| collect(format!("{field}[{index}]"), values, found));
        }
        other => other,
    };
    let has_fields = |value: &Value| value.is_object() || value.is_null();
    let (there, here) = values;
    if there == here {
        return;
    }
    if !has_fields(&there) || !has_fields(&here) {
        found.push(Difference { field, there, here });
        return;
    }
    let of = |value: Value| if let Value::Object(fields) = value { fields } else { Map::new() };
    let (mut there, mut here) = (of(there), of(here));
    if let (Some(one), Some(other)) = (there.get("form"), here.get("form"))
        && one != other
    {
        // Their parameters cannot be compared.
        let (there, here) = (one.clone(), other.clone());
        found.push(Difference { field: format!("{field}.form"), there, here });
        return;
    }
    let keys: BTreeSet<String> = there.keys().chain(here.keys()).cloned().collect();
    for key in keys {
        let values = (there.remove(&key).unwrap_or_default(), here.remove(&key).unwrap_or_default());
        let below = if field.is_empty() { key } else { format!("{field}.{key}") };
        collect(below, values, found);
    }
}

impl Difference {
    /// The difference of a value that is no field of a file.
    pub fn new(field: &str, there: impl Into<Value>, here: impl Into<Value>) -> Self {
        Self { field: field.to_owned(), there: there.into(), here: here.into() }
    }
}

impl fmt::Display for Difference {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let shown = |value: &Value| if value.is_null() { "not given".to_owned() } else { value.to_string() };
        write!(f, "{} is {} in the run and {} here", self.field, shown(&self.there), shown(&self.here))
    }
}

/// A field without the numbers of entries: `body.block` for `body[1].block`.
fn plain(field: &str) -> String {
    field.split('[').map(|part| part.split_once(']').map_or(part, |(_, rest)| rest)).collect()
}

/// Whether a field is one of those given, or lies below one of them; entries of a list count like the list.
pub fn is_below(field: &str, fields: &[&str]) -> bool {
    let field = plain(field);
    let mut ends = fields.iter().filter_map(|name| field.strip_prefix(name));
    ends.any(|end| end.is_empty() || end.starts_with('.'))
}
