//! Grids of heights or pressures from CSV files.

use crate::text::read_text;
use contact::error::SceneError;
use contact::scene::HeightGrid;
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

/// Numbers of a file, in a unit for messages, over a base of the given size: one line per x₁, one column per x₂.
pub(super) fn read(file: &Path, size: [f64; 2], unit: &str) -> Result<HeightGrid, SceneError> {
    let failed = |reason: String| SceneError::File { path: file.display().to_string(), reason };
    let text = read_grid(file)?;
    let mut heights = Vec::new();
    let mut counts = [0, 0];
    let lines = text.lines().enumerate().filter(|(_, line)| !line.trim().is_empty() && !line.trim().starts_with('#'));
    for (number, line) in lines {
        let numbers = line.split(',').map(|entry| entry.trim().parse::<f64>().ok().filter(|height| height.is_finite()));
        let numbers: Option<Vec<f64>> = numbers.collect();
        let Some(numbers) = numbers else {
            return Err(failed(format!("line {}: expected finite numbers ({unit}) separated by commas", number + 1)));
        };
        if counts[0] > 0 && numbers.len() != counts[1] {
            let (found, expected) = (numbers.len(), counts[1]);
            return Err(failed(format!("line {}: {found} numbers, the lines above have {expected}", number + 1)));
        }
        counts = [counts[0] + 1, numbers.len()];
        heights.extend(numbers);
    }
    if counts.iter().any(|count| !(2..=LARGEST).contains(count)) {
        return Err(failed(format!("{} lines of {} numbers; allowed: 2 to {LARGEST} of each", counts[0], counts[1])));
    }
    HeightGrid::new(size, counts, heights)
}
