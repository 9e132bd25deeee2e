//! Numbers in JSON without loss: the shortest text that reads back as the same bits, and words for what JSON lacks.

use serde::{Deserialize, Deserializer, Serialize, Serializer};

/// A number as it stands in the file.
#[derive(Serialize, Deserialize)]
#[serde(untagged)]
pub(super) enum Written {
    Finite(f64),
    Other(Word),
}

#[derive(Serialize, Deserialize)]
pub(super) enum Word {
    #[serde(rename = "inf")]
    Infinity,
    #[serde(rename = "-inf")]
    MinusInfinity,
    #[serde(rename = "nan")]
    NotANumber,
}

/// A number, or several, with their written form.
pub(super) trait Exact: Sized {
    type Written: Serialize + for<'de> Deserialize<'de>;
    fn write(&self) -> Self::Written;
    fn read(written: Self::Written) -> Self;
}

impl Exact for f64 {
    type Written = Written;

    fn write(&self) -> Written {
        match *self {
            x if x.is_finite() => Written::Finite(x),
            x if x.is_nan() => Written::Other(Word::NotANumber),
            x if x > 0.0 => Written::Other(Word::Infinity),
            _ => Written::Other(Word::MinusInfinity),
        }
    }

    fn read(written: Written) -> Self {
        match written {
            Written::Finite(x) => x,
            Written::Other(Word::Infinity) => Self::INFINITY,
            Written::Other(Word::MinusInfinity) => Self::NEG_INFINITY,
            Written::Other(Word::NotANumber) => Self::NAN,
        }
    }
}

impl Exact for Vec<f64> {
    type Written = Vec<Written>;

    fn write(&self) -> Vec<Written> {
        self.iter().map(Exact::write).collect()
    }

    fn read(written: Vec<Written>) -> Self {
        written.into_iter().map(f64::read).collect()
    }
}

impl Exact for Option<f64> {
    type Written = Option<Written>;

    fn write(&self) -> Option<Written> {
        self.as_ref().map(Exact::write)
    }

    fn read(written: Option<Written>) -> Self {
        written.map(f64::read)
    }
}

/// For `#[serde(with = "exact")]`.
pub(super) fn serialize<T: Exact, S: Serializer>(value: &T, serializer: S) -> Result<S::Ok, S::Error> {
    value.write().serialize(serializer)
}

/// For `#[serde(with = "exact")]`.
pub(super) fn deserialize<'de, T: Exact, D: Deserializer<'de>>(deserializer: D) -> Result<T, D::Error> {
    T::Written::deserialize(deserializer).map(T::read)
}
