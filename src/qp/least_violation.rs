//! The least violation of a polyhedron that may be empty.
//!
//! ```text
//! min over y in the box   max_i violation_i(y)/s_i + δ|y − y_k|²/2,   s_i = max(|side|, Σ_j |a_ij y_j|) at y_k
//! ```
//! The violations are the cuts of a program that has a solution whatever the rows are. Its solution is the next y_k: a
//! proximal method, which ends after a few steps because the maximum is piecewise linear.

use super::problem::{EpigraphQp, Metric};
use super::solver::EpigraphQpSolver;
use crate::{Matrix, Polyhedron, Vector};

/// Largest number of steps.
const MAX_STEPS: usize = 20;
/// Weight δ in units of the inverse square of the distances s_i/|a_i|: steps of this length are free.
const WEIGHT: f64 = 1e-3;

/// The least relative violation found among the points of the box, from one of them on. It is that of a point, hence an
/// upper bound of the least one.
pub(super) fn least_violation(set: &Polyhedron, start: &Vector) -> f64 {
    let mut point = start.clone();
    let mut least = set.violation(&point);
    for _ in 0..MAX_STEPS {
        let Some(next) = lower(set, &point) else { break };
        let violation = set.violation(&next);
        if violation >= least {
            break;
        }
        (point, least) = (next, violation);
    }
    least
}

/// The next point; none where the program is not solved.
fn lower(set: &Polyhedron, point: &Vector) -> Option<Vector> {
    let n = point.len();
    // No violation is below zero.
    let (mut slopes, mut offsets, mut farthest) = (vec![Vector::zeros(n)], vec![0.0], 0.0_f64);
    for (i, row) in set.rows().row_iter().enumerate() {
        let row = row.transpose();
        let (value, terms) = (row.dot(point), row.abs().dot(&point.abs()));
        for (side, sign) in [(set.row_upper()[i], 1.0), (set.row_lower()[i], -1.0)] {
            let scale = side.abs().max(terms);
            if !(side.is_finite() && row.norm() > 0.0) {
                continue;
            }
            // A row through the origin, seen from there: every scale is as good.
            let scale = if scale > 0.0 { scale } else { row.norm() };
            farthest = farthest.max(scale / row.norm());
            slopes.push(&row * (sign / scale));
            offsets.push(sign * (side - value) / scale);
        }
    }
    let ids: Vec<u64> = (0..slopes.len() as u64).collect();
    let none = Vector::zeros(0);
    let qp = EpigraphQp {
        metric: Metric::ScaledIdentity(WEIGHT / (farthest * farthest).max(f64::MIN_POSITIVE)),
        slopes: &slopes,
        offsets: &offsets,
        cut_ids: &ids,
        rows: &Matrix::zeros(0, n),
        row_lower: &none,
        row_upper: &none,
        lower: &(set.lower() - point),
        upper: &(set.upper() - point),
    };
    let step = EpigraphQpSolver::new().solve(&qp).ok()?.step;
    Some(set.clamp_to_box(&(point + step)))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn set(rows: &[f64], sides: (&[f64], &[f64]), box_side: f64) -> Polyhedron {
        let count = sides.0.len();
        let rows = Matrix::from_row_slice(count, 2, rows);
        Polyhedron::boxed(Vector::zeros(2), Vector::from_element(2, box_side))
            .and_then(|set| {
                set.with_rows(&rows, &Vector::from_column_slice(sides.0), &Vector::from_column_slice(sides.1))
            })
            .expect("valid set")
    }

    #[test]
    fn the_violation_is_that_of_the_best_point_whatever_the_start() {
        for gap in [1e-1, 1e-4, 1e-7, 1e-9] {
            let corner = set(&[1.0, 1.0], (&[2.0 + gap], &[f64::INFINITY]), 1.0);
            // Two rows 1 ± gap, and the half-way point.
            let strip = set(&[1.0, 1.0, 1.0, 1.0], (&[f64::NEG_INFINITY, 1.0 + gap], &[1.0 - gap, f64::INFINITY]), 1e6);
            for start in [[0.0, 0.0], [1.0, 0.0], [0.3, 1.0]] {
                let start = Vector::from_column_slice(&start);
                for (set, true_violation) in [(&corner, gap / (2.0 + gap)), (&strip, gap)] {
                    let found = least_violation(set, &start);
                    assert!((found / true_violation - 1.0).abs() < 0.2, "{found:e} for {true_violation:e}");
                }
            }
        }
    }
}
