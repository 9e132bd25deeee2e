//! A scene file with a comment on every field.

use crate::SceneFile;
use crate::allowed;
use crate::schema::{Node, place};
use contact::error::SceneError;
use toml::{Table, Value};

/// Longest line of a comment.
const WIDTH: usize = 118;

/// The file as TOML; fields that are not set stand there as comments.
pub(super) fn print(file: &SceneFile) -> Result<String, SceneError> {
    let table =
        Table::try_from(file).map_err(|error| SceneError::File { path: "scene".into(), reason: error.to_string() })?;
    let mut text = String::new();
    let root = Node::root();
    comment(&mut text, &root.text("description").unwrap_or_default());
    text += "\n";
    fields(&mut text, &root, &table, "", true);
    Ok(text)
}

/// The fields of a table: plain values first, as TOML wants them, then tables. Comments stand at the first of several
/// alike.
fn fields(text: &mut String, node: &Node<'_>, table: &Table, path: &str, commented: bool) {
    let Some(names) = node.fields() else { return };
    let all: Vec<(&String, Node<'_>)> = names.iter().map(|(name, field)| (name, Node::new(field))).collect();
    for (name, field) in all.iter().filter(|(_, field)| !field.is_table()) {
        leaf(text, name, field, table.get(name.as_str()), commented);
    }
    for (name, field) in all.iter().filter(|(_, field)| field.is_table()) {
        let place = place(path, name);
        let description = field.text("description").unwrap_or_default();
        *text += "\n";
        match table.get(name.as_str()) {
            Some(Value::Table(inner)) => {
                comment(text, &description);
                *text += &format!("[{place}]\n");
                other_forms(text, field);
                let form = inner.get("form").and_then(Value::as_str);
                let chosen = field.forms().into_iter().find(|(name, _)| Some(*name) == form);
                fields(text, &chosen.map_or(*field, |(_, node)| node), inner, &place, true);
            }
            Some(Value::Array(entries)) if !entries.is_empty() => {
                comment(text, &description);
                for (index, entry) in entries.iter().enumerate() {
                    *text += if index > 0 { "\n" } else { "" };
                    *text += &format!("[[{place}]]\n");
                    if let (Value::Table(inner), Some(items)) = (entry, field.items()) {
                        fields(text, &items, inner, &place, index == 0);
                    }
                }
            }
            _ => {
                let brackets = if field.items().is_some() { format!("[[{place}]]") } else { format!("[{place}]") };
                comment(text, &format!("{description} Not used here: {brackets}"));
            }
        }
    }
}

fn other_forms(text: &mut String, field: &Node<'_>) {
    for (form, node) in field.forms() {
        let names = node.fields().into_iter().flat_map(|fields| fields.keys());
        let names: Vec<&str> = names.map(String::as_str).filter(|name| *name != "form").collect();
        let description = node.text("description").unwrap_or_default();
        comment(text, &format!("form = \"{form}\" ({}): {description}", names.join(", ")));
    }
}

fn leaf(text: &mut String, name: &str, field: &Node<'_>, value: Option<&Value>, commented: bool) {
    let constant = field.inner.get("const").is_some();
    if commented && !constant {
        let description = field.text("description").unwrap_or_default();
        comment(text, &format!("{description} Allowed: {}.", allowed::words(field)));
    }
    *text += &match value {
        Some(value) => format!("{name} = {value}\n"),
        None => format!("# {name} is not set\n"),
    };
}

/// A comment, wrapped.
fn comment(text: &mut String, words: &str) {
    let mut line = String::from("#");
    for word in words.split_whitespace() {
        if line.chars().count() + 1 + word.chars().count() > WIDTH {
            *text += &line;
            *text += "\n";
            line = String::from("#");
        }
        line += " ";
        line += word;
    }
    *text += &line;
    *text += "\n";
}
