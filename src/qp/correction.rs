//! Corrections of points that miss rows by rounding, however small the terms of these rows are.
//!
//! ```text
//! min |D⁻¹ δ|   over   a_i (x + δ) = side that is missed (rows missed, and equality rows),   D_kk = |x_k|
//! ```
//! An entry moves by a share of itself: entries that are rounding of larger ones, in rows that contain no others, then
//! meet these rows, and larger entries do not take them along. An equality row of one entry gives the entry itself.

use crate::{Matrix, Polyhedron, Vector};

/// Largest number of corrections, each of which removes what rounding left of the one before.
const MAX_CORRECTIONS: usize = 10;
/// An entry that falls to this share of itself is zero: what is left is rounding of its correction.
const VANISHED: f64 = 1e-10;
/// Singular values below this share of the largest one are those of rows that depend on others.
const DEPENDENT: f64 = 1e-11;

/// The point, or a correction of it with a lower violation, which is measured near a reference point.
pub(crate) fn corrected(set: &Polyhedron, point: &Vector, reference: &Vector) -> Vector {
    let mut point = determined(set, point);
    let mut best = (set.violation_near(&point, reference), point.clone());
    for _ in 0..MAX_CORRECTIONS {
        let Some(step) = correction(set, &point).filter(|_| best.0 > 0.0) else { break };
        // The worst row may stay as it is while others come to meet theirs.
        let moved = |x: f64, change: f64| if (x + change).abs() <= VANISHED * x.abs() { 0.0 } else { x + change };
        point = determined(set, &point.zip_map(&step, moved));
        let violation = set.violation_near(&point, reference);
        if violation < best.0 {
            best = (violation, point.clone());
        }
    }
    best.1
}

/// The point with the entries that equality rows of one entry give, inside of the box.
fn determined(set: &Polyhedron, point: &Vector) -> Vector {
    let mut point = set.clamp_to_box(point);
    for (i, row) in set.rows().row_iter().enumerate() {
        let mut entries = row.iter().enumerate().filter(|(_, a)| **a != 0.0);
        let (Some((k, a)), None) = (entries.next(), entries.next()) else { continue };
        if set.row_lower()[i] == set.row_upper()[i] {
            point[k] = set.row_lower()[i] / a;
        }
    }
    point
}

/// δ; none where no row asks for one.
fn correction(set: &Polyhedron, point: &Vector) -> Option<Vector> {
    let values = set.rows() * point;
    let sides = (set.row_lower(), set.row_upper());
    let missing = |i: usize| (sides.0[i] - values[i]).max(0.0) + (sides.1[i] - values[i]).min(0.0);
    let asked = |i: &usize| missing(*i) != 0.0 || sides.0[*i] == sides.1[*i];
    let mut scaled = vec![];
    let mut wanted = vec![];
    for i in (0..values.len()).filter(asked) {
        let row = set.rows().row(i).transpose().component_mul(&point.abs());
        let length = row.norm();
        if length > 0.0 {
            wanted.push(missing(i) / length);
            scaled.push((row / length).transpose());
        }
    }
    if scaled.is_empty() {
        return None;
    }
    let parts = Matrix::from_rows(&scaled).try_svd(true, true, f64::EPSILON, 0)?;
    let least = DEPENDENT * parts.singular_values.max();
    let step = parts.solve(&Vector::from_vec(wanted), least).ok()?.component_mul(&point.abs());
    step.iter().all(|entry| entry.is_finite()).then_some(step)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// x₀ = 0 and x₁ = 0 determine x₂ = x₀ + x₁: rounding of a long step leaves entries of 1e-17 that miss every row.
    #[test]
    fn rows_whose_entries_are_all_rounding_are_met() {
        let rows = Matrix::from_row_slice(3, 4, &[1.0, 0.0, 0.0, 0.0, 1.0, 1.0, -1.0, 0.0, 0.0, 1.0, 1.0, 1e-3]);
        let sides = Vector::from_vec(vec![0.0, 0.0, 1.0]);
        let set = Polyhedron::unbounded(4).with_rows(&rows, &sides, &sides).expect("finite");
        let point = Vector::from_vec(vec![1e-17, -3e-17, 4e-17, 1000.0]);
        assert!(set.violation(&point) > 0.5);
        assert!(set.violation(&corrected(&set, &point, &point)) <= 1e-15);
    }
}
