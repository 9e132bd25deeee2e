//! Newton's method one product with F at a time.
//!
//! ```text
//! repeat:  derivatives D at the iterate;  v = (what the active rows demand at once) + T P M P (reduced residual),  G v = 0
//!          F v (the only product);  iterate := best combination of all directions so far   (recycling.rs)
//! ```
//! A Newton step with GMRES spends one product on its particular part and starts its Krylov space anew; here the space
//! grows over the whole solve, derivatives follow every product, and the residual falls at the rate of the linear
//! problem. The projector of an active set is kept while the set stays (a search direction need not know the last slip
//! direction).

use crate::equilibrium::Stage;
use crate::equilibrium::law::{Friction, Linearization};
use crate::error::ContactError;
use crate::linear::vector::add_scaled;
use crate::tfeti::dual::{ActiveSet, Iterate, Precision, TornContact};
use crate::tfeti::newton::holding::holding_set_at;
use crate::tfeti::newton::linear_solve::balancing_amplitudes;
use crate::tfeti::newton::recycling::{Direction, Recycled};
use crate::tfeti::newton::settings::NewtonSettings;
use crate::tfeti::newton::stagnation::stagnates;

/// Residual reduction after which the projector is renewed although the active set has stayed.
const PROJECTOR_RENEWAL: f64 = 0.01;

/// Resultant of a cluster, over the load, that rounding leaves where the coarse matrix is well conditioned; ordinary
/// states stand at 1e-15. Few nodes in a corner make it ill conditioned: all directions then leave equilibrium.
const MAX_IMBALANCE: f64 = 1e-13;

/// Residual reduction after which single precision images are replaced.
const IMAGE_REPLACEMENT: f64 = 1e-4;

/// Products in which the residual must at least halve; otherwise rounding, or a bad start, has stopped the descent.
/// Half as many show that the jumps must weigh less.
const MAX_STALLED_PRODUCTS: usize = 10;
/// Limit like [`MAX_STALLED_PRODUCTS`] for nearly incompressible bodies, for flat or tall bricks, and where jumps weigh
/// less: pressures, bending or gluing that the preconditioner hardly knows take products of their own.
const MAX_STALLED_SLOW: usize = 20;

/// Brings the residual of an iterate down to the tolerance, or as far as it falls; appends to the history.
pub(crate) fn descend(
    contact: &TornContact<'_>,
    iterate: &mut Iterate,
    directions: &mut Recycled,
    start: f64,
    settings: &NewtonSettings,
    history: &mut Vec<f64>,
) -> Result<f64, ContactError> {
    let mut residual = directions.combine(contact, iterate, start);
    let mut replaced = residual;
    let mut patience = patience(contact) / 2;
    let mut since = history.len();
    while residual > settings.tolerance
        && directions.len() < 2 * settings.max_krylov
        && settings.products_left(contact.operator.applications()) > 0
    {
        let active = holding_set_at(contact, iterate)?;
        let held = contact.linearize(iterate);
        let renewal = PROJECTOR_RENEWAL * residual;
        loop {
            extend(contact, iterate, &active, directions);
            residual = directions.combine(contact, iterate, residual);
            if contact.precision == Precision::Mixed && residual <= settings.tolerance.max(IMAGE_REPLACEMENT * replaced)
            {
                residual = replace_image(contact, iterate);
                replaced = residual;
            }
            history.push(residual);
            Stage::Contact.reached(history.len() - 1, residual)?;
            let stagnates = stagnates(&history[since..], patience);
            let done = residual <= settings.tolerance
                || stagnates
                || settings.products_left(contact.operator.applications()) == 0;
            if done || residual <= renewal || !same_status(&held, &contact.linearize(iterate)) {
                break;
            }
        }
        if stagnates(&history[since..], patience) {
            if !directions.weigh_jumps_less() {
                break;
            }
            (patience, since) = (MAX_STALLED_SLOW, history.len());
        }
    }
    Ok(residual)
}

/// Products in which the residual must at least halve.
fn patience(contact: &TornContact<'_>) -> usize {
    let problem = &contact.operator.model.problem;
    let slow = problem.flat_or_tall().is_some()
        || problem.materials().any(|material| material.compressible_neighbour().is_some());
    if slow { MAX_STALLED_SLOW } else { MAX_STALLED_PRODUCTS }
}

/// Brings the multipliers into equilibrium where they have drifted from it, and replaces their image by a product
/// in double precision; returns the residual.
pub(crate) fn replace_image(contact: &TornContact<'_>, iterate: &mut Iterate) -> f64 {
    if contact.imbalance(&iterate.multipliers) > MAX_IMBALANCE {
        // Where no active set holds all motions, nothing can be brought into equilibrium; the certificate tells.
        if let Ok(active) = holding_set_at(contact, iterate) {
            active.equilibrate(&mut iterate.multipliers);
        }
    }
    let image = contact.apply(&iterate.multipliers);
    *iterate = contact.iterate(iterate.multipliers.clone(), image, std::mem::take(&mut iterate.amplitudes));
    contact.residual(iterate)
}

/// One more direction, and the rigid motion that balances the iterate.
fn extend(contact: &TornContact<'_>, iterate: &Iterate, active: &ActiveSet<'_>, directions: &mut Recycled) {
    let rows = &active.rows;
    let current = contact.active_rows(contact.linearize(iterate), Friction::Coulomb);
    let mut direction = current.trial(&current.unknowns_of(&iterate.multipliers));
    add_scaled(&mut direction, -1.0, &iterate.multipliers);
    let mut residual = rows.test_transposed(&iterate.jumps);
    rows.add_compliance(&rows.unknowns_of(&iterate.multipliers), &mut residual, -1.0);
    let rigid = active.amplitudes(&residual);
    let jumps = contact.space.jumps(&rigid);
    add_scaled(&mut residual, 1.0, &rows.test_transposed(&jumps));
    directions.push(contact, Direction { amplitudes: rigid, forces: None }, jumps);
    // One correction brings the preconditioned residual and the change of the law into equilibrium.
    let step = contact.precondition(rows, &residual);
    add_scaled(&mut direction, 1.0, &rows.trial(&step));
    active.balance(&mut direction);
    // Factors of flat or tall bricks lose all digits of single precision.
    let double = contact.operator.model.problem.flat_or_tall().is_some();
    let precision = if double { Precision::Double } else { contact.precision };
    let image = contact.operator.apply_direction(&direction, precision);
    let amplitudes = balancing_amplitudes(active, &rows.unknowns_of(&direction), &image);
    let jumps = contact.space.jumps(&amplitudes);
    directions.push(contact, Direction { amplitudes, forces: Some((direction, image)) }, jumps);
}

/// Whether two lists of derivatives belong to the same statuses.
fn same_status(first: &[Linearization], second: &[Linearization]) -> bool {
    first.iter().zip(second).all(|(a, b)| std::mem::discriminant(a) == std::mem::discriminant(b))
}
