//! The table of all fields for `docs/scenes.md`.

use crate::allowed;
use crate::schema::Node;
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
        let place = if path.is_empty() { name.clone() } else { format!("{path}.{name}") };
        let meaning = field.outer["description"].as_str().or(field.inner["description"].as_str()).unwrap_or_default();
        let default = field.outer.get("default").or(defaults.get(name)).unwrap_or(&Value::Null);
        let entries = field.items().filter(|items| items.fields().is_some());
        let forms = field.forms();
        if field.fields().is_some() || entries.is_some() || !forms.is_empty() {
            let (open, close) = if entries.is_some() { ("[[", "]]") } else { ("[", "]") };
            let required = if node.requires(name) { "required" } else { "–" };
            row(text, &format!("{open}{place}{close}"), required, "", meaning);
            rows(text, &entries.unwrap_or(field), &place, default);
            for (form, node) in forms {
                row(
                    text,
                    &format!("{place}.form"),
                    "",
                    &format!("\"{form}\""),
                    &node.text("description").unwrap_or_default(),
                );
                rows(text, &node, &place, &Value::Null);
            }
            continue;
        }
        let default = match default {
            _ if node.requires(name) => "required".to_owned(),
            Value::Null => "see meaning".to_owned(),
            value => value.to_string(),
        };
        row(text, &place, &default, &allowed::words(&field), meaning);
    }
}

fn row(text: &mut String, place: &str, default: &str, allowed: &str, meaning: &str) {
    let line = |text: &str| text.split_whitespace().collect::<Vec<_>>().join(" ").replace('|', "\\|");
    *text += &format!("| `{place}` | {} | {} | {} |\n", line(default), line(allowed), line(meaning));
}
