//! A field that is a table, or a list of tables.

use schemars::{JsonSchema, Schema, SchemaGenerator};
use serde::{Deserialize, Serialize};
use std::borrow::Cow;

/// A table `[field]`, or tables `[[field]]`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum Either<T, E> {
    /// The table.
    One(T),
    /// The list.
    Several(Vec<E>),
}

impl<T, E> Either<T, E> {
    /// The table, where it is one.
    pub fn one(&self) -> Option<&T> {
        match self {
            Self::One(one) => Some(one),
            Self::Several(_) => None,
        }
    }

    /// The entries of the list; none of a table.
    pub fn several(&self) -> &[E] {
        match self {
            Self::One(_) => &[],
            Self::Several(several) => several,
        }
    }

    /// The table, for changes.
    pub fn one_mut(&mut self) -> Option<&mut T> {
        match self {
            Self::One(one) => Some(one),
            Self::Several(_) => None,
        }
    }

    /// The entries of the list, for changes.
    pub fn several_mut(&mut self) -> &mut [E] {
        match self {
            Self::One(_) => &mut [],
            Self::Several(several) => several,
        }
    }
}

impl<T: Default, E> Default for Either<T, E> {
    fn default() -> Self {
        Self::One(T::default())
    }
}

/// Keywords of tables and of lists side by side: each applies to its own type alone.
impl<T: JsonSchema, E: JsonSchema> JsonSchema for Either<T, E> {
    fn schema_name() -> Cow<'static, str> {
        format!("{}Or{}", T::schema_name(), E::schema_name()).into()
    }

    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        let mut schema = T::json_schema(generator);
        schema.insert("type".into(), serde_json::json!(["object", "array"]));
        schema.insert("items".into(), generator.subschema_for::<E>().to_value());
        schema
    }
}
