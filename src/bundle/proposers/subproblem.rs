//! The quadratic program around a point that every proposer solves, with its own metric and cuts.
//!
//! ```text
//! min over (d, v)  v + ½ dᵀHd,   ⟨h_i, d⟩ − a_i ≤ v,   x̂ + d ∈ U
//! ```

use super::proposal::FEASIBILITY;
use crate::qp::{EpigraphQp, EpigraphQpSolver, Gram, Metric, QpError, QpSolution};
use crate::{Polyhedron, Vector};

/// A center may violate a row by this much relative to its terms; d = 0 is admissible nevertheless.
const LARGEST_VIOLATION: f64 = 1e-8;

/// Slopes h_i, offsets a_i and identities of cuts.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Cuts<'a> {
    pub slopes: &'a [Vector],
    pub offsets: &'a [f64],
    pub ids: &'a [u64],
    /// Inner products of the slopes, only where the metric is that of the run times a weight.
    pub gram: Option<Gram<'a>>,
}

impl Cuts<'_> {
    /// max_i ⟨h_i, d⟩ − a_i.
    pub(crate) fn change(&self, d: &Vector) -> f64 {
        self.slopes.iter().zip(self.offsets).map(|(h, a)| h.dot(d) - a).fold(f64::NEG_INFINITY, f64::max)
    }
}

/// Solves the quadratic program around `center` with the metric H.
pub(crate) fn solve(
    solver: &mut EpigraphQpSolver,
    set: &Polyhedron,
    center: &Vector,
    metric: Metric<'_>,
    cuts: Cuts<'_>,
) -> Result<QpSolution, QpError> {
    let room = Room::around(set, center);
    let qp = EpigraphQp {
        metric,
        slopes: cuts.slopes,
        offsets: cuts.offsets,
        cut_ids: cuts.ids,
        rows: set.rows(),
        row_lower: &room.rows.0,
        row_upper: &room.rows.1,
        lower: &room.bounds.0,
        upper: &room.bounds.1,
    };
    match cuts.gram {
        Some(gram) => solver.solve_with_products(&qp, gram),
        None => solver.solve(&qp),
    }
}

/// The admissible set as seen from a point: lower and upper sides of A d and of d.
pub(crate) struct Room {
    pub rows: (Vector, Vector),
    pub bounds: (Vector, Vector),
}

impl Room {
    pub(crate) fn around(set: &Polyhedron, center: &Vector) -> Self {
        let at_center = set.rows() * center;
        let terms = set.rows().abs() * center.abs();
        let own = set.rows().nrows() - set.tangents();
        let lower = slack(set.row_lower(), &at_center, &terms, own, f64::min);
        let upper = slack(set.row_upper(), &at_center, &terms, own, f64::max);
        Self { rows: (lower, upper), bounds: (set.lower() - center, set.upper() - center) }
    }
}

/// Sides of the rows as seen from the center. A violation that is rounding of the center counts as zero, so that d = 0
/// is admissible; a row that the center violates by more is one that the step is to reach.
fn slack(side: &Vector, at_center: &Vector, terms: &Vector, own: usize, outward: fn(f64, f64) -> f64) -> Vector {
    Vector::from_fn(side.len(), |i, _| {
        let slack = side[i] - at_center[i];
        let size = terms[i].max(side[i].abs());
        if i >= own {
            slack
        } else if slack.is_finite() && slack.abs() <= FEASIBILITY * size {
            0.0
        } else if slack.abs() <= LARGEST_VIOLATION * size {
            outward(slack, 0.0)
        } else {
            slack
        }
    })
}
