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
    let rows = set.row_lower().iter().zip(set.row_upper()).zip(at_rows.iter().zip(rows));
    let bounds = set.lower().iter().zip(set.upper()).zip(center.iter().zip(bounds));
    let one = |((lower, upper), (at, multiplier)): ((&f64, &f64), (&f64, &f64))| {
        let slack = if *multiplier > 0.0 { upper - at } else { at - lower };
        if *multiplier == 0.0 { 0.0 } else { multiplier.abs() * slack.max(0.0) }
    };
    rows.chain(bounds).map(one).sum()
}
