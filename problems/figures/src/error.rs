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
        what: &'static str,
    },
    /// Two numbers that belong together differ.
    #[error("figure {figure}: {found} {what}, expected {expected}")]
    Count {
        /// Name of the figure.
        figure: String,
        /// Name of the quantity that was counted.
        what: &'static str,
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
        /// Name of the quantity.
        what: &'static str,
        /// Its place, counted from 0.
        index: usize,
        /// Value found.
        value: f64,
        /// Description of the allowed values.
        allowed: &'static str,
    },
    /// A factor between points and pixels that gives no picture.
    #[cfg(feature = "png")]
    #[error("pixels per point are {value}, allowed are numbers > 0 that give at most {most} pixels in all")]
    Scale {
        /// Enlargement asked for, pixels per point.
        value: f64,
        /// Largest number of pixels allowed.
        most: u64,
    },
    /// The SVG text was not understood by the renderer, or the picture not written.
    #[cfg(feature = "png")]
    #[error("the figure cannot be drawn: {0}")]
    Drawing(String),
}

/// Checks that every number of a list is allowed.
fn all(
    figure: &str,
    what: &'static str,
    values: impl IntoIterator<Item = f64>,
    allowed: &'static str,
    valid: impl Fn(f64) -> bool,
) -> Result<(), FigureError> {
    match values.into_iter().enumerate().find(|(_, value)| !valid(*value)) {
        None => Ok(()),
        Some((index, value)) => Err(FigureError::Number { figure: figure.to_owned(), what, index, value, allowed }),
    }
}

/// Checks that every number of a list can be drawn.
pub(super) fn finite(
    figure: &str,
    what: &'static str,
    values: impl IntoIterator<Item = f64>,
) -> Result<(), FigureError> {
    // Differences of two numbers, and their multiples by a few, have to be finite as well.
    const MAX_MODULUS: f64 = 1e300;
    all(figure, what, values, "numbers of modulus up to 1e300", |value| value.abs() <= MAX_MODULUS)
}

/// Returns an error if a count differs from the expected one.
pub(super) fn count(figure: &str, what: &'static str, expected: usize, found: usize) -> Result<(), FigureError> {
    match expected == found {
        true => Ok(()),
        false => Err(FigureError::Count { figure: figure.to_owned(), what, expected, found }),
    }
}

/// Checks that there is something.
pub(super) fn some(figure: &str, what: &'static str, found: usize) -> Result<(), FigureError> {
    match found {
        0 => Err(FigureError::Empty { figure: figure.to_owned(), what }),
        _ => Ok(()),
    }
}

/// Checks that a grid has cells along every axis.
pub(super) fn cells(figure: &str, nodes: &[usize]) -> Result<(), FigureError> {
    let nodes = nodes.iter().map(|nodes| *nodes as f64);
    all(figure, "number of nodes along axis", nodes, "numbers from 2", |nodes| nodes >= 2.0)
}

/// Checks a grid over a rectangle: cells along both axes, an area, a finite value per node; `what` names a value and
/// all values.
pub(super) fn grid(
    figure: &str,
    counts: [usize; 2],
    size: [f64; 2],
    what: [&'static str; 2],
    values: &[f64],
) -> Result<(), FigureError> {
    cells(figure, &counts)?;
    count(figure, what[1], counts[0].saturating_mul(counts[1]), values.len())?;
    finite(figure, what[0], values.iter().copied())?;
    positive(figure, "side", size)
}

/// Checks that every length is a finite number > 0.
pub(super) fn positive(figure: &str, what: &'static str, lengths: [f64; 2]) -> Result<(), FigureError> {
    finite(figure, what, lengths)?;
    all(figure, what, lengths, "numbers > 0", |length| length > 0.0)
}

/// Checks that every index is one of a list of so many entries.
pub(super) fn below(figure: &str, what: &'static str, indices: &[usize], entries: usize) -> Result<(), FigureError> {
    let indices = indices.iter().map(|index| *index as f64);
    all(figure, what, indices, "places in the list, counted from 0", |index| index < entries as f64)
}
