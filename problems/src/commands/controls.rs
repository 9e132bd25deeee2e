//! Control files: a JSON array of numbers.

use crate::commands::arguments::Arguments;
use crate::commands::folder::file_error;
use contact::equilibrium::ContactProblem;
use contact::error::SceneError;
use nonsmooth::Vector;
use nonsmooth::verify::seeded_direction;
use scene_file::{Case, read_text};
use std::path::Path;

/// The option that names the controls at which an optimization starts.
pub const START_OPTION: &str = "--start-controls";
/// Largest control file, bytes.
const LARGEST_FILE: u64 = 1 << 20;

/// The controls of a file that an option names, or those the case starts from. Where an optimization starts they lie in the admissible
/// set; of shapes that are only looked at, heights and slopes do.
///
/// # Errors
/// [`SceneError`] for an unreadable file, a wrong count, numbers that are not finite, controls outside U.
pub fn load(
    problem: &ContactProblem,
    case: &Case,
    (option, file): (&str, Option<&Path>),
) -> Result<Vector, SceneError> {
    let place = file.map_or_else(|| "surface.start".to_owned(), |_| option.to_owned());
    let within = |source| SceneError::InFile { file: place.clone(), source: Box::new(source) };
    let dimension = problem.scene.control_points.iter().product();
    let controls = match (file, &case.start) {
        (Some(file), _) => read(file, dimension).map_err(within)?,
        (None, Some(controls)) => Vector::from_column_slice(controls),
        (None, None) => Vector::from_element(dimension, problem.scene.start_height),
    };
    let set = &problem.admissible;
    let checked = if option == START_OPTION { set.check(&controls) } else { set.check_shape(&controls) };
    checked.map_err(within)?;
    Ok(controls)
}

/// The controls of a file.
///
/// # Errors
/// [`SceneError`] for an unreadable file; as [`parse`].
pub fn read(file: &Path, expected: usize) -> Result<Vector, SceneError> {
    let text = read_text(file, LARGEST_FILE)?;
    parse(&text, &file.display().to_string(), expected)
}

/// The controls in a text; `name` stands in messages.
///
/// # Errors
/// [`SceneError`] for a text that is no JSON array, a wrong count, numbers that are not finite.
pub fn parse(text: &str, name: &str, expected: usize) -> Result<Vector, SceneError> {
    let values: Vec<Option<f64>> = serde_json::from_str(text).map_err(|error| {
        file_error(Path::new(name), format!("{error}; expected a JSON array of {expected} numbers"))
    })?;
    check_count(values.len(), expected, name)?;
    let mut controls = Vector::zeros(expected);
    for (index, value) in values.into_iter().enumerate() {
        controls[index] = value.filter(|value| value.is_finite()).ok_or_else(|| {
            SceneError::out_of_range(format!("control {index} in {name}"), "null", "a finite number (mm)")
        })?;
    }
    Ok(controls)
}

/// Refuses a wrong number of controls; `name` says where they stand.
///
/// # Errors
/// [`SceneError::WrongCount`].
pub fn check_count(found: usize, expected: usize, name: &str) -> Result<(), SceneError> {
    match found == expected {
        true => Ok(()),
        false => Err(SceneError::WrongCount { what: format!("controls in {name}"), expected, found }),
    }
}

/// Controls with the error of a workshop, if the arguments ask for one: every height is off by the same amount, with signs that depend
/// on the seed alone. The admissible set binds what is designed, not what is made of it.
pub fn as_made(controls: Vector, arguments: &Arguments) -> Vector {
    let Some(error) = arguments.height_error else { return controls };
    let signs = seeded_direction(controls.len(), arguments.seed.unwrap_or(1));
    controls.zip_map(&signs, |height, sign| height + error.copysign(sign))
}
