//! Checks of input: sizes, finite numbers, intervals, settings.

use crate::linalg::first_non_finite;
use crate::{InputError, Vector};

pub(crate) fn check_size(what: &'static str, expected: usize, found: usize) -> Result<(), InputError> {
    if expected == found { Ok(()) } else { Err(InputError::Dimension { what, expected, found }) }
}

pub(crate) fn check_finite(what: &'static str, values: &[f64]) -> Result<(), InputError> {
    match first_non_finite(values) {
        Some(index) => Err(InputError::NotFinite { what, index, value: values[index] }),
        None => Ok(()),
    }
}

impl InputError {
    /// Refuses a vector with more or fewer entries than expected, or with one that is not finite; `what` names it in
    /// the message.
    ///
    /// # Errors
    /// [`InputError::Dimension`], [`InputError::NotFinite`].
    pub fn check_vector(what: &'static str, expected: usize, vector: &Vector) -> Result<(), Self> {
        check_size(what, expected, vector.len())?;
        check_finite(what, vector.as_slice())
    }
}

/// Refuses sides of which one is NaN or no number lies between.
pub(crate) fn check_intervals(what: &'static str, lower: &Vector, upper: &Vector) -> Result<(), InputError> {
    for (index, (&lower, &upper)) in lower.iter().zip(upper.iter()).enumerate() {
        for value in [lower, upper] {
            if value.is_nan() {
                return Err(InputError::NotFinite { what, index, value });
            }
        }
        if lower > upper || lower == f64::INFINITY || upper == f64::NEG_INFINITY {
            return Err(InputError::EmptyInterval { what, index, lower, upper });
        }
    }
    Ok(())
}

/// Refuses a setting unless it is `valid`.
pub(crate) fn check_setting(
    setting: &'static str,
    value: impl std::fmt::Debug,
    allowed: &'static str,
    valid: bool,
) -> Result<(), InputError> {
    if valid { Ok(()) } else { Err(InputError::OutOfRange { setting, value: format!("{value:?}"), allowed }) }
}
