//! From a step and its active members to an answer with its certificate.

use super::certificate::kkt_residual;
use super::kernels::{dot, dot_terms};
use super::problem::{EpigraphQp, QpMethod, QpSolution};
use super::sides::Member;
use super::working_set::Active;
use crate::Vector;

/// Largest residual with which an answer is returned at once; a worse one is tried again by other means.
pub(super) const WANTED: f64 = 1e-12;

/// Completes a step and its multipliers to an answer with certificate; the step is moved into the box unless the
/// certificate suffers (with a large H the rounding of a bound may weigh more than the whole step).
pub(super) fn assemble(
    qp: &EpigraphQp<'_>,
    step: Vector,
    actives: &[Active],
    pivots: usize,
    method: QpMethod,
) -> QpSolution {
    let clamped = Vector::from_fn(step.len(), |k, _| step[k].max(qp.lower[k]).min(qp.upper[k]));
    let unchanged = clamped == step;
    let inside = complete(qp, clamped, actives, pivots, method);
    if unchanged || inside.kkt_residual <= WANTED {
        return inside;
    }
    let outside = complete(qp, step, actives, pivots, method);
    if outside.kkt_residual < inside.kkt_residual { outside } else { inside }
}

/// Differences of values below this share of their terms are rounding.
const ROUNDING: f64 = 1e-12;

/// The answer with v = max_j g_jᵀ d − e_j, or with that of the sharpest active cut where the certificate is better with
/// it.
fn complete(qp: &EpigraphQp<'_>, step: Vector, actives: &[Active], pivots: usize, method: QpMethod) -> QpSolution {
    let epigraph = (0..qp.slopes.len()).map(|j| value(qp, j, &step)).fold(f64::NEG_INFINITY, f64::max);
    let mut solution = QpSolution {
        step,
        epigraph,
        cut_multipliers: vec![0.0; qp.slopes.len()],
        row_multipliers: vec![0.0; qp.rows.nrows()],
        bound_multipliers: vec![0.0; qp.dimension()],
        kkt_residual: f64::INFINITY,
        pivots,
        method,
    };
    for active in actives {
        match active.member {
            Member::Cut(j) => solution.cut_multipliers[j] = active.multiplier.max(0.0),
            Member::Row(i) => solution.row_multipliers[i] = active.multiplier,
            Member::Bound(k) => solution.bound_multipliers[k] = active.multiplier,
        }
    }
    solution.kkt_residual = kkt_residual(qp, &solution);
    if solution.kkt_residual > WANTED
        && let Some(epigraph) = sharpest_value(qp, &solution)
    {
        let sharper = QpSolution { epigraph, ..solution.clone() };
        let kkt_residual = kkt_residual(qp, &sharper);
        if kkt_residual < solution.kkt_residual {
            return QpSolution { kkt_residual, ..sharper };
        }
    }
    solution
}

/// The value of the active cut whose terms are smallest, if it differs from v by rounding only: a cut 1e10 times as
/// steep hides in its rounding what the others say about v.
fn sharpest_value(qp: &EpigraphQp<'_>, solution: &QpSolution) -> Option<f64> {
    let step = &solution.step;
    let size = |j: usize| dot_terms(qp.slopes[j].as_slice(), step.as_slice()) + qp.offsets[j].abs();
    let active = (0..qp.slopes.len()).filter(|&j| solution.cut_multipliers[j] > 0.0);
    let sharpest = active.min_by(|&i, &j| size(i).total_cmp(&size(j))).map(|j| value(qp, j, step))?;
    let highest = (0..qp.slopes.len()).find(|&j| value(qp, j, step) == solution.epigraph)?;
    (solution.epigraph - sharpest <= ROUNDING * size(highest)).then_some(sharpest)
}

/// g_jᵀ d − e_j.
fn value(qp: &EpigraphQp<'_>, cut: usize, step: &Vector) -> f64 {
    dot(qp.slopes[cut].as_slice(), step.as_slice()) - qp.offsets[cut]
}
