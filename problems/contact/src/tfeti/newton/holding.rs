//! Active sets that hold every rigid motion.
//!
//! ```text
//! an active set may leave a motion free:   slip → stick, then the open nodes nearest to contact are closed,
//!                                                     3, 6, 12, …, until G_T Gqᵀ is regular
//! ```
//! Only directions of search are affected: the residual, and with it the certificate, knows nothing of the closed
//! nodes.

use crate::equilibrium::law::{Friction, Linearization};
use crate::error::ContactError;
use crate::tfeti::dual::{ActiveSet, Iterate, TornContact};

/// Nodes closed first when an active set leaves a motion free.
const FIRST_CLOSED: usize = 3;

/// The active set of given derivatives, enlarged until it holds every motion; open nodes close by `priority`.
///
/// # Errors
/// [`ContactError::Unheld`] when even all nodes closed leave a motion free.
pub(crate) fn holding_set<'c>(
    contact: &'c TornContact<'_>,
    linearizations: Vec<Linearization>,
    priority: impl Fn() -> Vec<f64>,
) -> Result<ActiveSet<'c>, ContactError> {
    let active_set = |linearizations: &[Linearization]| contact.active_set(linearizations.to_vec(), Friction::Coulomb);
    if let Ok(held) = active_set(&linearizations) {
        return Ok(held);
    }
    let mut enlarged = linearizations;
    for linearization in enlarged.iter_mut().filter(|l| matches!(l, Linearization::Slip { .. })) {
        *linearization = Linearization::Stick;
    }
    let priority = priority();
    let mut order: Vec<usize> = (0..enlarged.len()).filter(|&node| enlarged[node] == Linearization::Open).collect();
    order.sort_by(|&a, &b| priority[b].total_cmp(&priority[a]));
    let mut closed = 0;
    loop {
        let held = active_set(&enlarged);
        if held.is_ok() || closed == order.len() {
            return held;
        }
        closed = (2 * closed).max(FIRST_CLOSED).min(order.len());
        order[..closed].iter().for_each(|&node| enlarged[node] = Linearization::Stick);
    }
}

/// The active set at an iterate, enlarged until it holds every motion.
///
/// # Errors
/// As [`holding_set`].
pub(crate) fn holding_set_at<'c>(
    contact: &'c TornContact<'_>,
    iterate: &Iterate,
) -> Result<ActiveSet<'c>, ContactError> {
    holding_set(contact, contact.linearize(iterate), || {
        let arguments = contact.arguments(iterate);
        contact.boundary.points.iter().map(|point| arguments[point.start]).collect()
    })
}
