//! Why a figure cannot be drawn.

use thiserror::Error;

/// Why a figure cannot be drawn.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum FigureError {
    /// There is nothing to draw.
    #[error("figure {figure}: no {what}")]
    Empty {
        /// Name of the figure.
        figure: String,
        /// Name of the part that is missing.
        what: String,
    },
    /// Two numbers that belong together differ.
    #[error("figure {figure}: {found} {what}, expected {expected}")]
    Count {
        /// Name of the figure.
        figure: String,
        /// Name of the quantity that was counted.
        what: String,
        /// How many belong there.
        expected: usize,
        /// How many there are.
        found: usize,
    },
    /// A number that cannot be drawn.
    #[error("figure {figure}: {what} {index} is {value}, allowed are {allowed}")]
    Number {
        /// Name of the figure.
        figure: String,
        /// Name of the quantity, with the part of the figure where it is.
        what: String,
        /// Its place, counted from 0.
        index: usize,
        /// Value found.
        value: f64,
        /// Description of the allowed values.
        allowed: &'static str,
    },
    /// A face that is no triangle and no quadrilateral between points.
    #[error(
        "figure {figure}: {part}, face {face} joins the points {points:?}, allowed are 3 or 4 different numbers below \
         {count}"
    )]
    Face {
        /// Name of the figure.
        figure: String,
        /// The part of the figure where it is.
        part: String,
        /// Its place, counted from 0.
        face: usize,
        /// Points found.
        points: Vec<usize>,
        /// How many points there are.
        count: usize,
    },
}

/// Checks that every number of a list is allowed.
fn all(
    figure: &str,
    what: &str,
    values: impl IntoIterator<Item = f64>,
    allowed: &'static str,
    valid: impl Fn(f64) -> bool,
) -> Result<(), FigureError> {
    match values.into_iter().enumerate().find(|(_, value)| !valid(*value)) {
        None => Ok(()),
        Some((index, value)) => {
            Err(FigureError::Number { figure: figure.to_owned(), what: what.to_owned(), index, value, allowed })
        }
    }
}

/// Checks that every number of a list can be drawn.
pub(super) fn finite(figure: &str, what: &str, values: impl IntoIterator<Item = f64>) -> Result<(), FigureError> {
    // Differences of two numbers, and their multiples by a few, have to be finite as well.
    const MAX_MODULUS: f64 = 1e300;
    all(figure, what, values, "numbers of modulus up to 1e300", |value| value.abs() <= MAX_MODULUS)
}

/// Returns an error if a count differs from the expected one.
pub(super) fn count(figure: &str, what: &str, expected: usize, found: usize) -> Result<(), FigureError> {
    match expected == found {
        true => Ok(()),
        false => Err(FigureError::Count { figure: figure.to_owned(), what: what.to_owned(), expected, found }),
    }
}

/// Checks that there is something.
pub(super) fn some(figure: &str, what: &str, found: usize) -> Result<(), FigureError> {
    match found {
        0 => Err(FigureError::Empty { figure: figure.to_owned(), what: what.to_owned() }),
        _ => Ok(()),
    }
}

/// Checks that a part of a figure has points that can be drawn, and faces between them.
pub(super) fn mesh<const AXES: usize>(
    figure: &str,
    part: &str,
    points: &[[f64; AXES]],
    faces: &[Vec<usize>],
) -> Result<(), FigureError> {
    some(figure, &format!("faces in {part}"), faces.len())?;
    for (axis, name) in ["x₁", "x₂", "x₃"].into_iter().enumerate().take(AXES) {
        finite(figure, &format!("{part}, {name} of point"), points.iter().map(|point| point[axis]))?;
    }
    let count = points.len();
    let joins = |face: &[usize]| {
        let different = |index: usize| !face[..index].contains(&face[index]) && face[index] < count;
        (3..=4).contains(&face.len()) && (0..face.len()).all(different)
    };
    match faces.iter().position(|face| !joins(face)) {
        None => Ok(()),
        Some(face) => {
            let points = faces[face].clone();
            Err(FigureError::Face { figure: figure.to_owned(), part: part.to_owned(), face, points, count })
        }
    }
}

/// Checks that every length is a finite number > 0.
pub(super) fn positive(figure: &str, what: &str, lengths: [f64; 2]) -> Result<(), FigureError> {
    finite(figure, what, lengths)?;
    all(figure, what, lengths, "numbers > 0", |length| length > 0.0)
}

/// Checks that every index is one of a list of so many entries.
pub(super) fn below(figure: &str, what: &str, indices: &[usize], entries: usize) -> Result<(), FigureError> {
    let indices = indices.iter().map(|index| *index as f64);
    all(figure, what, indices, "places in the list, counted from 0", |index| index < entries as f64)
}
