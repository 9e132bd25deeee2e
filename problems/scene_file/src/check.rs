//! A table against the schema: unknown and missing fields, types, ranges. Every refusal names the path of the field.

use crate::allowed;
use crate::schema::{Node, place};
use contact::error::SceneError;
use std::collections::BTreeSet;
use toml::{Table, Value};

/// Names at least this similar to a misspelt one are suggested (Jaro–Winkler, 1 for equal names).
const SIMILAR: f64 = 0.75;

/// Refuses a table that is no scene; `file` stands in messages.
pub(super) fn check(table: &Table, file: &str) -> Result<(), SceneError> {
    Checker { file }.table(&Node::root(), table, "")
}

/// The checks of one file.
pub(super) struct Checker<'f> {
    /// What messages call it.
    pub file: &'f str,
}

impl Checker<'_> {
    fn refuse<T>(&self, path: &str, value: impl ToString, node: &Node<'_>) -> Result<T, SceneError> {
        Err(SceneError::Field {
            file: self.file.to_owned(),
            path: path.to_owned(),
            value: shorten(value.to_string()),
            allowed: allowed::words(node),
        })
    }

    fn table(&self, node: &Node<'_>, table: &Table, path: &str) -> Result<(), SceneError> {
        let Some(fields) = node.fields() else { return Ok(()) };
        for (name, value) in table {
            match fields.get(name) {
                Some(field) => self.value(&Node::new(field), value, &place(path, name))?,
                None => return Err(self.unknown(&place(path, &shorten(name.clone())), name, &[*node])),
            }
        }
        match fields.iter().find(|(name, _)| node.requires(name) && !table.contains_key(*name)) {
            Some((name, field)) => self.refuse(&place(path, name), "missing", &Node::new(field)),
            None => Ok(()),
        }
    }

    /// The refusal of a field that no table among `nodes` has.
    pub(super) fn unknown(&self, path: &str, name: &str, nodes: &[Node<'_>]) -> SceneError {
        let mut names: Vec<&str> = nodes.iter().flat_map(Node::tables_at).flat_map(|table| table.own_names()).collect();
        let mut known = BTreeSet::new();
        names.retain(|name| known.insert(*name));
        let suggestion = nearest(name, &names).map_or_else(String::new, |near| format!(" (did you mean `{near}`?)"));
        let allowed = match (&names[..], nodes) {
            ([], [node, ..]) => allowed::words(node),
            _ => names.join(", "),
        };
        SceneError::UnknownField { file: self.file.to_owned(), path: path.to_owned(), suggestion, allowed }
    }

    /// Refuses a value that a place does not take.
    pub(super) fn value(&self, node: &Node<'_>, value: &Value, path: &str) -> Result<(), SceneError> {
        match value {
            Value::Table(table) if node.fields().is_some() => self.table(node, table, path),
            Value::Table(table) if !node.forms().is_empty() => {
                let form = table.get("form").and_then(Value::as_str).unwrap_or("missing");
                match node.forms().into_iter().find(|(name, _)| *name == form) {
                    Some((_, chosen)) => self.table(&chosen, table, path),
                    None => self.refuse(&format!("{path}.form"), form, node),
                }
            }
            Value::Array(entries) => {
                let Some(items) = node.items() else { return self.refuse(path, value, node) };
                let bound = |word: &str| node.inner[word].as_u64();
                let count = entries.len() as u64;
                if bound("minItems").is_some_and(|low| count < low)
                    || bound("maxItems").is_some_and(|high| count > high)
                {
                    return self.refuse(path, value, node);
                }
                let mut entries = entries.iter().enumerate();
                entries.try_for_each(|(index, entry)| self.value(&items, entry, &format!("{path}[{index}]")))
            }
            Value::String(text) if !node.names().is_empty() && node.names().contains(&text.as_str()) => Ok(()),
            Value::String(_) if node.names().is_empty() && node.is("string") => Ok(()),
            Value::Integer(number) if node.is("integer") || node.is("number") => {
                let inside = allowed::contains(node, *number as f64) && (node.is("number") || *number >= 0);
                if inside { Ok(()) } else { self.refuse(path, number, node) }
            }
            Value::Float(number) if node.is("number") && allowed::contains(node, *number) => Ok(()),
            Value::Boolean(_) if node.is("boolean") => Ok(()),
            Value::Float(number) if number.is_finite() => self.refuse(path, format!("{number:?}"), node),
            _ => self.refuse(path, value, node),
        }
    }
}

/// The name most similar to a misspelt one, if any is similar.
fn nearest<'n>(name: &str, names: &[&'n str]) -> Option<&'n str> {
    let similarity = |candidate: &str| strsim::jaro_winkler(name, candidate);
    let best = names.iter().copied().max_by(|a, b| similarity(a).total_cmp(&similarity(b)))?;
    (similarity(best) >= SIMILAR).then_some(best)
}

/// Long values do not drown the message.
fn shorten(text: String) -> String {
    const LONGEST: usize = 80;
    let text: String = text.split_whitespace().collect::<Vec<_>>().join(" ");
    if text.chars().count() <= LONGEST { text } else { text.chars().take(LONGEST).chain("…".chars()).collect() }
}
