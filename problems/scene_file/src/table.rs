//! The fields of scene files, type by type: for `docs/scenes.md` and the command `fields`.

use crate::allowed;
use crate::schema::{Node, schema};
use contact::error::SceneError;
use contact::names::find;
use serde_json::Value;

/// The name of the type of the whole file.
const FILE: &str = "scene";

/// A type of tables: its name, and its place in the schema.
type Kind = (String, Node<'static>);

/// The fields of one type of tables as Markdown, or of all types in the order in which they are named: field, default,
/// what is allowed with its unit, meaning.
///
/// # Errors
/// [`SceneError::OutOfRange`] with the names for a type that scene files do not have.
pub fn field_tables(kind: Option<&str>) -> Result<String, SceneError> {
    let kinds = kinds();
    let wanted = match kind {
        None => &kinds[..],
        Some(kind) => &[kinds[find("fields", kind, kinds.iter().map(|(name, _)| name.as_str()))?].clone()],
    };
    Ok(wanted.iter().map(|(name, node)| text(name, node)).collect::<Vec<_>>().join("\n"))
}

/// All types, each behind the first one that names it.
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
    found
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

fn text(name: &str, node: &Node<'static>) -> String {
    let mut text = format!("### `{name}`\n\n{}\n\n", node.text("description").unwrap_or_default());
    text += "| field | default | allowed | meaning |\n|---|---|---|---|\n";
    let forms = node.forms();
    if forms.is_empty() {
        rows(&mut text, node);
    }
    for (form, node) in forms {
        row(&mut text, "form", "", &format!("\"{form}\""), &node.text("description").unwrap_or_default());
        rows(&mut text, &node);
    }
    text
}

fn rows(text: &mut String, node: &Node<'static>) {
    for (name, schema) in node.fields().into_iter().flatten() {
        let field = Node::new(schema);
        if field.inner.get("const").is_some() {
            continue;
        }
        let default = field.outer.get("default").unwrap_or(&Value::Null);
        let default = match (kind(schema), default) {
            _ if node.requires(name) => "required".to_owned(),
            (Some(_), _) => "–".to_owned(),
            (None, Value::Null) => "see meaning".to_owned(),
            (None, value) => value.to_string(),
        };
        let allowed = match kind(schema) {
            None => allowed::words(&field),
            Some((kind, _)) if field.items().is_some() => format!("list of `{kind}`"),
            Some((kind, _)) => format!("`{kind}`"),
        };
        row(text, name, &default, &allowed, &field.text("description").unwrap_or_default());
    }
}

fn row(text: &mut String, name: &str, default: &str, allowed: &str, meaning: &str) {
    let line = |text: &str| text.split_whitespace().collect::<Vec<_>>().join(" ").replace('|', "\\|");
    *text += &format!("| `{name}` | {} | {} | {} |\n", line(default), line(allowed), line(meaning));
}
