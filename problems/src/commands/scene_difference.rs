//! The fields in which two scenes differ.

use crate::commands::failure::Failure;
use scene_file::SceneFile;
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
    there: &SceneFile,
    here: &SceneFile,
    counts: impl Fn(&str) -> bool,
) -> Result<Vec<Difference>, Failure> {
    let value = |scene: &SceneFile| serde_json::to_value(scene).map_err(Failure::computation);
    let mut found = Vec::new();
    collect(String::new(), (value(there)?, value(here)?), &mut found);
    found.retain(|difference| counts(&difference.field) && difference.field.rsplit('.').next() != Some("file"));
    Ok(found)
}

fn collect(field: String, values: (Value, Value), found: &mut Vec<Difference>) {
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
    let keys: BTreeSet<String> = there.keys().chain(here.keys()).cloned().collect();
    for key in keys {
        let values = (there.remove(&key).unwrap_or_default(), here.remove(&key).unwrap_or_default());
        let below = if field.is_empty() { key } else { format!("{field}.{key}") };
        collect(below, values, found);
    }
}

impl fmt::Display for Difference {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let shown = |value: &Value| if value.is_null() { "not given".to_owned() } else { value.to_string() };
        write!(f, "{} is {} in the run and {} here", self.field, shown(&self.there), shown(&self.here))
    }
}

/// Whether a field is one of those given, or lies below one of them.
pub fn is_below(field: &str, fields: &[&str]) -> bool {
    let mut ends = fields.iter().filter_map(|name| field.strip_prefix(name));
    ends.any(|end| end.is_empty() || end.starts_with('.'))
}
