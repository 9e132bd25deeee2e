//! The table of all fields for `docs/scenes.md`.

use crate::allowed;
use crate::schema::{Node, place};
use serde_json::Value;

/// All fields of a scene file as a Markdown table: path, default, what is allowed with its unit, meaning.
pub fn field_table() -> String {
    let mut text = String::from("| field | default | allowed | meaning |\n|---|---|---|---|\n");
    rows(&mut text, &Node::root(), "", &Value::Null);
    text
}

fn rows(text: &mut String, node: &Node<'_>, path: &str, defaults: &Value) {
    let Some(fields) = node.fields() else { return };
    for (name, schema) in fields {
        let field = Node::new(schema);
        if field.inner.get("const").is_some() {
            continue;
        }
        let place = place(path, name);
        let meaning = field.text("description").unwrap_or_default();
        let default = field.outer.get("default").or(defaults.get(name)).unwrap_or(&Value::Null);
        if field.is_table() {
            let (entries, forms) = (field.tables(), field.forms());
            let required = if node.requires(name) { "required" } else { "–" };
            if field.fields().is_some() || !forms.is_empty() {
                row(text, &format!("[{place}]"), required, "", &meaning);
                rows(text, &field, &place, default);
            }
            if let Some(entries) = entries {
                let own = entries.text("description").filter(|_| field.fields().is_some());
                row(text, &format!("[[{place}]]"), required, "", &own.unwrap_or(meaning));
                rows(text, &entries, &place, default);
            }
            for (form, node) in forms {
                let meaning = node.text("description").unwrap_or_default();
                row(text, &format!("{place}.form"), "", &format!("\"{form}\""), &meaning);
                rows(text, &node, &place, &Value::Null);
            }
            continue;
        }
        let default = match default {
            _ if node.requires(name) => "required".to_owned(),
            Value::Null => "see meaning".to_owned(),
            value => value.to_string(),
        };
        row(text, &place, &default, &allowed::words(&field), &meaning);
    }
}

fn row(text: &mut String, place: &str, default: &str, allowed: &str, meaning: &str) {
    let line = |text: &str| text.split_whitespace().collect::<Vec<_>>().join(" ").replace('|', "\\|");
    *text += &format!("| `{place}` | {} | {} | {} |\n", line(default), line(allowed), line(meaning));
}
