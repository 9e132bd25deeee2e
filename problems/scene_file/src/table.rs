//! The fields of scene files, type by type: for `docs/fields.md` and the command `fields`.

use crate::allowed;
use crate::quantity::Details;
use crate::schema::{Node, schema};
use contact::error::SceneError;
use contact::names::find;
use serde_json::Value;
use std::sync::OnceLock;

/// The name of the type of the whole file.
const FILE: &str = "scene";
/// Names beyond which a list of names is printed at its first field only.
const MANY_NAMES: usize = 8;

/// Words of a description that says no more than the name of its type.
const REPEATING_WORDS: usize = 7;

/// A type of tables: its name, and its place in the schema.
type Kind = (String, Node<'static>);

/// The fields of one type of tables as Markdown, or of all types in the order in which they are named: what is allowed
/// with its unit, meaning, default.
///
/// # Errors
/// [`SceneError::OutOfRange`] with the names for a type that scene files do not have.
pub fn field_tables(kind: Option<&str>) -> Result<String, SceneError> {
    let kinds = kinds();
    let wanted = match kind {
        None => &kinds[..],
        Some(kind) => &[kinds[find("fields", kind, kinds.iter().map(|(name, _)| name.as_str()))?].clone()],
    };
    Ok(wanted.iter().map(|(name, node)| text(name, node, &kinds)).collect::<Vec<_>>().join("\n"))
}

/// All types, each behind the first one that names it; before the one that it belongs to where it has no name there.
fn kinds() -> Vec<Kind> {
    let mut found = vec![(FILE.to_owned(), Node::root())];
    let mut next = 0;
    while let Some((_, node)) = found.get(next).cloned() {
        for inner in tables(&node).iter().filter_map(|table| table.fields()).flat_map(|fields| fields.values()) {
            if let Some((name, node)) = kind(inner).filter(|(name, _)| found.iter().all(|(known, _)| known != name)) {
                found.push((name, node));
            }
        }
        next += 1;
    }
    let first = found.iter().position(|(_, node)| holds(node, &details())).unwrap_or(found.len());
    found.insert(first, ("quantity".to_owned(), details()));
    found
}

/// What objective, limits and reports have in common.
fn details() -> Node<'static> {
    static DETAILS: OnceLock<Value> = OnceLock::new();
    Node::new(DETAILS.get_or_init(|| schemars::schema_for!(Details).to_value()))
}

/// Whether a table has all fields of another one, with the same meaning.
fn holds(node: &Node<'static>, part: &Node<'static>) -> bool {
    let meaning = |node: &Node<'static>, name: &str| node.field(name).map(|field| field.text("description"));
    let names = part.own_names();
    !names.is_empty()
        && names.len() < node.own_names().len()
        && names.iter().all(|name| meaning(node, name) == meaning(part, name))
}

/// The tables at a place: itself, or its forms.
fn tables(node: &Node<'static>) -> Vec<Node<'static>> {
    if node.forms().is_empty() { vec![*node] } else { node.forms().into_iter().map(|(_, form)| form).collect() }
}

/// The type of the table, or of the tables of a list, in a field; none for plain values.
fn kind(field: &'static Value) -> Option<Kind> {
    let reference = match field {
        _ if field.get("items").is_some() => &field["items"],
        _ if field.get("anyOf").is_some() => {
            field["anyOf"].as_array()?.iter().find(|choice| choice["type"] != "null")?
        }
        _ => field,
    };
    let reference = if reference.get("items").is_some() { &reference["items"] } else { reference };
    let name = reference["$ref"].as_str()?.rsplit('/').next()?;
    let node = Node::new(&schema()["$defs"][name]);
    node.is_table().then(|| (words(name.trim_end_matches("Section")), node))
}

/// `VolumeMaterial` as `volume-material`.
fn words(name: &str) -> String {
    let mut text = String::new();
    for letter in name.chars() {
        if letter.is_uppercase() && !text.is_empty() {
            text.push('-');
        }
        text.extend(letter.to_lowercase());
    }
    text
}

fn text(name: &str, node: &Node<'static>, kinds: &[Kind]) -> String {
    let mut text = format!("### `{name}`\n\n");
    // A short description only repeats the name.
    let description = node.text("description").filter(|text| text.split_whitespace().count() > REPEATING_WORDS);
    description.iter().for_each(|description| text += &format!("{description}\n\n"));
    let part = kinds.iter().find(|(_, part)| part.forms().is_empty() && holds(node, part));
    if let Some((part, _)) = part {
        text += &format!("It has the fields of `{part}`, and:\n\n");
    }
    let own = |field: &str| part.is_none_or(|(_, part)| part.field(field).is_none());
    if node.forms().is_empty() {
        fields(&mut text, (name, node), own, kinds);
    }
    for (form, node) in node.forms() {
        text += &format!("`form = \"{form}\"`: {}\n\n", node.text("description").unwrap_or_default());
        fields(&mut text, (name, &node), own, kinds);
        text.push('\n');
    }
    text.trim_end().to_owned() + "\n"
}

fn fields(text: &mut String, (kind_name, node): (&str, &Node<'static>), own: impl Fn(&str) -> bool, kinds: &[Kind]) {
    for (name, schema) in node.fields().into_iter().flatten().filter(|(name, _)| own(name)) {
        let field = Node::new(schema);
        if field.inner.get("const").is_some() {
            continue;
        }
        let meaning = field.text("description").unwrap_or_default();
        let default = field.outer.get("default").filter(|value| !value.is_null() && !meaning.contains("Default"));
        let needed = match (node.requires(name), default.filter(|_| kind(schema).is_none())) {
            (true, _) => ", required".to_owned(),
            (false, Some(value)) => format!(", default {value}"),
            (false, None) => String::new(),
        };
        *text += &format!("* `{name}` ({}{needed}): {meaning}\n", allowed_here(&field, schema, kind_name, kinds));
    }
}

/// What is allowed in a field: the type of an inner table, or values.
fn allowed_here(field: &Node<'static>, schema: &'static Value, kind_name: &str, kinds: &[Kind]) -> String {
    let names = field.names();
    let same = |(_, node): &&Kind| {
        node.fields()
            .into_iter()
            .flatten()
            .any(|(_, other)| names.len() > MANY_NAMES && Node::new(other).names() == names)
    };
    match (kind(schema), kinds.iter().find(same)) {
        (Some((kind, _)), _) if field.items().is_some() => format!("list of `{kind}`"),
        (Some((kind, _)), _) => format!("`{kind}`"),
        (None, Some((first, _))) if first != kind_name => format!("as in `{first}`"),
        (None, _) => allowed::brief(field),
    }
}
