//! Grids of heights or pressures, and profiles, from CSV files.

use crate::text::read_text;
use contact::error::SceneError;
use contact::scene::{HeightGrid, Profile};
use std::path::Path;

/// Most numbers along an edge of a grid.
const LARGEST: usize = 2000;

/// Largest file of a grid, bytes.
const LARGEST_FILE: u64 = 128 << 20;

/// The text of a grid file.
///
/// # Errors
/// As [`read_text`].
pub fn read_grid(file: &Path) -> Result<String, SceneError> {
    read_text(file, LARGEST_FILE)
}

/// Longest part of a text that a message repeats, characters.
const LONGEST: usize = 40;

/// Numbers of a file, in a unit for messages, over a base of the given size: one line per x₁, one column per x₂.
///
/// # Errors
/// As [`read_text`]; as [`numbers`], with the file.
pub(super) fn read(file: &Path, size: [f64; 2], unit: &str) -> Result<HeightGrid, SceneError> {
    let within = |source| SceneError::InFile { file: file.display().to_string(), source: Box::new(source) };
    let (counts, heights) = numbers(&read_grid(file)?, unit).map_err(within)?;
    HeightGrid::new(size, counts, heights).map_err(within)
}

/// The curve through the points of a file: radius and height of one per line, mm.
///
/// # Errors
/// As [`read_text`]; as [`numbers`] and [`Profile::new`], with the file.
pub(super) fn profile(file: &Path) -> Result<Profile, SceneError> {
    let within = |source| SceneError::InFile { file: file.display().to_string(), source: Box::new(source) };
    let ([_, columns], values) = numbers(&read_grid(file)?, "mm").map_err(within)?;
    let allowed = "2: radius and height of a point of the profile";
    SceneError::require(columns == 2, "count of numbers per line", columns, allowed).map_err(within)?;
    Profile::new(values.as_chunks::<2>().0.to_vec()).map_err(within)
}

/// Numbers of lines and columns, and the numbers of a text line by line.
///
/// # Errors
/// [`SceneError::OutOfRange`] naming line, column and text of an entry that is no finite number, a line of another
/// length, or the number of lines or columns.
fn numbers(text: &str, unit: &str) -> Result<([usize; 2], Vec<f64>), SceneError> {
    let (mut heights, mut lines, mut first) = (Vec::new(), 0, None);
    let filled = |(_, line): &(usize, &str)| !line.trim().is_empty() && !line.trim().starts_with('#');
    for (number, line) in text.lines().enumerate().map(|(index, line)| (index + 1, line)).filter(filled) {
        let before = heights.len();
        for (column, entry) in line.split(',').map(str::trim).enumerate() {
            heights.push(height(entry).ok_or_else(|| refused_entry([number, column + 1], entry, unit))?);
        }
        let found = heights.len() - before;
        let (of, expected) = *first.get_or_insert((number, found));
        if found != expected {
            let allowed = format!("{expected}, as in line {of}");
            return Err(SceneError::out_of_range(format!("line {number}: count of numbers"), found, allowed));
        }
        lines += 1;
    }
    let counts = [lines, first.map_or(0, |(_, columns)| columns)];
    for (what, count) in ["lines of numbers", "numbers per line"].into_iter().zip(counts) {
        if !(2..=LARGEST).contains(&count) {
            return Err(SceneError::out_of_range(format!("count of {what}"), count, format!("2 to {LARGEST}")));
        }
    }
    Ok((counts, heights))
}

fn height(entry: &str) -> Option<f64> {
    entry.parse::<f64>().ok().filter(|height| height.is_finite())
}

fn refused_entry([line, column]: [usize; 2], entry: &str, unit: &str) -> SceneError {
    let shown: String = entry.chars().take(LONGEST).collect();
    let rest = if shown.len() < entry.len() { "…" } else { "" };
    let allowed = format!("finite numbers ({unit}) such as 1.5e-3, separated by commas; comments begin with #");
    SceneError::out_of_range(format!("line {line}, column {column}"), format!("\"{shown}{rest}\""), allowed)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn refusals_name_line_column_text_and_what_is_allowed() {
        for (text, words) in [
            ("1,2\n3,x4\n", "line 2, column 2 = \"x4\" is not allowed; allowed: finite numbers (mm)"),
            ("# mm\n\n1, 2,\n3, 4\n", "line 3, column 3 = \"\""),
            ("1;2\n3;4\n", "line 1, column 1 = \"1;2\""),
            ("1 2\n3 4\n", "line 1, column 1 = \"1 2\""),
            ("1,2\r\n3,nan\r\n", "line 2, column 2 = \"nan\""),
            ("1,2\n-inf,4\n", "line 2, column 1 = \"-inf\""),
            ("1,1e999\n3,4\n", "line 1, column 2 = \"1e999\""),
            ("1,2\n\n3,4,5\n", "line 3: count of numbers = 3 is not allowed; allowed: 2, as in line 1"),
            ("1,2\n", "count of lines of numbers = 1 is not allowed; allowed: 2 to 2000"),
            ("1\n2\n", "count of numbers per line = 1"),
            ("# nothing\n", "count of lines of numbers = 0"),
        ] {
            let refusal = numbers(text, "mm").expect_err(text).to_string();
            assert!(refusal.starts_with(words) && refusal.contains("; allowed: "), "{text:?}: {refusal}");
        }
        let long = numbers(&"ä".repeat(1000), "mm").expect_err("no number").to_string();
        assert!(long.contains("ää…") && long.chars().count() < 200, "{long}");
        let mut random = testset::kit::Random(1);
        for number in 0..2000 {
            let mut bytes = b"# mm\n1, 2.5, -3e1\n4, 5, 6\n".to_vec();
            for _ in 0..=random.below(3) {
                let at = random.below(bytes.len());
                bytes[at] = b"0a,;.\n# -e+\xff"[random.below(12)];
            }
            let text = String::from_utf8_lossy(&bytes);
            if let Err(refusal) = numbers(&text, "mm") {
                let refusal = refusal.to_string();
                let named = refusal.starts_with("line ") || refusal.starts_with("count of ");
                assert!(named && refusal.contains("; allowed: "), "input {number}, {text:?}: {refusal}");
            }
        }
        assert_eq!(numbers("# mm\n 1, -2e1 \r\n\n.5,4", "mm").ok(), Some(([2, 2], vec![1.0, -20.0, 0.5, 4.0])));
    }
}
