//! The JSON schema of scene files, and how the other parts walk through it.

use crate::SceneFile;
use serde_json::{Map, Value};
use std::sync::OnceLock;

/// JSON schema of scene files, for editors (draft 2020-12).
pub fn schema() -> &'static Value {
    static SCHEMA: OnceLock<Value> = OnceLock::new();
    SCHEMA.get_or_init(|| schemars::schema_for!(SceneFile).to_value())
}

/// The path of a field in the table at a path.
pub(super) fn place(path: &str, name: &str) -> String {
    if path.is_empty() { name.to_owned() } else { format!("{path}.{name}") }
}

/// A place in the schema, references and optional wrappers removed.
#[derive(Debug, Clone, Copy)]
pub(super) struct Node<'s> {
    /// The place as written: description, default and unit stand here.
    pub outer: &'s Value,
    /// What it refers to: type, properties, ranges.
    pub inner: &'s Value,
}

impl<'s> Node<'s> {
    /// The place of a value.
    pub(super) fn new(outer: &'s Value) -> Self {
        let mut inner = outer;
        loop {
            let optional = inner["anyOf"].as_array().and_then(|choices| choices.iter().find(|c| c["type"] != "null"));
            let reference = inner["$ref"].as_str().and_then(|name| schema().pointer(name.trim_start_matches('#')));
            match optional.or(reference) {
                Some(next) => inner = next,
                None => return Self { outer, inner },
            }
        }
    }

    /// The whole file.
    pub(super) fn root() -> Node<'static> {
        Node::new(schema())
    }

    /// A keyword at the place or at what it refers to.
    pub(super) fn keyword(&self, word: &str) -> Option<&'s Value> {
        self.outer.get(word).or_else(|| self.inner.get(word))
    }

    /// Text of a keyword, on one line.
    pub(super) fn text(&self, word: &str) -> Option<String> {
        self.keyword(word).and_then(Value::as_str).map(|text| text.split_whitespace().collect::<Vec<_>>().join(" "))
    }

    /// The tables among which the tag `form` chooses, each with its tag; empty for other places.
    pub(super) fn forms(&self) -> Vec<(&'s str, Node<'s>)> {
        let choices = self.inner["oneOf"].as_array().map_or(&[][..], Vec::as_slice);
        let tag = |choice: &'s Value| choice["properties"]["form"]["const"].as_str();
        choices.iter().filter_map(|choice| tag(choice).map(|tag| (tag, Node::new(choice)))).collect()
    }

    /// Entries of a list of tables.
    pub(super) fn tables(&self) -> Option<Node<'s>> {
        self.items().filter(|items| items.fields().is_some())
    }

    /// Whether the place holds a table or a list of tables.
    pub(super) fn is_table(&self) -> bool {
        self.fields().is_some() || self.tables().is_some() || !self.forms().is_empty()
    }

    /// Names of which a text must be one.
    pub(super) fn names(&self) -> Vec<&'s str> {
        let choices = self.inner["oneOf"].as_array().map_or(&[][..], Vec::as_slice);
        let listed = self.inner["enum"].as_array().map_or(&[][..], Vec::as_slice);
        let one = self.inner.get("const").into_iter();
        choices.iter().map(|choice| &choice["const"]).chain(listed).chain(one).filter_map(Value::as_str).collect()
    }

    /// Fields of a table.
    pub(super) fn fields(&self) -> Option<&'s Map<String, Value>> {
        self.inner["properties"].as_object()
    }

    /// A field of a table.
    pub(super) fn field(&self, name: &str) -> Option<Node<'s>> {
        self.fields().and_then(|fields| fields.get(name)).map(Node::new)
    }

    /// Names of the fields of a table.
    pub(super) fn own_names(&self) -> Vec<&'s str> {
        self.fields().map_or(vec![], |fields| fields.keys().map(String::as_str).collect())
    }

    /// The tables that may stand at the place: itself, or its forms.
    pub(super) fn tables_at(&self) -> Vec<Node<'s>> {
        let forms = self.forms().into_iter().map(|(_, node)| node);
        self.fields().map(|_| *self).into_iter().chain(forms).collect()
    }

    /// The number of entries of a list of fixed length.
    pub(super) fn length(&self) -> Option<usize> {
        let [low, high] = ["minItems", "maxItems"].map(|bound| self.inner[bound].as_u64());
        low.filter(|_| low == high).map(|count| count as usize)
    }

    /// Whether a table must have a field.
    pub(super) fn requires(&self, field: &str) -> bool {
        self.inner["required"].as_array().is_some_and(|required| required.iter().any(|name| name == field))
    }

    /// Entries of a list.
    pub(super) fn items(&self) -> Option<Node<'s>> {
        self.inner.get("items").map(Node::new)
    }

    /// Whether values may be of a type.
    pub(super) fn is(&self, kind: &str) -> bool {
        match &self.inner["type"] {
            Value::Array(kinds) => kinds.iter().any(|found| found == kind),
            found => found == kind,
        }
    }
}
