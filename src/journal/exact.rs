//! Numbers in JSON without loss: the shortest text that reads back as the same bits, and texts such as "inf" for the
//! numbers that JSON lacks.

use serde::{Deserialize, Deserializer, Serialize, Serializer, de};
use std::num::ParseFloatError;

/// A number as it stands in the file.
#[derive(Serialize, Deserialize)]
#[serde(untagged)]
pub(super) enum Written {
    Finite(f64),
    /// `inf`, `-inf` or `NaN`.
    Text(String),
}

/// A number, or several, with their written form.
pub(super) trait Exact: Sized {
    type Written: Serialize + for<'de> Deserialize<'de>;
    fn write(&self) -> Self::Written;
    fn read(written: Self::Written) -> Result<Self, ParseFloatError>;
}

impl Exact for f64 {
    type Written = Written;

    fn write(&self) -> Written {
        if self.is_finite() { Written::Finite(*self) } else { Written::Text(self.to_string()) }
    }

    fn read(written: Written) -> Result<Self, ParseFloatError> {
        match written {
            Written::Finite(x) => Ok(x),
            Written::Text(text) => text.parse(),
        }
    }
}

impl Exact for Vec<f64> {
    type Written = Vec<Written>;

    fn write(&self) -> Vec<Written> {
        self.iter().map(Exact::write).collect()
    }

    fn read(written: Vec<Written>) -> Result<Self, ParseFloatError> {
        written.into_iter().map(f64::read).collect()
    }
}

impl Exact for Option<f64> {
    type Written = Option<Written>;

    fn write(&self) -> Option<Written> {
        self.as_ref().map(Exact::write)
    }

    fn read(written: Option<Written>) -> Result<Self, ParseFloatError> {
        written.map(f64::read).transpose()
    }
}

/// For `#[serde(with = "exact")]`.
pub(super) fn serialize<T: Exact, S: Serializer>(value: &T, serializer: S) -> Result<S::Ok, S::Error> {
    value.write().serialize(serializer)
}

/// For `#[serde(with = "exact")]`.
pub(super) fn deserialize<'de, T: Exact, D: Deserializer<'de>>(deserializer: D) -> Result<T, D::Error> {
    T::read(T::Written::deserialize(deserializer)?).map_err(de::Error::custom)
}
