//! The aggregate subgradient of a subproblem and its error, summed from the multipliers themselves rather than taken from the step, so
//! that both hold however inaccurately the subproblem was solved.
//!
//! ```text
//! z̃ = Σ λ_i g_i + Aᵀμ + ν,     slack part of ẽ = Σ slack·|multiplier| at the center
//! ```

use crate::{Polyhedron, Vector};

/// |z̃| entry by entry, plus what rounding of the sum can hide.
pub(crate) fn aggregate_sizes<'g>(
    subgradients: impl Iterator<Item = (f64, &'g Vector)>,
    (rows, bounds): (&Vector, &Vector),
    set: &Polyhedron,
) -> Vector {
    let (mut sum, mut terms) = (bounds.clone(), bounds.abs());
    for (multiplier, subgradient) in subgradients {
        let entries = sum.as_mut_slice().iter_mut().zip(terms.as_mut_slice()).zip(subgradient.as_slice());
        for ((sum, terms), slope) in entries {
            let term = multiplier * slope;
            *sum += term;
            *terms += term.abs();
        }
    }
    sum += set.rows().tr_mul(rows);
    terms += set.rows().abs().tr_mul(&rows.abs());
    sum.abs() + terms * (2.0 * f64::EPSILON)
}

/// Σ slack·|multiplier| at the center.
pub(crate) fn slack_error((rows, bounds): (&Vector, &Vector), center: &Vector, set: &Polyhedron) -> f64 {
    let at_rows = set.rows() * center;
    let sum = add_slacks(0.0, rows, &at_rows, (set.row_lower(), set.row_upper()));
    add_slacks(sum, bounds, center, (set.lower(), set.upper()))
}

/// A sum, plus slack·|multiplier| of the sides of some values.
fn add_slacks(sum: f64, multipliers: &Vector, at: &Vector, (lower, upper): (&Vector, &Vector)) -> f64 {
    let active = multipliers.as_slice().iter().enumerate().filter(|(_, multiplier)| **multiplier != 0.0);
    active.fold(sum, |sum, (i, multiplier)| {
        let slack = if *multiplier > 0.0 { upper[i] - at[i] } else { at[i] - lower[i] };
        sum + multiplier.abs() * slack.max(0.0)
    })
}
