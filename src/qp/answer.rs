//! From a step and its active members to an answer with its certificate.

use super::certificate::kkt_residual;
use super::kernels::dot;
use super::problem::{EpigraphQp, QpMethod, QpSolution};
use super::working_set::{Active, Member};
use crate::Vector;

/// Largest residual with which an answer is returned at once; a worse one is tried again by other means.
pub(super) const WANTED: f64 = 1e-12;

/// Completes a step and its multipliers to an answer with certificate; the step is moved into the box unless the certificate
/// suffers (with a large H the rounding of a bound may weigh more than the whole step).
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

fn complete(qp: &EpigraphQp<'_>, step: Vector, actives: &[Active], pivots: usize, method: QpMethod) -> QpSolution {
    let values =
        qp.slopes.iter().zip(qp.offsets).map(|(slope, offset)| dot(slope.as_slice(), step.as_slice()) - offset);
    let epigraph = values.fold(f64::NEG_INFINITY, f64::max);
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
    solution
}
