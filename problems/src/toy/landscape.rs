//! The toy's objective on a regular grid over the admissible box, for plots.

use super::{LOWER, NodeStatus, ToyObjective, UPPER};
use nonsmooth::{Accuracy, Cost, InputError, OracleError, StateSolver, Vector};
use std::io::{self, Write};

/// One point of the landscape.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LandscapePoint {
    /// The control α.
    pub control: [f64; 2],
    /// Θ(α).
    pub value: f64,
    /// Status of both nodes; its changes draw the kink lines.
    pub status: [NodeStatus; 2],
}

/// Values of Θ at (cells + 1)² points, the second control running fastest.
#[derive(Debug, Clone, PartialEq)]
pub struct Landscape {
    /// Grid cells per edge.
    pub cells: usize,
    /// The points, row by row.
    pub points: Vec<LandscapePoint>,
}

/// Largest number of grid cells per edge.
pub const MAX_CELLS: usize = 4096;

impl Landscape {
    /// Evaluates Θ on the grid with `cells` cells per edge of the admissible box.
    ///
    /// # Errors
    /// [`InputError::OutOfRange`] (inside an [`OracleError`]) unless 1 ≤ cells ≤ [`MAX_CELLS`].
    ///
    /// ```
    /// use problems::toy::{landscape::Landscape, toy_objective};
    /// let landscape = Landscape::new(&toy_objective(), 4)?;
    /// assert_eq!(landscape.points.len(), 25);
    /// # Ok::<(), nonsmooth::OracleError>(())
    /// ```
    pub fn new(objective: &ToyObjective, cells: usize) -> Result<Self, OracleError> {
        if !(1..=MAX_CELLS).contains(&cells) {
            let (setting, value) = ("landscape cells", cells.to_string());
            return Err(InputError::OutOfRange { setting, value, allowed: "1 to 4096" }.into());
        }
        let coordinate = |i: usize| LOWER + (UPPER - LOWER) * i as f64 / cells as f64;
        let mut points = Vec::with_capacity((cells + 1).pow(2));
        for i in 0..=cells {
            for j in 0..=cells {
                points.push(point(objective, [coordinate(i), coordinate(j)])?);
            }
        }
        Ok(Self { cells, points })
    }

    /// The point with the smallest value; none on an empty landscape.
    pub fn lowest(&self) -> Option<&LandscapePoint> {
        self.points.iter().min_by(|a, b| a.value.total_cmp(&b.value))
    }

    /// Writes one line per point: `control_1,control_2,objective,status_1,status_2`, with a heading.
    ///
    /// # Errors
    /// Whatever the writer reports.
    pub fn write_csv(&self, writer: &mut impl Write) -> io::Result<()> {
        writeln!(writer, "control_1,control_2,objective,status_1,status_2")?;
        for LandscapePoint { control: [first, second], value, status: [left, right] } in &self.points {
            writeln!(writer, "{first},{second},{value},{left},{right}")?;
        }
        Ok(())
    }
}

fn point(objective: &ToyObjective, control: [f64; 2]) -> Result<LandscapePoint, OracleError> {
    let at = Vector::from_row_slice(&control);
    let state = objective.solver().solve(&at, None, Accuracy::TIGHTEST)?;
    let value = objective.cost().value(&at, &state);
    Ok(LandscapePoint { control, value, status: state.nodes.map(|node| node.status) })
}
