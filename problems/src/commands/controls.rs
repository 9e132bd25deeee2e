//! Control files: a JSON array of rows of heights, or one of displacements of the control points of a lattice; of
//! several bodies, one of all their controls, body by body.

use crate::commands::arguments::HeightError;
use crate::commands::failure::Failure;
use crate::commands::folder::file_error;
use contact::equilibrium::ContactProblem;
use contact::error::SceneError;
use contact::scene::Scene;
use nonsmooth::Vector;
use nonsmooth::verify::seeded_direction;
use scene_file::{Case, read_text};
use serde::Deserialize;
use std::path::Path;

/// The option that names the controls at which an optimization starts.
pub const START_OPTION: &str = "--start-controls";
/// Largest control file, bytes.
const LARGEST_FILE: u64 = 1 << 20;

/// The controls of a file that an option names, or those the case starts from. Where an optimization starts they lie in
/// the admissible set; of shapes that are only looked at, heights and slopes do.
///
/// # Errors
/// [`SceneError`] for an unreadable file, another grid or count, numbers that are not finite, controls outside U.
pub fn load(
    problem: &ContactProblem,
    case: &Case,
    (option, file): (&str, Option<&Path>),
) -> Result<Vector, SceneError> {
    let place = match (file, problem.scene.heights()) {
        (Some(_), _) => option.to_owned(),
        (None, Some(_)) => "lattice.start".to_owned(),
        (None, None) => format!("the start of the scene, where nothing is displaced ({option} FILE names another)"),
    };
    let within = |source| SceneError::InFile { file: place.clone(), source: Box::new(source) };
    let controls = match file {
        Some(file) => read(file, Layout::of(&problem.scene)).map_err(within)?,
        None => Vector::from_vec(case.start_controls()),
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
pub fn read(file: &Path, layout: Layout) -> Result<Vector, SceneError> {
    let text = read_text(file, LARGEST_FILE)?;
    parse(&text, &file.display().to_string(), layout)
}

/// How the controls of a scene stand in a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Layout {
    /// Heights of so many control points along x₁ and x₂, in rows.
    Grid([usize; 2]),
    /// So many displacements or heights, one after the other.
    Plain(usize),
}

impl Layout {
    /// The layout of the controls of a scene: rows of heights of the only optimized body, else one list, body by body.
    pub fn of(scene: &Scene) -> Self {
        match scene.heights() {
            Some(heights) => Self::Grid([heights.control_points[0], heights.control_points[1]]),
            None => Self::Plain(scene.control_count()),
        }
    }

    /// Number of controls.
    pub fn count(self) -> usize {
        match self {
            Self::Grid(counts) => counts.iter().product(),
            Self::Plain(count) => count,
        }
    }
}

/// The controls in a text; `name` stands in messages. Rows say the grid that they are made for; a plain array of
/// numbers does not.
///
/// # Errors
/// [`SceneError`] for a text that holds neither, another grid, a wrong count, numbers that are not finite.
pub fn parse(text: &str, name: &str, layout: Layout) -> Result<Vector, SceneError> {
    let count = layout.count();
    let expected = match layout {
        Layout::Grid([n1, n2]) => format!("expected {n1} arrays of {n2} numbers, or one array of {count}"),
        Layout::Plain(_) => format!("expected one array of {count} numbers"),
    };
    let unreadable = |reason: String| file_error(Path::new(name), format!("{reason}; {expected}"));
    let rows: Rows = serde_json::from_str(text).map_err(|error| unreadable(error.to_string()))?;
    let values = match rows {
        Rows::Plain(values) => {
            check_count(values.len(), count, name)?;
            values
        }
        Rows::Grid(rows) => {
            let found = [rows.len(), rows.iter().map(Vec::len).max().unwrap_or(0)];
            if rows.iter().any(|row| row.len() != found[1]) {
                return Err(unreadable("rows of different lengths".into()));
            }
            let Layout::Grid(counts) = layout else { return Err(unreadable("rows of controls".into())) };
            check_grid(found, counts, name)?;
            rows.concat()
        }
    };
    let mut controls = Vector::zeros(count);
    for (index, value) in values.into_iter().enumerate() {
        controls[index] = value.filter(|value| value.is_finite()).ok_or_else(|| {
            SceneError::out_of_range(format!("control {index} in {name}"), "null", "a finite number (mm)")
        })?;
    }
    Ok(controls)
}

/// What a control file may hold; null stands for a number that is not finite.
#[derive(Deserialize)]
#[serde(untagged, expecting = "no JSON array of numbers, nor one of such arrays")]
enum Rows {
    Plain(Vec<Option<f64>>),
    Grid(Vec<Vec<Option<f64>>>),
}

/// Controls as a control file holds them: one row per control point along x₁, or one list.
///
/// # Errors
/// [`Failure::Computation`] for a number that JSON does not have.
pub fn written(controls: &[f64], layout: Layout) -> Result<String, Failure> {
    let along = match layout {
        Layout::Grid([_, along]) => along,
        Layout::Plain(_) => {
            return serde_json::to_string(controls).map(|text| text + "\n").map_err(Failure::computation);
        }
    };
    let rows: Result<Vec<String>, _> = controls.chunks(along.max(1)).map(serde_json::to_string).collect();
    Ok(format!("[\n  {}\n]\n", rows.map_err(Failure::computation)?.join(",\n  ")))
}

/// Refuses controls of another layout; `name` says where they stand.
///
/// # Errors
/// [`SceneError`] with both layouts.
pub fn check_layout(found: Layout, expected: Layout, name: &str) -> Result<(), SceneError> {
    match (found, expected) {
        (Layout::Grid(found), Layout::Grid(expected)) => check_grid(found, expected, name),
        _ => check_count(found.count(), expected.count(), name),
    }
}

/// Refuses controls of another grid; `name` says where they stand.
///
/// # Errors
/// [`SceneError::OutOfRange`] with both grids.
fn check_grid(found: [usize; 2], expected: [usize; 2], name: &str) -> Result<(), SceneError> {
    let words = |[n1, n2]: [usize; 2]| format!("{n1}x{n2}");
    if found == expected {
        return Ok(());
    }
    let allowed = format!("{}, the control points of the scene along x1 and x2", words(expected));
    Err(SceneError::out_of_range(format!("the grid of the controls in {name}"), words(found), allowed))
}

/// Refuses a wrong number of controls.
fn check_count(found: usize, expected: usize, name: &str) -> Result<(), SceneError> {
    match found == expected {
        true => Ok(()),
        false => Err(SceneError::WrongCount { what: format!("controls in {name}"), expected, found }),
    }
}

/// Controls with the error of a workshop, if one is asked for: every height is off by the same amount, with signs that
/// depend on the seed alone. The admissible set binds what is designed, not what is made of it.
pub fn as_made(controls: Vector, error: &HeightError) -> Vector {
    let Some(size) = error.height_error else { return controls };
    let signs = seeded_direction(controls.len(), error.seed.unwrap_or(1));
    controls.zip_map(&signs, |height, sign| height + size.copysign(sign))
}
