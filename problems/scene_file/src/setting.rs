//! A field of a scene by its path, and the value that it is given.

use crate::SceneFile;
use crate::check::{Checker, check};
use crate::schema::{Node, place};
use contact::error::SceneError;
use toml::{Table, Value};

/// What messages call a scene whose fields were set.
const CHANGED: &str = "the scene";

/// A field and its value; none where the field is removed.
#[derive(Debug, Clone, PartialEq)]
pub struct Setting {
    path: String,
    value: Option<Value>,
}

/// What a path names at one place: a field of a table, or an entry of a list.
#[derive(Debug, Clone, Copy)]
enum Step<'p> {
    Field(&'p str),
    Entry(usize),
}

impl Setting {
    /// From `FIELD=VALUE`, as [`read`](Self::read).
    ///
    /// # Errors
    /// As [`read`](Self::read), and for a text without the sign =.
    pub fn parse(text: &str) -> Result<Self, SceneError> {
        let allowed = "FIELD=VALUE, such as body[0].material.young_modulus=2e5";
        let (path, value) =
            text.split_once('=').ok_or_else(|| SceneError::out_of_range("--set", format!("{text:?}"), allowed))?;
        Self::read(path.trim(), value.trim())
    }

    /// The field at a path such as `body[0].loads[0].traction`, and its value in TOML. A text that is no value of TOML
    /// is a string. A list of plain values may also be written as `6x6x3` or `6,12`; a single value stands for all
    /// entries of a list of fixed length.
    ///
    /// # Errors
    /// [`SceneError::UnknownField`] with the nearest name; [`SceneError::OutOfRange`] with what the schema allows.
    pub fn read(path: &str, text: &str) -> Result<Self, SceneError> {
        let nodes = resolve(path)?;
        let plain = |node: &Node<'_>| node.items().is_some_and(|items| !items.is_table()) && !text.starts_with('[');
        let value = match nodes.first().filter(|node| plain(node)) {
            None => value(text),
            Some(list) => {
                // Names of files may have an x.
                let has_names = list.items().is_some_and(|items| items.is("string"));
                let mut entries: Vec<Value> = text.split(|c| c == ',' || c == 'x' && !has_names).map(value).collect();
                if let ([only], Some(count)) = (&entries[..], list.length()) {
                    entries = vec![only.clone(); count];
                }
                Value::Array(entries)
            }
        };
        // Where the field stands in several forms of a table, the scene decides which one holds.
        if let [node] = nodes[..] {
            Checker { file: CHANGED }.value(&node, &value, path).map_err(without_file)?;
        }
        Ok(Self { path: path.to_owned(), value: Some(value) })
    }

    /// The removal of a field.
    pub fn removal(path: &str) -> Self {
        Self { path: path.to_owned(), value: None }
    }

    /// Its value for another field, such as that of another body.
    #[must_use]
    pub fn at(&self, path: &str) -> Self {
        Self { path: path.to_owned(), value: self.value.clone() }
    }

    /// The path of the field.
    pub fn path(&self) -> &str {
        &self.path
    }
}

impl SceneFile {
    /// The file with other values of some fields.
    ///
    /// # Errors
    /// As [`SceneFile::parse`]; [`SceneError::OutOfRange`] for an entry beyond the end of a list.
    pub fn with(&self, settings: &[Setting]) -> Result<Self, SceneError> {
        let failed = |reason: String| SceneError::File { path: CHANGED.to_owned(), reason };
        let table = Table::try_from(self).map_err(|error| failed(error.to_string()))?;
        let mut whole = Value::Table(table);
        for Setting { path, value } in settings {
            put(&mut whole, &steps(path), value.as_ref(), path)?;
        }
        let table: Table = whole.try_into().map_err(|error: toml::de::Error| failed(error.to_string()))?;
        check(&table, CHANGED).map_err(without_file)?;
        table.try_into().map_err(|error: toml::de::Error| failed(error.to_string().trim_end().to_owned()))
    }
}

/// Whether scenes have a field.
///
/// # Errors
/// [`SceneError::UnknownField`] with the nearest name.
pub fn check_path(path: &str) -> Result<(), SceneError> {
    resolve(path).map(|_| ())
}

/// The error without the place of the scene: the field was set on its own.
fn without_file(error: SceneError) -> SceneError {
    match error {
        SceneError::Field { path, value, allowed, .. } => SceneError::out_of_range(path, value, allowed),
        other => other,
    }
}

/// A value of TOML; any other text is a number if it is one, and a string otherwise.
fn value(text: &str) -> Value {
    let mut table: Table = toml::from_str(&format!("value = {text}")).unwrap_or_default();
    let number = || text.parse().ok().filter(|number: &f64| number.is_finite()).map(Value::Float);
    match (table.remove("value"), table.is_empty()) {
        (Some(value), true) => value,
        _ => number().unwrap_or_else(|| Value::String(text.to_owned())),
    }
}

/// The value at a path below a table; none where nothing is set.
pub(crate) fn value_at(table: &Table, path: &str) -> Option<Value> {
    let mut here = Value::Table(table.clone());
    for step in steps(path) {
        here = match step {
            Step::Field(name) => match here.as_array().map(Vec::as_slice) {
                Some([only]) => only.get(name)?.clone(),
                _ => here.get(name)?.clone(),
            },
            Step::Entry(index) => here.get(index)?.clone(),
        };
    }
    Some(here)
}

fn steps(path: &str) -> Vec<Step<'_>> {
    let mut steps = Vec::new();
    for part in path.split('.') {
        let (mut name, at) = (part, steps.len());
        while let Some((rest, index)) = name.strip_suffix(']').and_then(|inner| inner.rsplit_once('[')) {
            let Ok(index) = index.parse() else { break };
            steps.insert(at, Step::Entry(index));
            name = rest;
        }
        steps.insert(at, Step::Field(name));
    }
    steps
}

/// The places of the schema at a path: one per form of a table that has the field.
fn resolve(path: &str) -> Result<Vec<Node<'static>>, SceneError> {
    let (mut nodes, mut at) = (vec![Node::root()], String::new());
    for step in steps(path) {
        let field = match step {
            Step::Field(name) => place(&at, name),
            Step::Entry(index) => format!("{at}[{index}]"),
        };
        let inner: Vec<Node<'static>> = match step {
            // The only entry of a list needs no number.
            Step::Field(name) => {
                let entries = nodes.iter().map(|node| node.tables().unwrap_or(*node));
                entries.flat_map(|node| node.tables_at()).filter_map(|node| node.field(name)).collect()
            }
            Step::Entry(_) => nodes.iter().filter_map(Node::items).collect(),
        };
        if inner.is_empty() {
            let name = if let Step::Field(name) = step { name } else { "" };
            return Err(Checker { file: CHANGED }.unknown(&field, name, &nodes));
        }
        (nodes, at) = (inner, field);
    }
    Ok(nodes)
}

/// Sets the field at a path of the table of a scene file, or removes it; checked when the file is parsed.
///
/// # Errors
/// [`SceneError::OutOfRange`] for an entry beyond the end of a list.
pub fn set_field(table: &mut Table, path: &str, value: Option<Value>) -> Result<(), SceneError> {
    let mut whole = Value::Table(std::mem::take(table));
    let done = put(&mut whole, &steps(path), value.as_ref(), path);
    if let Value::Table(changed) = whole {
        *table = changed;
    }
    done
}

/// Puts a value at a place below a table, or removes what is there. Tables on the way are made; an entry may follow
/// the last one.
fn put(here: &mut Value, steps: &[Step<'_>], value: Option<&Value>, path: &str) -> Result<(), SceneError> {
    let Some((step, rest)) = steps.split_first() else {
        value.into_iter().for_each(|value| *here = value.clone());
        return Ok(());
    };
    let inner = match *step {
        Step::Field(_) if here.is_array() => match here.as_array_mut().map(Vec::as_mut_slice) {
            Some([only]) => return put(only, steps, value, path),
            entries => {
                let found = format!("one of {} entries", entries.map_or(0, |entries| entries.len()));
                return Err(SceneError::out_of_range(path, found, "the number of the entry, as in body[0].material"));
            }
        },
        Step::Field(name) => {
            if !here.is_table() {
                *here = Value::Table(Table::new());
            }
            let Some(table) = here.as_table_mut() else { return Ok(()) };
            if value.is_none() && rest.is_empty() {
                table.remove(name);
                return Ok(());
            }
            table.entry(name).or_insert_with(|| Value::Table(Table::new()))
        }
        Step::Entry(index) => {
            let entries = here.as_array_mut().filter(|entries| index <= entries.len());
            let count = entries.as_ref().map_or(0, |entries| entries.len());
            let Some(entries) = entries else {
                return Err(SceneError::out_of_range(path, format!("entry {index}"), "entries from 0 on, without gap"));
            };
            if index == count {
                entries.push(Value::Table(Table::new()));
            }
            &mut entries[index]
        }
    };
    put(inner, rest, value, path)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_are_those_of_toml_or_strings() {
        assert_eq!(value("2e5"), Value::Float(2e5));
        assert_eq!(value(".5"), Value::Float(0.5));
        assert_eq!(value("[6, 6]"), Value::Array(vec![Value::Integer(6); 2]));
        for text in ["bezier", "", "1\nfriction = 2", "[6, 6", "exp(-x1) + 5", "inf."] {
            assert_eq!(value(text), Value::String(text.to_owned()));
        }
    }

    #[test]
    fn paths_name_fields_and_entries() {
        let shown = format!("{:?}", steps("lower.loads[1].traction[2]"));
        assert_eq!(shown, r#"[Field("lower"), Field("loads"), Entry(1), Field("traction"), Entry(2)]"#);
        assert_eq!(format!("{:?}", steps("a[0][3]")), r#"[Field("a"), Entry(0), Entry(3)]"#);
        assert_eq!(format!("{:?}", steps("loads[x]")), r#"[Field("loads[x]")]"#);
    }
}
