//! Sparse matrices as text: the coordinate format of Matrix Market.
//!
//! ```text
//! %%MatrixMarket matrix coordinate real general|symmetric
//! rows columns entries
//! row column value                                          one line per entry, counted from 1
//! ```
//! Format: *The Matrix Market Exchange Formats*, NIST. Values are written so that they are read back bit by bit.

use crate::error::ExchangeError;
use std::fmt::Write;

/// An entry: row and column, counted from 0, and value.
pub type Entry = (usize, usize, f64);

/// A matrix of `rows` × `columns`; `comment` stands at the head of the file.
///
/// # Errors
/// [`ExchangeError::Entry`] for an entry outside the matrix, [`ExchangeError::Number`] for a value that is not finite.
pub fn general([rows, columns]: [usize; 2], entries: &[Entry], comment: &str) -> Result<String, ExchangeError> {
    let allowed = || format!("rows below {rows}, columns below {columns}");
    text("general", [rows, columns], entries, comment, |row, column| row < rows && column < columns, allowed)
}

/// A symmetric matrix by the entries of its lower triangle; `comment` stands at the head of the file.
///
/// # Errors
/// [`ExchangeError::Entry`] for an entry above the diagonal or outside the matrix, [`ExchangeError::Number`] for a
/// value that is not finite.
pub fn symmetric(dimension: usize, lower: &[Entry], comment: &str) -> Result<String, ExchangeError> {
    let allowed = || format!("column ≤ row < {dimension}");
    text("symmetric", [dimension; 2], lower, comment, |row, column| column <= row && row < dimension, allowed)
}

fn text(
    kind: &str,
    [rows, columns]: [usize; 2],
    entries: &[Entry],
    comment: &str,
    is_allowed: impl Fn(usize, usize) -> bool,
    allowed: impl Fn() -> String,
) -> Result<String, ExchangeError> {
    let mut text = format!("%%MatrixMarket matrix coordinate real {kind}\n");
    // Writing to a string does not fail.
    for line in comment.lines() {
        let _ = writeln!(text, "% {line}");
    }
    let _ = writeln!(text, "{rows} {columns} {}", entries.len());
    for (index, &(row, column, value)) in entries.iter().enumerate() {
        if !is_allowed(row, column) {
            return Err(ExchangeError::Entry { index, row, column, allowed: allowed() });
        }
        if !value.is_finite() {
            return Err(ExchangeError::Number { what: "matrix entry", index, value, allowed: "finite numbers" });
        }
        let _ = writeln!(text, "{} {} {value:e}", row + 1, column + 1);
    }
    Ok(text)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_small_matrix_is_written_as_the_format_says() {
        let entries = [(0, 0, 2.0), (1, 0, -0.1), (1, 1, 1e-300)];
        let text = symmetric(2, &entries, "one\ntwo").expect("a lower triangle");
        let expected =
            "%%MatrixMarket matrix coordinate real symmetric\n% one\n% two\n2 2 3\n1 1 2e0\n2 1 -1e-1\n2 2 1e-300\n";
        assert_eq!(text, expected);
        assert!(general([1, 3], &[(0, 2, 4.5)], "").expect("inside").ends_with("general\n1 3 1\n1 3 4.5e0\n"));
    }

    #[test]
    fn entries_outside_and_numbers_that_are_none_are_refused() {
        assert!(matches!(symmetric(2, &[(0, 1, 1.0)], ""), Err(ExchangeError::Entry { row: 0, column: 1, .. })));
        assert!(matches!(general([2, 2], &[(2, 0, 1.0)], ""), Err(ExchangeError::Entry { index: 0, .. })));
        assert!(matches!(general([2, 2], &[(0, 0, f64::NAN)], ""), Err(ExchangeError::Number { .. })));
    }
}
