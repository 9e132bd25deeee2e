//! Heights where lines along two axes cross.

use crate::error::{ExchangeError, all_finite, ascending, counted};
use std::fmt::Write;

/// Heights x₃ over a rectangle, at the crossings of lines x₁ = const and x₂ = const.
#[derive(Debug, Clone, PartialEq)]
pub struct Heights {
    lines: [Vec<f64>; 2],
    values: Vec<f64>,
}

impl Heights {
    /// Heights (mm) at the crossings of `lines` (mm), row major: index i·n₂ + j with i along x₁.
    ///
    /// # Errors
    /// [`ExchangeError::Count`] unless there are at least two lines per axis and a height for every crossing,
    /// [`ExchangeError::Number`] for a number that is not finite or a line that is not beyond the one before.
    pub fn new(lines: [Vec<f64>; 2], values: Vec<f64>) -> Result<Self, ExchangeError> {
        for lines in &lines {
            counted("lines along an axis", lines.len().max(2), lines.len())?;
            all_finite("line", lines)?;
            ascending(lines)?;
        }
        counted("heights", lines[0].len() * lines[1].len(), values.len())?;
        all_finite("height", &values)?;
        Ok(Self { lines, values })
    }

    /// Lines per axis.
    pub fn counts(&self) -> [usize; 2] {
        [self.lines[0].len(), self.lines[1].len()]
    }

    /// The lines, mm.
    pub fn lines(&self) -> &[Vec<f64>; 2] {
        &self.lines
    }

    /// The crossings (x₁, x₂, x₃) in order, mm.
    pub fn points(&self) -> impl Iterator<Item = [f64; 3]> + '_ {
        let places = self.lines[0].iter().flat_map(|&x1| self.lines[1].iter().map(move |&x2| [x1, x2]));
        places.zip(&self.values).map(|([x1, x2], &height)| [x1, x2, height])
    }

    /// A table `x1,x2,height` (mm) with a line per crossing; `comment` stands at the head of the file.
    pub fn csv(&self, comment: &str) -> String {
        let [n1, n2] = self.counts();
        let mut text = String::new();
        for line in comment.lines() {
            // Writing to a string does not fail.
            let _ = writeln!(text, "# {line}");
        }
        let _ = writeln!(text, "# {n1} x {n2} points in rows along x2; lengths in mm\nx1,x2,height");
        for [x1, x2, height] in self.points() {
            let _ = writeln!(text, "{x1},{x2},{height}");
        }
        text
    }
}
