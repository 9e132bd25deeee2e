//! JSON schema of the choices that scene files name.

use schemars::Schema;

/// Writes a choice as the list of its names. What the names mean is said where they are documented, not in the schema.
pub(crate) fn names_only(schema: &mut Schema) {
    let Some(choices) = schema.remove("oneOf") else { return };
    let description = schema.remove("description");
    let names: Vec<_> = choices.as_array().into_iter().flatten().map(|choice| choice["const"].clone()).collect();
    schema.insert("type".into(), "string".into());
    schema.insert("enum".into(), names.into());
    if let Some(description) = description {
        schema.insert("description".into(), description);
    }
}
