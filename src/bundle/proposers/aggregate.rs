//! The slack part of the aggregate error, summed from the multipliers themselves rather than taken from the step, so
//! that it holds however inaccurately the subproblem was solved.

use crate::{Polyhedron, Vector};

/// Σ slack·|multiplier| at the center.
pub(crate) fn slack_error(rows: &Vector, bounds: &Vector, center: &Vector, set: &Polyhedron) -> f64 {
    let at_rows = set.rows() * center;
    let sum = add_slacks(0.0, rows, &at_rows, set.row_lower(), set.row_upper());
    add_slacks(sum, bounds, center, set.lower(), set.upper())
}

/// A sum, plus slack·|multiplier| of the sides of some values.
fn add_slacks(sum: f64, multipliers: &Vector, at: &Vector, lower: &Vector, upper: &Vector) -> f64 {
    let active = multipliers.as_slice().iter().enumerate().filter(|(_, multiplier)| **multiplier != 0.0);
    active.fold(sum, |sum, (i, multiplier)| {
        let slack = if *multiplier > 0.0 { upper[i] - at[i] } else { at[i] - lower[i] };
        sum + multiplier.abs() * slack.max(0.0)
    })
}
