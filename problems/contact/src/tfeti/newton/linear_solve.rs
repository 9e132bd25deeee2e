//! The linear system of one active set: projected GMRES with iterative refinement.
//!
//! ```text
//! Qᵀ F T y + Δ y − QᵀGᵀ a = r,   G T y = e                                                          method.md (4.5)
//! ```

use crate::error::ContactError;
use crate::linear::gmres::{MAX_STALLED_ITERATIONS, gmres};
use crate::linear::vector::add_scaled;
use crate::tfeti::dual::{ActiveRows, ActiveSet, Iterate, TornContact};
use crate::tfeti::newton::recycling::{Direction, Recycled};
use crate::tfeti::torn::RowVector;

/// How accurately a reduced linear system is solved.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LinearAccuracy {
    /// Norm of the projected residual aimed at, mm.
    pub target: f64,
    /// Reduction of the first projected residual that is enough.
    pub reduction: f64,
    /// Krylov iterations allowed per cycle.
    pub max_krylov: usize,
    /// Krylov iterations in which the residual must halve.
    pub patience: usize,
    /// Cycles of iterative refinement: each recomputes the residual.
    pub cycles: usize,
    /// Products with F allowed in all.
    pub max_products: usize,
}

impl LinearAccuracy {
    /// The start: one digit.
    pub fn start(max_products: usize) -> Self {
        Self { target: 0.0, reduction: 0.1, max_krylov: 200, patience: MAX_STALLED_ITERATIONS, cycles: 1, max_products }
    }

    /// All that rounding allows.
    pub fn exact(max_products: usize) -> Self {
        Self { target: 0.0, reduction: 1e-14, max_krylov: 400, patience: 400, cycles: 6, max_products }
    }

    /// One cycle to a given residual.
    pub fn to(target: f64, max_krylov: usize, max_products: usize) -> Self {
        Self { target, reduction: 0.0, max_krylov, patience: MAX_STALLED_ITERATIONS, cycles: 1, max_products }
    }
}

/// Share of the residual that a cycle of iterative refinement may leave for another one to follow.
const MAX_REFINED_SHARE: f64 = 0.5;

/// Solves the reduced system of an active set, starting from given multipliers. The directions of its Krylov space
/// join `recycled`, where later iterates will use them.
pub(crate) fn linear_solve(
    contact: &TornContact<'_>,
    active: &ActiveSet<'_>,
    start: &RowVector,
    accuracy: LinearAccuracy,
    mut recycled: Option<&mut Recycled>,
) -> Result<Iterate, ContactError> {
    let rows = &active.rows;
    let mut unknowns = rows.unknowns_of(start);
    let (mut first, mut last) = (None, f64::INFINITY);
    let mut image = contact.zeros();
    let allowed = contact.operator.applications().saturating_add(accuracy.max_products);
    for _cycle in 0..accuracy.cycles {
        active.enforce(&mut unknowns, contact.space.resultants());
        image = contact.apply(&rows.trial(&unknowns));
        let mut projected = reduced_residual(contact, rows, &unknowns, &image);
        active.project(&mut projected);
        let size = contact.norm(&projected);
        let target = accuracy.target.max(accuracy.reduction * *first.get_or_insert(size));
        if size <= target || size > MAX_REFINED_SHARE * last {
            break;
        }
        last = size;
        let krylov = gmres(
            &contact.operator.model.sums(),
            &projected,
            target,
            accuracy.max_krylov.min(allowed.saturating_sub(contact.operator.applications())),
            accuracy.patience,
            |v| contact.projected_precondition(active, v),
            |z| contact.reduced_product(active, z),
        );
        let directions = krylov.directions.iter().zip(krylov.payloads);
        for (coefficient, (direction, product)) in krylov.coefficients.iter().zip(directions) {
            add_scaled(&mut unknowns, *coefficient, direction);
            add_scaled(&mut image, *coefficient, &product);
            if let Some(recycled) = recycled.as_deref_mut() {
                let amplitudes = balancing_amplitudes(active, direction, &product);
                let jumps = contact.space.jumps(&amplitudes);
                let forces = Some((rows.trial(direction), product));
                recycled.push(contact, Direction { amplitudes, forces }, jumps);
            }
        }
    }
    let amplitudes = active.amplitudes(&reduced_residual(contact, rows, &unknowns, &image));
    Ok(contact.iterate(rows.trial(&unknowns), image, amplitudes))
}

/// Qᵀ(d − F T y) − Δ y.
fn reduced_residual(contact: &TornContact<'_>, rows: &ActiveRows<'_>, unknowns: &[f64], image: &RowVector) -> Vec<f64> {
    let mut residual = rows.test_transposed(&contact.rest(image));
    rows.add_compliance(unknowns, &mut residual, -1.0);
    residual
}

/// Amplitudes that remove the rigid part of what a direction y with product F T y does to the reduced residual.
pub fn balancing_amplitudes(active: &ActiveSet<'_>, direction: &[f64], product: &RowVector) -> Vec<f64> {
    let mut change: Vec<f64> = active.rows.test_transposed(product).into_iter().map(|entry| -entry).collect();
    active.rows.add_compliance(direction, &mut change, -1.0);
    active.amplitudes(&change)
}
