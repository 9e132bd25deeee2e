//! Why a file cannot be made.

use thiserror::Error;

/// Why a file cannot be made.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum ExchangeError {
    /// A body without thickness.
    #[error(
        "height {height} mm at ({x1}, {x2}) is not allowed; allowed: heights on one side of {plane} mm, the plane that closes the body"
    )]
    Thickness {
        /// Place along x₁, mm.
        x1: f64,
        /// Place along x₂, mm.
        x2: f64,
        /// The height there, mm.
        height: f64,
        /// Height of the plane, mm.
        plane: f64,
    },
    /// A number that the file cannot hold.
    #[error("{what} {index} is {value}; allowed: {allowed}")]
    Number {
        /// Name of the quantity.
        what: &'static str,
        /// Its place, counted from 0.
        index: usize,
        /// Value found.
        value: f64,
        /// Description of the allowed values.
        allowed: &'static str,
    },
    /// Two numbers that belong together differ.
    #[error("{found} {what}, expected {expected}")]
    Count {
        /// Name of the quantity that was counted.
        what: &'static str,
        /// How many belong there.
        expected: usize,
        /// How many there are.
        found: usize,
    },
    /// An entry outside its matrix.
    #[error("entry {index} stands in row {row}, column {column}; allowed: {allowed}")]
    Entry {
        /// Its place in the list, counted from 0.
        index: usize,
        /// Row, counted from 0.
        row: usize,
        /// Column, counted from 0.
        column: usize,
        /// Description of the allowed values.
        allowed: String,
    },
    /// The STL file was not written or not read.
    #[error("the STL file: {0}")]
    Stl(String),
}

/// What coordinates may be.
const FINITE: &str = "finite numbers in the range of single precision";

/// Refuses numbers that are not finite, or beyond single precision.
pub(crate) fn all_finite(what: &'static str, values: &[f64]) -> Result<(), ExchangeError> {
    match values.iter().position(|value| !(*value as f32).is_finite()) {
        Some(index) => Err(ExchangeError::Number { what, index, value: values[index], allowed: FINITE }),
        None => Ok(()),
    }
}

/// Refuses a list of wrong length.
pub(crate) fn counted(what: &'static str, expected: usize, found: usize) -> Result<(), ExchangeError> {
    if expected == found { Ok(()) } else { Err(ExchangeError::Count { what, expected, found }) }
}
