//! Control files: a JSON array of numbers.

use crate::contact_shape::ContactShape;
use crate::error::SceneError;
use nonsmooth::{StateSolver, Vector};
use std::path::Path;

/// The controls of a file, or those the scene starts from; checked against the admissible set.
///
/// # Errors
/// [`SceneError`] for an unreadable file, a wrong count, numbers that are not finite, controls outside U.
pub fn load(shape: &ContactShape, file: Option<&Path>) -> Result<Vector, SceneError> {
    let controls = match file {
        Some(file) => read(file, shape.control_dimension())?,
        None => shape.start(),
    };
    shape.problem().admissible.check(&controls)?;
    Ok(controls)
}

fn read(file: &Path, expected: usize) -> Result<Vector, SceneError> {
    let failed = |reason: String| SceneError::File { path: file.display().to_string(), reason };
    let text = std::fs::read_to_string(file).map_err(|error| failed(error.to_string()))?;
    let values: Vec<Option<f64>> = serde_json::from_str(&text)
        .map_err(|error| failed(format!("{error}; expected a JSON array of {expected} numbers")))?;
    if values.len() != expected {
        let what = format!("controls in {}", file.display());
        return Err(SceneError::WrongCount { what, expected, found: values.len() });
    }
    let mut controls = Vector::zeros(expected);
    for (index, value) in values.into_iter().enumerate() {
        controls[index] = value.filter(|value| value.is_finite()).ok_or_else(|| {
            SceneError::out_of_range(format!("control {index} in {}", file.display()), "null", "a finite number (mm)")
        })?;
    }
    Ok(controls)
}
